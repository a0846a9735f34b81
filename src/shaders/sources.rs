//! The sources in WGSL, and how they are joined.

use super::Bound;
use super::Lights;
use super::LitBy;
use super::header::light_files;
use super::namespace::prefixed;
use super::normals_header::normals_files;
use ltcforge_fit::{Layout, LayoutShader};
use ltcforge_light::{LightModel, NormalsRule};

/// A file of `shaders/`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shader {
    /// Its name, without the extension.
    pub name: &'static str,
    /// WGSL.
    pub source: &'static str,
}

/// Every shader but the layouts' parts, each after those it needs.
pub const SHADERS: [Shader; 28] = [
    Shader { name: "ltc_math", source: ltcforge_wgsl::LTC_MATH },
    Shader { name: "nodes_storage", source: ltcforge_wgsl::NODES_STORAGE },
    Shader { name: "nodes_uniform", source: ltcforge_wgsl::NODES_UNIFORM },
    Shader { name: "texels_volumes", source: ltcforge_wgsl::TEXELS_VOLUMES },
    Shader { name: "texels_array", source: ltcforge_wgsl::TEXELS_ARRAY },
    Shader { name: "ltc_smooth", source: ltcforge_wgsl::LTC_SMOOTH },
    Shader { name: "ltc_function", source: ltcforge_wgsl::LTC_FUNCTION },
    Shader { name: "ltc_decode", source: ltcforge_wgsl::LTC_DECODE },
    Shader { name: "ltc_table", source: ltcforge_wgsl::LTC_TABLE },
    Shader { name: "ltc_light", source: ltcforge_wgsl::LTC_LIGHT },
    Shader { name: "ltc_shapes", source: ltcforge_wgsl::LTC_SHAPES },
    Shader { name: "normals_view", source: ltcforge_wgsl::NORMALS_VIEW },
    Shader { name: "normals_arcs", source: ltcforge_wgsl::NORMALS_ARCS },
    Shader { name: "normals_arcs_rough", source: ltcforge_wgsl::NORMALS_ARCS_ROUGH },
    Shader { name: "normals_edge", source: ltcforge_wgsl::NORMALS_EDGE },
    Shader { name: "normals_balanced", source: ltcforge_wgsl::NORMALS_BALANCED },
    Shader { name: "normals_fast", source: ltcforge_wgsl::NORMALS_FAST },
    Shader { name: "normals_fine", source: ltcforge_wgsl::NORMALS_FINE },
    Shader { name: "normals_disk", source: ltcforge_wgsl::NORMALS_DISK },
    Shader { name: "gaussians_light", source: ltcforge_wgsl::GAUSSIANS_LIGHT },
    Shader { name: "gaussians_table", source: ltcforge_wgsl::GAUSSIANS_TABLE },
    Shader { name: "ltc_example", source: ltcforge_wgsl::LTC_EXAMPLE },
    Shader { name: "normals_example", source: ltcforge_wgsl::NORMALS_EXAMPLE },
    Shader { name: "gaussians_example", source: ltcforge_wgsl::GAUSSIANS_EXAMPLE },
    Shader { name: "gaussians_table_example", source: ltcforge_wgsl::GAUSSIANS_TABLE_EXAMPLE },
    Shader { name: "ggx_reference", source: ltcforge_wgsl::GGX_REFERENCE },
    Shader { name: "reference_solids", source: ltcforge_wgsl::REFERENCE_SOLIDS },
    Shader { name: "sphere", source: ltcforge_wgsl::SPHERE },
];

/// Parts that read a table with nodes in storage and entries in volumes.
const TABLE: [&str; 4] = ["ltc_math", "nodes_storage", "texels_volumes", "ltc_table"];

/// The named shaders as one text, in the order of [`SHADERS`].
#[must_use]
pub fn joined(names: &[&str]) -> String {
    let sources: Vec<&str> = SHADERS.iter().filter(|s| names.contains(&s.name)).map(|shader| shader.source).collect();
    sources.join("\n")
}

/// The named shaders as one module that reads tables of these layouts.
///
/// `ltc_restore` and `ltc_even` are written here: with one layout they call that one's parts, with several they ask the
/// table.
fn module(names: &[&str], layouts: &[Layout]) -> String {
    let restore = |layout: &Layout| {
        let LayoutShader { restore, .. } = layout.shader();
        format!("return {restore}(stored, alpha_x, ratio, wo);")
    };
    let even = |layout: &Layout| {
        layout.shader().even.map_or("return x;".to_owned(), |even| format!("return {even}(axis, x);"))
    };
    let mut parts: Vec<&str> = Vec::new();
    for layout in layouts {
        let LayoutShader { source, .. } = layout.shader();
        if !parts.contains(&source) {
            parts.push(source);
        }
    }
    format!(
        "{}\n{}\n\
        /// The lobe of interpolated numbers, at a place within the table's ranges seen from wo in the first quadrant.\n\
        fn ltc_restore(stored: LtcLobe, alpha_x: f32, ratio: f32, wo: vec3<f32>) -> LtcLobe {{\n{}}}\n\n\
        /// The variable in which weights along an axis are linear: 0 is alpha, 1 ratio, 2 theta, 3 phi.\n\
        fn ltc_even(axis: u32, x: f32) -> f32 {{\n{}}}\n",
        joined(names),
        parts.join("\n"),
        body(layouts, "return stored;", restore),
        body(layouts, "return x;", even),
    )
}

/// The body of a function that does what `of` says for the table's layout; for an unknown layout, what `default` says.
fn body(layouts: &[Layout], default: &str, of: impl Fn(&Layout) -> String) -> String {
    if let [only] = layouts {
        return format!("    {}\n", of(only));
    }
    let case = |layout: &Layout| format!("        case {}u: {{ {} }}\n", layout.shader().number, of(layout));
    let cases: String = layouts.iter().map(case).collect();
    format!("    switch ltc_table.reading.x {{\n{cases}        default: {{ {default} }}\n    }}\n")
}

/// The shaders of the preview but those of model `normals`: all other models, and its own entry points in place of their
/// examples.
fn previewed() -> Vec<&'static str> {
    let layouts = [None, Some(Layout::ALL[0])];
    let models = layouts.iter().flat_map(|layout| LightModel::ALL.iter().map(|model| LitBy::new(*model, *layout)));
    let others = models.flatten().filter(|lit_by| lit_by.rule().is_none());
    let lights = others.flat_map(|lit_by| (lit_by.shader().functions)(Lights::All));
    TABLE.iter().chain(lights).chain(&["ggx_reference", "reference_solids", "sphere"]).copied().collect()
}

/// The module of the preview, which reads tables of every layout, and has model `normals` by each of its rules: the names
/// of a rule's text begin with the rule's.
#[must_use]
pub fn preview_module() -> String {
    let by_rule = |rule: &NormalsRule| {
        let functions = normals_files(*rule);
        prefixed(&joined(functions), "normals", rule.name())
    };
    let rules: Vec<String> = NormalsRule::SHADED.iter().map(by_rule).collect();
    format!("{}\n{}", module(&previewed(), Layout::ALL), rules.join("\n"))
}

/// The module that reads tables of every layout, without an entry point.
#[must_use]
pub fn table_reader(bound: Bound) -> String {
    module(&["ltc_math", "nodes_storage", texels(bound), "ltc_table"], Layout::ALL)
}

/// The module that other renderers take.
#[must_use]
pub fn ported(lit_by: LitBy) -> String {
    assembled(lit_by, TABLE, Lights::All, &[lit_by.shader().example])
}

/// The shaders of a model's light, what reads its tables if it has any, and others.
fn assembled(lit_by: LitBy, reader: [&str; 4], lights: Lights, others: &[&str]) -> String {
    let functions = (lit_by.shader().functions)(lights);
    match lit_by.layout() {
        Some(layout) => module(&[&reader, functions, others].concat(), &[layout]),
        None => joined(&[functions, others].concat()),
    }
}

/// The part that reads the textures.
fn texels(bound: Bound) -> &'static str {
    match bound {
        Bound::Volumes => "texels_volumes",
        Bound::Array => "texels_array",
    }
}

/// The functions alone that other renderers include; nodes come in a uniform where there are no storage buffers.
#[must_use]
pub fn functions(lit_by: LitBy, bound: Bound, lights: Lights, has_storage: bool) -> String {
    let nodes = if has_storage { "nodes_storage" } else { "nodes_uniform" };
    assembled(lit_by, ["ltc_math", nodes, texels(bound), "ltc_table"], lights, &[])
}

/// The functions of a table's light that read no table: `smooth_at` has the coefficients.
#[must_use]
pub fn without_textures(smooth_at: &str, lights: Lights) -> String {
    let LayoutShader { source, .. } = Layout::Reflected.shader();
    let parts = ["ltc_math", "ltc_smooth", "ltc_function"];
    format!("{}\n{source}\n{smooth_at}", joined(&[&parts[..], light_files(lights)].concat()))
}

#[cfg(test)]
mod tests {
    use naga::valid::{Capabilities, ValidationFlags, Validator};

    use super::*;

    /// Validates the named shaders, joined with the parts of layouts where they read a table.
    fn validate(names: &[&str]) {
        assert!(names.iter().all(|name| SHADERS.iter().any(|shader| shader.name == *name)), "{names:?}");
        if names.contains(&"ltc_table") {
            validate_text(names, &module(names, Layout::ALL));
            for layout in Layout::ALL {
                validate_text(names, &module(names, &[*layout]));
            }
        } else {
            validate_text(names, &joined(names));
        }
    }

    fn validate_text(names: &[&str], source: &str) {
        let module =
            naga::front::wgsl::parse_str(source).unwrap_or_else(|error| panic!("{}", error.emit_to_string(source)));
        let mut validator = Validator::new(ValidationFlags::all(), Capabilities::empty());
        if let Err(error) = validator.validate(&module) {
            panic!("{names:?}: {}", error.emit_to_string(source));
        }
    }

    #[test]
    fn each_shader_is_valid_with_what_it_says_it_needs() {
        validate(&["ltc_math"]);
        validate(&["ltc_math", "nodes_storage", "texels_volumes", "ltc_table"]);
        validate(&["ltc_math", "nodes_uniform", "texels_array", "ltc_table"]);
        validate(&["ltc_math", "ltc_light"]);
        validate(&["ltc_math", "ltc_light", "ltc_shapes"]);
        validate(&["ltc_math", "nodes_storage", "texels_volumes", "ltc_table", "ltc_light"]);
        let layouts = [None, Some(Layout::Reflected)];
        for lit_by in
            layouts.iter().flat_map(|of| LightModel::ALL.iter().map(|model| LitBy::new(*model, *of))).flatten()
        {
            let reader = if lit_by.layout().is_some() { &TABLE[..] } else { &[] };
            let functions = [reader, (lit_by.shader().functions)(Lights::All)].concat();
            validate(&functions);
            validate(&[&functions[..], &[lit_by.shader().example]].concat());
        }
        validate(&["ltc_math", "ltc_light", "ggx_reference", "reference_solids"]);
        for rule in NormalsRule::SHADED {
            validate(normals_files(rule));
        }
        validate_text(&["preview"], &preview_module());
    }

    #[test]
    fn every_file_of_the_folder_is_listed() {
        let folder = std::fs::read_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/../../shaders")).expect("the folder");
        let texts = folder.filter(|entry| {
            let path = entry.as_ref().expect("an entry").path();
            path.extension().is_some_and(|extension| extension == "wgsl")
        });
        let mut parts: Vec<&str> = Layout::ALL.iter().map(|layout| layout.shader().source).collect();
        parts.sort_unstable();
        parts.dedup();
        assert_eq!(SHADERS.len() + parts.len(), texts.count());
    }

    /// Those that only the preview runs: their loops go over what a scene has.
    const OF_THE_PREVIEW: [&str; 3] = ["ggx_reference", "reference_solids", "sphere"];

    /// Whether a line begins a loop from one constant to another: `for (var i = 0u; i < 8u; i++) {`.
    fn is_bounded(line: &str) -> bool {
        let parts = || {
            let head = line.strip_prefix("for (var ")?.strip_suffix("++) {")?;
            let (name, rest) = head.split_once(" = ")?;
            let (from, rest) = rest.split_once("; ")?;
            let (condition, counted) = rest.split_once("; ")?;
            let to = condition.strip_prefix(name)?.strip_prefix(" < ")?;
            Some([from, to].into_iter().all(is_constant) && counted == name)
        };
        parts().unwrap_or(false)
    }

    /// A number, or a constant of the text by its name.
    fn is_constant(word: &str) -> bool {
        let is_name = |c: char| c.is_ascii_uppercase() || "_.xyzw".contains(c);
        word.trim_end_matches('u').parse::<u32>().is_ok() || (word.starts_with("LTC_") && word.chars().all(is_name))
    }

    /// A loop without a constant bound can keep the compiler of a driver busy for minutes.
    #[test]
    fn every_loop_of_an_emitted_shader_has_constant_bounds() {
        let layouts = Layout::ALL.iter().map(|layout| layout.shader().source);
        let emitted = SHADERS.iter().filter(|shader| !OF_THE_PREVIEW.contains(&shader.name));
        let mut loops = 0;
        for line in emitted.map(|shader| shader.source).chain(layouts).flat_map(str::lines).map(str::trim) {
            let follows = |rest: &str| rest.starts_with([' ', '(', '{']);
            let is_loop = ["for", "while", "loop"].iter().any(|word| line.strip_prefix(word).is_some_and(follows));
            assert!(!is_loop || is_bounded(line), "{line}");
            loops += u32::from(is_loop);
        }
        assert!(loops > 20, "{loops}");
        for unbounded in [
            "while (span > 1u) {",
            "loop {",
            "for (var i = 0u; i < number; i++) {",
            "for (var i = first; i < 8u; i++) {",
            "for (var i = 0u; i < 8u && j < 3u; i++) {",
            "for (var below = bits - 1u; below > 0u; below--) {",
        ] {
            assert!(!is_bounded(unbounded), "{unbounded}");
        }
    }
}
