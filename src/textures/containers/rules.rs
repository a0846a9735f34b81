//! The input of the file formats: checked and rounded textures.

use crate::{
    file::TextureFileError,
    rounding::{Rounded, RoundingError, round_texture},
    texture::Texture,
};
use ltcforge_fit::Precision;

/// A texture with its rounded numbers.
pub(crate) struct Stored<'a> {
    pub(crate) texture: &'a Texture,
    pub(crate) rounded: Rounded,
}

/// Checks textures and rounds them to a precision.
pub(crate) fn stored(textures: &[Texture], precision: Precision) -> Result<Vec<Stored<'_>>, TextureFileError> {
    if textures.is_empty() {
        return Err(TextureFileError::Empty);
    }
    for (i, texture) in textures.iter().enumerate() {
        texture.check()?;
        // Some file systems ignore case.
        if textures[..i].iter().any(|other| other.name.eq_ignore_ascii_case(&texture.name)) {
            return Err(TextureFileError::SameName { name: texture.name.clone() });
        }
    }
    Ok(textures.iter().map(|texture| Stored { texture, rounded: round_texture(texture, precision) }).collect())
}

/// The combined rounding error of several textures.
pub(crate) fn rounding_of<'a>(textures: impl IntoIterator<Item = &'a Stored<'a>>) -> RoundingError {
    textures.into_iter().fold(RoundingError::default(), |all, one| all.and(one.rounded.error))
}

impl Stored<'_> {
    /// A line for comments: sizes, layers and channels.
    pub(super) fn described(&self) -> String {
        let Texture { width, height, depth, layers, .. } = self.texture;
        let depth = if *depth > 1 { format!(" x {depth}") } else { String::new() };
        let layers = if *layers > 1 { format!(", {layers} layers") } else { String::new() };
        let channels = self.texture.channels.join(", ");
        let kind = self.rounded.either("32-bit floats", "halves as bits");
        format!("{width} x {height}{depth}{layers}; channels {channels}; x fastest, then y, z, layer; {kind}")
    }

    /// The numbers in rows: one row for each texel, or for several short texels.
    pub(super) fn rows(&self, number: impl Fn(f32) -> String) -> String {
        let row = |texel: &[f32]| texel.iter().map(|x| number(*x)).collect::<Vec<_>>().join(",");
        self.rounded.numbers.chunks(self.texture.channels.len().max(4)).map(|texel| row(texel) + ",\n").collect()
    }

    /// Rejects a texture with more channels than graphics APIs support.
    pub(super) fn at_most_four(&self, container: &'static str) -> Result<(), TextureFileError> {
        let channels = self.texture.channels.len();
        if channels <= 4 {
            return Ok(());
        }
        Err(self.unsupported(container, "channels", channels.to_string(), "1 to 4"))
    }

    pub(super) fn unsupported(
        &self,
        container: &'static str,
        field: &'static str,
        value: String,
        allowed: &str,
    ) -> TextureFileError {
        let (name, allowed) = (self.texture.name.clone(), allowed.to_owned());
        TextureFileError::Unsupported { name, field, value, container, allowed }
    }
}
