//! A module for Rust.

use std::fmt::Write as _;

use super::{
    c_header::{numbers, sides},
    rules::{ContainerRules, Stored, Written, one_of_all},
};
use crate::{about::About, file::TextureFileError};
use ltcforge_fit::Precision;

/// One module with all textures: statics of `f32`, or of `u16` that are the bits of halves.
pub(super) struct RustModule;

impl ContainerRules for RustModule {
    fn files(&self, stem: &str, textures: &[Stored<'_>], about: &About) -> Result<Vec<Written>, TextureFileError> {
        let mut text = about.comment();
        for stored in textures {
            let (upper, count) = (stored.texture.name.to_ascii_uppercase(), stored.rounded.numbers.len());
            let number_type = match stored.rounded.precision {
                Precision::F32 => "f32",
                Precision::F16 => "u16",
            };
            text += "\n";
            for (side, value) in sides(stored) {
                // Writing to a String cannot fail.
                let _ = writeln!(text, "pub const {upper}_{side}: u32 = {value};");
            }
            let _ = write!(text, "/// {}\n#[rustfmt::skip]\n", stored.described());
            text += "#[allow(clippy::all, clippy::pedantic)]\n";
            let _ = write!(text, "pub static {upper}: [{number_type}; {count}] = [\n{}];\n", numbers(stored, ""));
        }
        Ok(one_of_all(stem, "rs", text.into_bytes(), textures))
    }
}
