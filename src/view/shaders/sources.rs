//! The sources in WGSL, and how they are joined.

use crate::fit::Layout;

/// A file of `shaders/`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shader {
    /// Its name, without the extension.
    pub name: &'static str,
    /// WGSL.
    pub source: &'static str,
}

/// Every shader, each after those it needs. `ltc_math`, `ltc_table` and `ltc_light` are all that a renderer takes.
pub const SHADERS: [Shader; 6] = [
    Shader { name: "ltc_math", source: include_str!("../../../shaders/ltc_math.wgsl") },
    Shader { name: "ltc_table", source: include_str!("../../../shaders/ltc_table.wgsl") },
    Shader { name: "ltc_light", source: include_str!("../../../shaders/ltc_light.wgsl") },
    Shader { name: "ltc_example", source: include_str!("../../../shaders/ltc_example.wgsl") },
    Shader { name: "ggx_reference", source: include_str!("../../../shaders/ggx_reference.wgsl") },
    Shader { name: "sphere", source: include_str!("../../../shaders/sphere.wgsl") },
];

/// What a renderer takes, with the entry point that shows how to call it.
const PORTED: [&str; 4] = ["ltc_math", "ltc_table", "ltc_light", "ltc_example"];
/// What the preview takes: its own entry points in place of the example.
const PREVIEWED: [&str; 5] = ["ltc_math", "ltc_table", "ltc_light", "ggx_reference", "sphere"];
/// The line that leaves the layout to the table.
const OPEN_LAYOUT: &str = "override ltc_layout: u32 = LTC_LAYOUT_OF_TABLE;";

/// The named shaders as one module, in the order of [`SHADERS`].
pub(in crate::view) fn joined(names: &[&str]) -> String {
    let sources: Vec<&str> = SHADERS.iter().filter(|s| names.contains(&s.name)).map(|shader| shader.source).collect();
    sources.join("\n")
}

/// The module of the preview.
pub(in crate::view) fn preview_module() -> String {
    joined(&PREVIEWED)
}

/// The module that other renderers take, for tables of one layout.
pub(super) fn for_layout(layout: Layout) -> String {
    let (_, constant) = layout_names(layout);
    joined(&PORTED).replace(OPEN_LAYOUT, &format!("const ltc_layout: u32 = {constant};"))
}

/// A layout's name in a sentence, and in the shaders' constants.
pub(super) fn layout_names(layout: Layout) -> (&'static str, &'static str) {
    match layout {
        Layout::Kt2022 => ("kt2022", "LTC_LAYOUT_KT2022"),
        Layout::Reflected => ("reflected", "LTC_LAYOUT_REFLECTED"),
    }
}

#[cfg(test)]
mod tests {
    use naga::valid::{Capabilities, ValidationFlags, Validator};

    use super::*;

    fn validate(names: &[&str]) {
        assert!(names.iter().all(|name| SHADERS.iter().any(|shader| shader.name == *name)), "{names:?}");
        let source = joined(names);
        let module =
            naga::front::wgsl::parse_str(&source).unwrap_or_else(|error| panic!("{}", error.emit_to_string(&source)));
        let mut validator = Validator::new(ValidationFlags::all(), Capabilities::empty());
        if let Err(error) = validator.validate(&module) {
            panic!("{names:?}: {}", error.emit_to_string(&source));
        }
    }

    #[test]
    fn each_shader_is_valid_with_what_it_says_it_needs() {
        validate(&["ltc_math"]);
        validate(&["ltc_math", "ltc_table"]);
        validate(&["ltc_math", "ltc_light"]);
        validate(&["ltc_math", "ltc_table", "ltc_light"]);
        validate(&PORTED);
        validate(&["ltc_math", "ggx_reference"]);
        validate(&PREVIEWED);
    }

    #[test]
    fn every_file_of_the_folder_is_listed() {
        let folder = std::fs::read_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders")).expect("the folder");
        assert_eq!(SHADERS.len(), folder.count());
    }
}
