//! The input and output of a file format.

use crate::{
    about::About,
    file::TextureFileError,
    rounding::{Rounded, RoundingError, round_texture},
    texture::Texture,
};
use ltcforge_fit::Precision;

/// A texture whose numbers are rounded.
pub(crate) struct Stored<'a> {
    pub(crate) texture: &'a Texture,
    pub(crate) rounded: Rounded,
}

/// A file format as an item of [`super::TextureContainer`].
pub(crate) trait ContainerRules: Sync {
    /// The files of textures that were checked and have distinct names, as path and bytes. `stem` names a file that
    /// holds them all.
    fn files(&self, stem: &str, textures: &[Stored<'_>], about: &About) -> Result<Vec<Written>, TextureFileError>;
}

/// A file: its name, its bytes, and what rounding changed of the numbers that it holds.
pub(crate) struct Written {
    pub(super) name: String,
    pub(super) bytes: Vec<u8>,
    pub(super) rounding: RoundingError,
}

/// Textures that were checked, rounded to a precision.
pub(crate) fn stored(textures: &[Texture], precision: Precision) -> Result<Vec<Stored<'_>>, TextureFileError> {
    if textures.is_empty() {
        return Err(TextureFileError::Empty);
    }
    for (i, texture) in textures.iter().enumerate() {
        texture.check()?;
        // File systems may not tell upper from lower case.
        if textures[..i].iter().any(|other| other.name.eq_ignore_ascii_case(&texture.name)) {
            return Err(TextureFileError::SameName { name: texture.name.clone() });
        }
    }
    Ok(textures.iter().map(|texture| Stored { texture, rounded: round_texture(texture, precision) }).collect())
}

/// A file for each texture, named after it.
pub(super) fn one_each(
    textures: &[Stored<'_>],
    extension: &str,
    encode: impl Fn(&Stored<'_>) -> Result<Vec<u8>, TextureFileError>,
) -> Result<Vec<Written>, TextureFileError> {
    let file = |stored: &Stored<'_>| {
        let name = format!("{}.{extension}", stored.texture.name);
        Ok(Written { name, bytes: encode(stored)?, rounding: stored.rounded.error })
    };
    textures.iter().map(file).collect()
}

/// One file that holds all textures.
pub(super) fn one_of_all(stem: &str, extension: &str, bytes: Vec<u8>, textures: &[Stored<'_>]) -> Vec<Written> {
    let rounding = textures.iter().fold(RoundingError::default(), |all, one| all.and(one.rounded.error));
    vec![Written { name: format!("{stem}.{extension}"), bytes, rounding }]
}

impl Stored<'_> {
    /// A sentence for comments: sizes, layers, channels.
    pub(super) fn described(&self) -> String {
        let Texture { width, height, depth, layers, .. } = self.texture;
        let depth = if *depth > 1 { format!(" x {depth}") } else { String::new() };
        let layers = if *layers > 1 { format!(", {layers} layers") } else { String::new() };
        let channels = self.texture.channels.join(", ");
        let kind = match self.rounded.precision {
            Precision::F32 => "32-bit floats",
            Precision::F16 => "halfs as bits",
        };
        format!("{width} x {height}{depth}{layers}; {channels} of each texel; x fastest, then y, z, layer; {kind}")
    }

    /// The numbers in rows of one texel each, or of one row of short texels.
    pub(super) fn rows(&self, number: impl Fn(usize) -> String) -> String {
        let channels = self.texture.channels.len();
        let indices: Vec<usize> = (0..self.rounded.numbers.len()).collect();
        let row = |texel: &[usize]| texel.iter().map(|i| number(*i)).collect::<Vec<_>>().join(",");
        indices.chunks(channels.max(4)).map(|texel| row(texel) + ",\n").collect()
    }

    /// Refuses a texture with more channels than graphics interfaces have.
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
