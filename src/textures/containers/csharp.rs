//! A class for C#.

use std::fmt::Write as _;

use super::{
    c_header::{float, numbers, sides},
    rules::Stored,
};
use crate::about::About;

/// A static class with all textures, as arrays of `float`, or of `ushort` with the bits of halves. Unity's
/// `Texture2D.SetPixelData` accepts both. The name of the class is `Ltcforge`, followed by the layout and the first
/// digits of the table's digest, so a program can compile several classes.
pub(super) fn text(textures: &[Stored<'_>], about: &About) -> String {
    let mut text = format!("{}\npublic static class Ltcforge{}\n{{", about.comment(), about.suffix());
    for stored in textures {
        let (name, upper) = (&stored.texture.name, stored.texture.name.to_ascii_uppercase());
        let number_type = stored.rounded.either("float", "ushort");
        // Writing to a String cannot fail.
        let _ = write!(text, "\n    // {}\n", stored.described());
        for (side, value) in sides(stored) {
            let _ = writeln!(text, "    public const int {upper}_{side} = {value};");
        }
        let numbers = numbers(stored, |x| float(x) + "f");
        let _ = write!(
            text,
            "    public static readonly {number_type}[] {name} = new {number_type}[]\n    {{\n{numbers}    }};\n"
        );
    }
    text + "}\n"
}
