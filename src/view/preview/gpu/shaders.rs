//! The shaders' sources, which users take home.

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
    Shader { name: "ltc_math", source: include_str!("../../../../shaders/ltc_math.wgsl") },
    Shader { name: "ltc_table", source: include_str!("../../../../shaders/ltc_table.wgsl") },
    Shader { name: "ltc_light", source: include_str!("../../../../shaders/ltc_light.wgsl") },
    Shader { name: "ltc_example", source: include_str!("../../../../shaders/ltc_example.wgsl") },
    Shader { name: "ggx_reference", source: include_str!("../../../../shaders/ggx_reference.wgsl") },
    Shader { name: "sphere", source: include_str!("../../../../shaders/sphere.wgsl") },
];

/// The preview's as one module: all but the example of what others would write in its place.
pub(super) fn module() -> String {
    let sources: Vec<&str> = SHADERS.iter().filter(|s| s.name != "ltc_example").map(|shader| shader.source).collect();
    sources.join("\n")
}

#[cfg(test)]
mod tests {
    use naga::valid::{Capabilities, ValidationFlags, Validator};

    use super::*;

    fn validate(names: &[&str]) {
        let source: Vec<&str> = SHADERS.iter().filter(|s| names.contains(&s.name)).map(|s| s.source).collect();
        assert_eq!(source.len(), names.len(), "{names:?}");
        let source = source.join("\n");
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
        validate(&["ltc_math", "ltc_table", "ltc_light", "ltc_example"]);
        validate(&["ltc_math", "ggx_reference"]);
        validate(&["ltc_math", "ltc_table", "ltc_light", "ggx_reference", "sphere"]);
    }

    #[test]
    fn every_file_of_the_folder_is_listed() {
        let files = SHADERS.map(|shader| shader.name);
        assert_eq!(
            files.len(),
            std::fs::read_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders")).expect("shaders").count()
        );
    }
}
