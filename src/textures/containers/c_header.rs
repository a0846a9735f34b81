//! A header for C99 and C++.

use std::fmt::Write as _;

use half::f16;

use super::rules::Stored;
use crate::{about::About, digits::shortest};
use ltcforge_fit::Precision;

/// A header with all textures, as arrays of `float`, or of `uint16_t` with the bits of halves. For textures that our
/// shader reads, it also has the contents of the uniform buffer.
///
/// The names of the guard and the arrays differ for each table and layout, so a program can include several headers.
/// Short names are also defined, unless `LTCFORGE_LONG_NAMES` is already defined.
pub(super) fn text(stem: &str, textures: &[Stored<'_>], about: &About) -> String {
    let suffix = about.suffix();
    let guard = format!("ltcforge_{stem}{suffix}_h").to_ascii_uppercase();
    let guard = guard.replace(|c: char| !c.is_ascii_alphanumeric(), "_");
    let mut text = format!("{}#ifndef {guard}\n#define {guard}\n\n#include <stdint.h>\n", about.comment());
    let mut short = String::new();
    for stored in textures {
        let (name, count) = (&stored.texture.name, stored.rounded.numbers.len());
        let upper = name.to_ascii_uppercase();
        let number_type = stored.rounded.either("float", "uint16_t");
        // Writing to a String cannot fail.
        let _ = write!(text, "\n// {}\n", stored.described());
        for (side, value) in sides(stored) {
            let _ = writeln!(text, "#define {upper}{suffix}_{side} {value}");
            let _ = writeln!(short, "#define {upper}_{side} {upper}{suffix}_{side}");
        }
        let _ = write!(
            text,
            "static const {number_type} {name}{suffix}[{count}] = {{\n{}}};\n",
            numbers(stored, |x| float(x) + "f")
        );
        let _ = writeln!(short, "#define {name} {name}{suffix}");
    }
    if let Some(words) = about.uniform() {
        let words: Vec<String> = words
            .chunks(4)
            .map(|row| row.iter().map(|word| format!("{word:#x}")).collect::<Vec<_>>().join(","))
            .collect();
        let _ = write!(
            text,
            "\n// Binding 0 of the shader: two vectors of uint, seven of float, as bits. Copy all 144 bytes into the uniform buffer.\n\
             static const uint32_t ltc_table{suffix}[36] = {{\n{},\n}};\n",
            words.join(",\n")
        );
        let _ = writeln!(short, "#define ltc_table ltc_table{suffix}");
    }
    if !suffix.is_empty() {
        text += "\n// Define LTCFORGE_LONG_NAMES before headers of several tables are included.\n";
        let _ = write!(text, "#ifndef LTCFORGE_LONG_NAMES\n{short}#endif\n");
    }
    text += "\n#endif\n";
    text
}

/// The constants for the side lengths of a texture.
pub(super) fn sides(stored: &Stored<'_>) -> [(&'static str, usize); 5] {
    let texture = stored.texture;
    let [width, height, depth, layers] =
        [texture.width, texture.height, texture.depth, texture.layers].map(|n| n as usize);
    [("WIDTH", width), ("HEIGHT", height), ("DEPTH", depth), ("LAYERS", layers), ("CHANNELS", texture.channels.len())]
}

/// The numbers as code. `single` formats floats, and halves are written as their bits.
pub(crate) fn numbers(stored: &Stored<'_>, single: impl Fn(f32) -> String) -> String {
    match stored.rounded.precision {
        Precision::F32 => stored.rows(single),
        Precision::F16 => stored.rows(|x| f16::from_f32_const(x).to_bits().to_string()),
    }
}

/// A number that every language reads as a float: it has a point or an exponent.
pub(super) fn float(x: f32) -> String {
    let text = shortest(x, Precision::F32);
    if text.contains(['.', 'e']) { text } else { text + ".0" }
}
