//! The WGSL sources, and functions that join them.

use super::Bound;
use super::Lights;
use super::header::light_files;
use super::namespace::prefixed;
use super::normals_header::normals_files;
use super::{LitBy, Reading};
use ltcforge_fit::{Layout, LayoutShader};
use ltcforge_light::{LightModel, NormalsRule};

/// A file in `shaders/`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shader {
    /// The file name without its extension.
    pub name: &'static str,
    /// WGSL.
    pub source: &'static str,
}

/// Every shader except the parts of layouts. Each shader follows the shaders that it needs.
pub const SHADERS: [Shader; 55] = [
    Shader { name: "ltc_math", source: ltcforge_wgsl::LTC_MATH },
    Shader { name: "ltc_quadrant", source: ltcforge_wgsl::LTC_QUADRANT },
    Shader { name: "texels_volumes", source: ltcforge_wgsl::TEXELS_VOLUMES },
    Shader { name: "texels_array", source: ltcforge_wgsl::TEXELS_ARRAY },
    Shader { name: "ltc_smooth", source: ltcforge_wgsl::LTC_SMOOTH },
    Shader { name: "ltc_function", source: ltcforge_wgsl::LTC_FUNCTION },
    Shader { name: "ltc_decode", source: ltcforge_wgsl::LTC_DECODE },
    Shader { name: "ltc_table", source: ltcforge_wgsl::LTC_TABLE },
    Shader { name: "ltc_lookup", source: ltcforge_wgsl::LTC_LOOKUP },
    Shader { name: "ltc_lookup_among", source: ltcforge_wgsl::LTC_LOOKUP_AMONG },
    Shader { name: "ltc_lookup_round", source: ltcforge_wgsl::LTC_LOOKUP_ROUND },
    Shader { name: "ltc_two_lobes", source: ltcforge_wgsl::LTC_TWO_LOBES },
    Shader { name: "ltc_inverse", source: ltcforge_wgsl::LTC_INVERSE },
    Shader { name: "ltc_rectangle", source: ltcforge_wgsl::LTC_RECTANGLE },
    Shader { name: "ltc_light", source: ltcforge_wgsl::LTC_LIGHT },
    Shader { name: "ltc_shapes", source: ltcforge_wgsl::LTC_SHAPES },
    Shader { name: "ltc_formula", source: ltcforge_wgsl::LTC_FORMULA },
    Shader { name: "ltc_cut", source: ltcforge_wgsl::LTC_CUT },
    Shader { name: "ltc_cut_shapes", source: ltcforge_wgsl::LTC_CUT_SHAPES },
    Shader { name: "ltc_albedo", source: ltcforge_wgsl::LTC_ALBEDO },
    Shader { name: "ltc_compensation", source: ltcforge_wgsl::LTC_COMPENSATION },
    Shader { name: "normals_view", source: ltcforge_wgsl::NORMALS_VIEW },
    Shader { name: "normals_arcs", source: ltcforge_wgsl::NORMALS_ARCS },
    Shader { name: "normals_arcs_rough", source: ltcforge_wgsl::NORMALS_ARCS_ROUGH },
    Shader { name: "normals_edge", source: ltcforge_wgsl::NORMALS_EDGE },
    Shader { name: "normals_outline", source: ltcforge_wgsl::NORMALS_OUTLINE },
    Shader { name: "normals_balanced", source: ltcforge_wgsl::NORMALS_BALANCED },
    Shader { name: "normals_fast", source: ltcforge_wgsl::NORMALS_FAST },
    Shader { name: "normals_fine", source: ltcforge_wgsl::NORMALS_FINE },
    Shader { name: "normals_rectangle", source: ltcforge_wgsl::NORMALS_RECTANGLE },
    Shader { name: "normals_disk", source: ltcforge_wgsl::NORMALS_DISK },
    Shader { name: "gaussians_light", source: ltcforge_wgsl::GAUSSIANS_LIGHT },
    Shader { name: "gaussians_table", source: ltcforge_wgsl::GAUSSIANS_TABLE },
    Shader { name: "textured", source: ltcforge_wgsl::TEXTURED },
    Shader { name: "ltc_textured", source: ltcforge_wgsl::LTC_TEXTURED },
    Shader { name: "normals_textured", source: ltcforge_wgsl::NORMALS_TEXTURED },
    Shader { name: "layers", source: ltcforge_wgsl::LAYERS },
    Shader { name: "sampler", source: ltcforge_wgsl::SAMPLER },
    Shader { name: "sampler_polygon", source: ltcforge_wgsl::SAMPLER_POLYGON },
    Shader { name: "prefilter", source: ltcforge_wgsl::PREFILTER },
    Shader { name: "ltc_formula_compensation", source: ltcforge_wgsl::LTC_FORMULA_COMPENSATION },
    Shader { name: "normals_compensation", source: ltcforge_wgsl::NORMALS_COMPENSATION },
    Shader { name: "gaussians_compensation", source: ltcforge_wgsl::GAUSSIANS_COMPENSATION },
    Shader { name: "ltc_example", source: ltcforge_wgsl::LTC_EXAMPLE },
    Shader { name: "ltc_formula_example", source: ltcforge_wgsl::LTC_FORMULA_EXAMPLE },
    Shader { name: "normals_example", source: ltcforge_wgsl::NORMALS_EXAMPLE },
    Shader { name: "gaussians_example", source: ltcforge_wgsl::GAUSSIANS_EXAMPLE },
    Shader { name: "gaussians_table_example", source: ltcforge_wgsl::GAUSSIANS_TABLE_EXAMPLE },
    Shader { name: "ggx_reference", source: ltcforge_wgsl::GGX_REFERENCE },
    Shader { name: "light_picture", source: ltcforge_wgsl::LIGHT_PICTURE },
    Shader { name: "reference_solids", source: ltcforge_wgsl::REFERENCE_SOLIDS },
    Shader { name: "preview_cut", source: ltcforge_wgsl::PREVIEW_CUT },
    Shader { name: "preview_textured", source: ltcforge_wgsl::PREVIEW_TEXTURED },
    Shader { name: "preview_lobes", source: ltcforge_wgsl::PREVIEW_LOBES },
    Shader { name: "sphere", source: ltcforge_wgsl::SPHERE },
];

/// The parts that read a table in volumes.
const TABLE: [&str; 4] = ["ltc_quadrant", "texels_volumes", "ltc_table", "ltc_lookup"];

/// The named shaders as one text, ordered as in [`SHADERS`]. Without `ltc_light`, `ltc_exact_rectangle` is renamed to
/// `ltc_rectangle`.
#[must_use]
pub fn joined(names: &[&str]) -> String {
    let sources: Vec<&str> = SHADERS.iter().filter(|s| names.contains(&s.name)).map(|shader| shader.source).collect();
    let text = sources.join("\n");
    if names.contains(&"ltc_light") { text } else { text.replace("ltc_exact_rectangle", "ltc_rectangle") }
}

/// The named shaders as one module that reads tables of these layouts.
///
/// A lookup calls `ltc_place_of` and `ltc_restore`, or `ltc_steps` and `ltc_restore`. This function writes them. For
/// one layout, they call the functions of the layout. For several, they switch on the table's layout. A single
/// isotropic layout has its own lookup.
fn module(names: &[&str], layouts: &[Layout]) -> String {
    let parts = parts_of(layouts);
    let (lookup, called) = match layouts {
        [only] => ("", functions_of_one(&only.shader())),
        _ => ("ltc_lookup_among", functions_of_several(layouts)),
    };
    let is_isotropic = matches!(layouts, [only] if only.shader().is_isotropic);
    let lookup = if is_isotropic { "ltc_lookup_round" } else { lookup };
    let is_there = |name: &&str| !(is_isotropic && *name == "ltc_lookup");
    let names: Vec<&str> = names.iter().copied().filter(is_there).chain([lookup]).collect();
    format!("{}\n{}\n{called}", joined(&names), parts.join("\n"))
}

/// The parts of these layouts, without duplicates.
fn parts_of(layouts: &[Layout]) -> Vec<&'static str> {
    let mut parts = Vec::new();
    for part in layouts.iter().flat_map(|layout| layout.shader().sources) {
        if !parts.contains(part) {
            parts.push(*part);
        }
    }
    parts
}

/// The functions that a lookup calls, for one layout.
fn functions_of_one(LayoutShader { place, restore, is_isotropic, .. }: &LayoutShader) -> String {
    if *is_isotropic {
        return format!(
            "/// The place of a configuration along alpha and theta, in coordinates with evenly spaced nodes.\n\
            fn ltc_steps(alpha: f32, wo: vec3<f32>) -> vec2<f32> {{\n    return {place}(alpha, wo);\n}}\n\n\
            /// The lobe of interpolated numbers.\n\
            fn ltc_restore(stored: LtcPlane) -> LtcPlane {{\n    return {restore}(stored);\n}}\n"
        );
    }
    lookup_functions(
        &format!("    return {place}(alpha, ratio, wo);\n"),
        &format!("    return {restore}(stored, alpha, ratio, wo);\n"),
    )
}

/// The functions that a lookup calls, with a switch on the table's layout.
fn functions_of_several(layouts: &[Layout]) -> String {
    let switch = |default: &str, of: &dyn Fn(&LayoutShader) -> String| {
        let case = |layout: &Layout| {
            let shader = layout.shader();
            format!("        case {}u: {{ return {}; }}\n", shader.number, of(&shader))
        };
        let cases: String = layouts.iter().map(case).collect();
        format!("    switch ltc_table.reading.x {{\n{cases}        default: {{ return {default}; }}\n    }}\n")
    };
    let place = |shader: &LayoutShader| {
        if shader.is_isotropic {
            format!("ltc_place_round({}(alpha, wo))", shader.place)
        } else {
            format!("{}(alpha, ratio, wo)", shader.place)
        }
    };
    let restore = |shader: &LayoutShader| {
        if shader.is_isotropic {
            format!("ltc_lobe_of({}(ltc_plane_of(stored)), stored)", shader.restore)
        } else {
            format!("{}(stored, alpha, ratio, wo)", shader.restore)
        }
    };
    lookup_functions(&switch("LtcPlace()", &place), &switch("stored", &restore))
}

fn lookup_functions(place: &str, restore: &str) -> String {
    format!(
        "/// The place of a configuration among the nodes. Domain: the table's ranges, wo in the first quadrant.\n\
        fn ltc_place_of(alpha: f32, ratio: f32, wo: vec3<f32>) -> LtcPlace {{\n{place}}}\n\n\
        /// The lobe of interpolated numbers. Domain: as for ltc_place_of.\n\
        fn ltc_restore(stored: LtcLobe, alpha: f32, ratio: f32, wo: vec3<f32>) -> LtcLobe {{\n{restore}}}\n"
    )
}

/// The preview's shaders for all models except `normals`: their functions, and the preview's entry points instead of
/// the examples.
fn previewed() -> Vec<&'static str> {
    let layouts = [None, Some(Layout::ALL[0])];
    let models = layouts.iter().flat_map(|layout| LightModel::ALL.iter().map(|model| LitBy::new(*model, *layout)));
    let others = models.flatten().filter(|lit_by| lit_by.rule().is_none());
    let lights = others.flat_map(|lit_by| (lit_by.shader().functions)(Lights::All));
    TABLE
        .iter()
        .chain(&["ltc_math", "ltc_two_lobes", "ltc_cut", "ltc_cut_shapes", "ltc_albedo"])
        .chain(lights)
        .chain(&["ggx_reference", "light_picture", "reference_solids"])
        .chain(&["preview_cut", "preview_textured", "preview_lobes", "sphere"])
        .copied()
        .collect()
}

/// The module of the preview. It reads tables of every layout and has model `normals` with each rule. Names in the text
/// of a rule start with the rule's name. Pictures on lights use the texts to include.
#[must_use]
pub fn preview_module() -> String {
    let by_rule = |rule: &NormalsRule| {
        let lit_by = LitBy::new(LightModel::Normals, None).and_then(|lit_by| lit_by.by_rule(Some(*rule)));
        let pictures = lit_by.map(LitBy::previewed_pictures).unwrap_or_default();
        prefixed(&(joined(normals_files(*rule)) + &pictures), "normals", rule.name())
    };
    let rules: Vec<String> = NormalsRule::SHADED.iter().map(by_rule).collect();
    let of_tables = LitBy::from(Layout::ALL[0]).previewed_pictures();
    format!("{}\n{of_tables}\n{}", module(&previewed(), Layout::ALL), rules.join("\n"))
}

/// The module that reads tables of these layouts, without an entry point.
#[must_use]
pub fn table_reader(bound: Bound, layouts: &[Layout]) -> String {
    module(&["ltc_quadrant", texels(bound), "ltc_table", "ltc_lookup", "ltc_two_lobes"], layouts)
}

/// The module for other renderers, with the example program.
#[must_use]
pub fn ported(lit_by: LitBy) -> String {
    assembled(lit_by, TABLE, Lights::All, &[lit_by.shader().example])
}

/// The shaders for a model's light, its table reader if it reads tables, and `others`.
fn assembled(lit_by: LitBy, reader: [&str; 4], lights: Lights, others: &[&str]) -> String {
    let functions = [(lit_by.shader().functions)(lights), &lit_by.added_files(lights)].concat();
    match lit_by.layout() {
        Some(layout) => module(&[&reader[..], &functions, others].concat(), &[layout]),
        None => joined(&[&functions, others].concat()),
    }
}

/// The file that reads the textures.
fn texels(bound: Bound) -> &'static str {
    match bound {
        Bound::Volumes => "texels_volumes",
        Bound::Array => "texels_array",
    }
}

/// The functions for other renderers, without an example.
#[must_use]
pub fn functions(lit_by: LitBy, reading: Reading, lights: Lights) -> String {
    let reader = ["ltc_quadrant", texels(reading.bound), "ltc_table", "ltc_lookup"];
    let others: &[&str] = if reading.two_lobes && lit_by.model() == LightModel::Ltc { &["ltc_two_lobes"] } else { &[] };
    assembled(lit_by, reader, lights, others) + &lit_by.textured(reading)
}

/// The functions for light by a table without textures. `smooth_at` has the coefficients.
#[must_use]
pub fn without_textures(smooth_at: &str, lights: Lights, lit_by: LitBy) -> String {
    let source = ltcforge_wgsl::LAYOUT_REFLECTED;
    let parts = ["ltc_smooth", "ltc_function"];
    format!(
        "{}\n{source}\n{smooth_at}",
        joined(&[&parts[..], light_files(lights), &lit_by.added_files(lights)].concat())
    )
}

#[cfg(test)]
mod tests {
    use naga::valid::{Capabilities, ValidationFlags, Validator};

    use super::*;
    use crate::Additions;
    use ltcforge_light::textured::Readings;

    /// Validates the named shaders together. If they read a table, the parts of layouts are added.
    fn validate(names: &[&str]) {
        assert!(names.iter().all(|name| SHADERS.iter().any(|shader| shader.name == *name)), "{names:?}");
        if names.contains(&"ltc_lookup") {
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
    fn each_shader_is_valid_with_its_declared_dependencies() {
        validate(&["ltc_math"]);
        validate(&TABLE);
        validate(&["ltc_quadrant", "texels_array", "ltc_table", "ltc_lookup"]);
        validate(&["ltc_rectangle", "ltc_light"]);
        validate(&["ltc_rectangle"]);
        validate(&["ltc_inverse", "ltc_rectangle"]);
        validate(&["ltc_math", "ltc_rectangle", "ltc_light", "ltc_shapes"]);
        validate(&["ltc_rectangle", "ltc_light", "ltc_cut"]);
        validate(&["ltc_math", "ltc_rectangle", "ltc_light", "ltc_shapes", "ltc_cut", "ltc_cut_shapes"]);
        validate(&[
            "ltc_quadrant",
            "texels_volumes",
            "ltc_table",
            "ltc_lookup",
            "ltc_inverse",
            "ltc_rectangle",
            "ltc_light",
        ]);
        validate(&["ltc_quadrant", "texels_array", "ltc_table", "ltc_lookup", "ltc_two_lobes"]);
        let layouts = [None, Some(Layout::Reflected)];
        for lit_by in
            layouts.iter().flat_map(|of| LightModel::ALL.iter().map(|model| LitBy::new(*model, *of))).flatten()
        {
            let reader = if lit_by.layout().is_some() { &TABLE[..] } else { &[] };
            let functions = [reader, (lit_by.shader().functions)(Lights::All)].concat();
            validate(&functions);
            validate(&[&functions[..], &[lit_by.shader().example]].concat());
        }
        validate(&["ltc_math", "ltc_rectangle", "ltc_light", "ggx_reference", "light_picture", "reference_solids"]);
        for rule in NormalsRule::SHADED {
            validate(normals_files(rule));
        }
        validate_text(&["preview"], &preview_module());
    }

    /// Validates the text of every rule and layout with its caller, for each number of texture reads. All names of the
    /// shared text must be replaced.
    #[test]
    fn texts_with_pictures_are_valid() {
        let rules = NormalsRule::SHADED.map(|rule| LitBy::new(LightModel::Normals, None)?.by_rule(Some(rule)));
        let tables = Layout::ALL.iter().filter_map(|layout| LitBy::new(LightModel::Ltc, Some(*layout)).ok());
        let mut checked = 0;
        for lit_by in rules.into_iter().map(|rule| rule.expect("a rule")).chain(tables) {
            for (number, reading) in Readings::ALL
                .iter()
                .flat_map(|number| [Reading::ALL[0], Reading::ALL[1]].map(|reading| (*number, reading)))
            {
                for cut in [false, true] {
                    let additions = Additions { cut, textured: Some(number), ..Additions::default() };
                    let Ok(lit_by) = lit_by.with(additions) else { continue };
                    let text = functions(lit_by, reading, Lights::All);
                    assert!(
                        text.contains("_textured_rectangle(") && !text.to_lowercase().contains("fn textured_"),
                        "{text}"
                    );
                    assert!(text.contains(&format!("_READINGS: u32 = {number}u")), "{}", lit_by.name());
                    validate_text(&[&lit_by.name()], &(text + &lit_by.caller(reading, Lights::All)));
                    checked += 1;
                }
            }
        }
        assert!(checked > 100, "{checked}");
        let of = |text: &str| (text.matches("fn normals_mean").count(), text.matches("NormalsTextured").count());
        let plain = LitBy::new(LightModel::Normals, None).expect("normals");
        assert_eq!(of(&functions(plain, Reading::default(), Lights::All)), (1, 0));
        let sg = LitBy::new(LightModel::Sg, None).expect("sg");
        let refused = sg.with(Additions { textured: Some(Readings::Four), ..Additions::default() });
        assert!(refused.expect_err("no pictures").to_string().contains("model sg"));
    }

    #[test]
    fn every_file_of_the_folder_is_listed() {
        let folder = std::fs::read_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/../../shaders")).expect("the folder");
        let texts = folder.filter(|entry| {
            let path = entry.as_ref().expect("an entry").path();
            path.extension().is_some_and(|extension| extension == "wgsl")
        });
        assert_eq!(SHADERS.len() + parts_of(Layout::ALL).len(), texts.count());
    }

    /// Shaders with loops over inputs: over a scene (only in the preview), or over the texels of a picture (in the
    /// prefilter).
    const OVER_INPUTS: [&str; 6] =
        ["ggx_reference", "reference_solids", "preview_cut", "preview_textured", "sphere", "prefilter"];

    /// Whether a line starts a loop from one constant to another: `for (var i = 0u; i < 8u; i++) {`.
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

    /// Whether a word is a number or the name of a constant.
    fn is_constant(word: &str) -> bool {
        let is_name = |c: char| c.is_ascii_uppercase() || "_.xyzw".contains(c);
        word.trim_end_matches('u').parse::<u32>().is_ok()
            || (["LTC_", "TEXTURED_"].iter().any(|prefix| word.starts_with(prefix)) && word.chars().all(is_name))
    }

    /// A driver's compiler can take minutes for a loop without constant bounds.
    #[test]
    fn every_loop_of_an_emitted_shader_has_constant_bounds() {
        let layouts = parts_of(Layout::ALL);
        let emitted = SHADERS.iter().filter(|shader| !OVER_INPUTS.contains(&shader.name));
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
