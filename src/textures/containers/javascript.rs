//! An ES module.

use std::fmt::Write as _;

use super::{
    c_header::{numbers, sides},
    rules::Stored,
};
use crate::{about::About, digits::shortest};
use ltcforge_fit::Precision;

/// A module with all textures: a `Float32Array`, or a `Uint16Array` with the bits of halves. WebGL accepts both.
pub(super) fn text(textures: &[Stored<'_>], about: &About) -> String {
    let mut text = about.comment();
    for stored in textures {
        let upper = stored.texture.name.to_ascii_uppercase();
        text += "\n";
        for (side, value) in sides(stored) {
            // Writing to a String cannot fail.
            let _ = writeln!(text, "export const {upper}_{side} = {value};");
        }
        let _ = write!(text, "// {}\nexport {}", stored.described(), constant(&stored.texture.name, stored));
    }
    text
}

/// `const NAME = new Float32Array( [ ... ] );`
fn constant(name: &str, stored: &Stored<'_>) -> String {
    let array = stored.rounded.either("Float32Array", "Uint16Array");
    let rows = numbers(stored, |x| shortest(x, Precision::F32));
    format!("const {name} = new {array}( [\n{rows}] );\n")
}
