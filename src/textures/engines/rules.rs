//! The common parts of engines: the input of a bundle, and helpers.

use crate::{
    about::About,
    containers::{Stored, rounding_of, stored},
    file::{TextureFile, TextureFileError},
    texture::Texture,
};
use ltcforge_fit::{BrdfKind, Precision};

/// The names of the two textures, for most engines.
pub(super) const FIRST: &str = "LTC_1";
pub(super) const SECOND: &str = "LTC_2";
/// The width and height of these textures in texels.
pub(super) const SIZE: u32 = 64;

/// The input from which a bundle is made.
pub(crate) struct Source<'a> {
    pub(super) engine: &'static str,
    pub(super) textures: &'a [Texture],
    pub(super) about: &'a About,
    /// The scattering model of the table. It is one of [`super::Engine::brdfs`], unless the engine supports all models.
    pub(super) brdf: BrdfKind,
}

impl Source<'_> {
    /// A square 2D texture with four channels, with rounded numbers.
    pub(super) fn square(
        &self,
        name: &'static str,
        size: u32,
        precision: Precision,
    ) -> Result<Stored<'_>, TextureFileError> {
        let wanted = || format!("{size} x {size} texels and 4 channels");
        let found = self.named(name, wanted)?;
        let fits = [found.width, found.height, found.depth, found.layers] == [size, size, 1, 1];
        if fits && found.channels.len() == 4 {
            return self.stored(found, precision);
        }
        let Texture { width, height, depth, layers, channels, .. } = found;
        let found = format!("{width} x {height} x {depth} texels, {layers} layers and {} channels", channels.len());
        Err(TextureFileError::Missing { engine: self.engine, name, wanted: wanted(), found })
    }

    /// Both textures, for an engine with two textures.
    pub(super) fn both(&self, precision: Precision) -> Result<[Stored<'_>; 2], TextureFileError> {
        Ok([self.square(FIRST, SIZE, precision)?, self.square(SECOND, SIZE, precision)?])
    }

    /// The texture with this name.
    pub(super) fn named(
        &self,
        name: &'static str,
        wanted: impl FnOnce() -> String,
    ) -> Result<&Texture, TextureFileError> {
        self.textures.iter().find(|texture| texture.name == name).ok_or_else(|| {
            let names: Vec<&str> = self.textures.iter().map(|texture| texture.name.as_str()).collect();
            let found = if names.is_empty() { "none".to_owned() } else { names.join(", ") };
            TextureFileError::Missing { engine: self.engine, name, wanted: wanted(), found }
        })
    }

    #[allow(clippy::unused_self, reason = "called like the other methods")]
    pub(super) fn stored<'t>(
        &self,
        texture: &'t Texture,
        precision: Precision,
    ) -> Result<Stored<'t>, TextureFileError> {
        let mut all = stored(std::slice::from_ref(texture), precision)?;
        all.pop().ok_or(TextureFileError::Empty)
    }
}

/// A file with these bytes, and the rounding errors of these textures.
pub(super) fn file(path: &str, bytes: Vec<u8>, stored: &[&Stored<'_>]) -> TextureFile {
    TextureFile { path: path.to_owned(), bytes, rounding: rounding_of(stored.iter().copied()) }
}
