//! A module for Rust.

use std::fmt::Write as _;

use super::{
    c_header::{float, numbers, sides},
    rules::Stored,
};
use crate::about::About;

/// A module with all textures: statics of `f32`, or of `u16` with the bits of halves.
pub(super) fn text(textures: &[Stored<'_>], about: &About) -> String {
    let mut text = about.comment();
    for stored in textures {
        let (upper, count) = (stored.texture.name.to_ascii_uppercase(), stored.rounded.numbers.len());
        let number_type = stored.rounded.either("f32", "u16");
        text += "\n";
        for (side, value) in sides(stored) {
            // Writing to a String cannot fail.
            let _ = writeln!(text, "pub const {upper}_{side}: u32 = {value};");
        }
        let _ = write!(text, "/// {}\n#[rustfmt::skip]\n", stored.described());
        text += "#[allow(clippy::all, clippy::pedantic)]\n";
        let _ = write!(text, "pub static {upper}: [{number_type}; {count}] = [\n{}];\n", numbers(stored, float));
    }
    text
}
