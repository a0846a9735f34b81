//! An ES module.

use std::fmt::Write as _;

use super::{
    c_header::sides,
    rules::{ContainerRules, Stored, Written, one_of_all},
};
use crate::{about::About, digits::shortest, file::TextureFileError};
use ltcforge_fit::Precision;

/// One module with all textures: `Float32Array`, or a `Uint16Array` of the bits of halves, which is what WebGL takes.
pub(super) struct JavaScript;

impl ContainerRules for JavaScript {
    fn files(&self, stem: &str, textures: &[Stored<'_>], about: &About) -> Result<Vec<Written>, TextureFileError> {
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
        Ok(one_of_all(stem, "js", text.into_bytes(), textures))
    }
}

/// `const NAME = new Float32Array( [ ... ] );`
fn constant(name: &str, stored: &Stored<'_>) -> String {
    let numbers = &stored.rounded.numbers;
    let (array, rows) = match stored.rounded.precision {
        Precision::F32 => ("Float32Array", stored.rows(|i| shortest(numbers[i], Precision::F32))),
        Precision::F16 => {
            let bits: Vec<u16> = stored.rounded.half_bits().collect();
            ("Uint16Array", stored.rows(|i| bits[i].to_string()))
        }
    };
    format!("const {name} = new {array}( [\n{rows}] );\n")
}
