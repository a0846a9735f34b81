use naga::valid::{Capabilities, ValidationFlags, Validator};

mod additions;
mod head;

use super::*;
use ltcforge_fit::{IsotropicFunction, Layout, testing::planted_isotropic};
use ltcforge_light::{LightModel, textured::Readings};
use ltcforge_shaders::{Additions, Bound, CASES, Filter, Language, Lights, LitBy, Namespace, Reading};

pub(super) fn lit_by(model: LightModel, layout: Option<Layout>) -> LitBy {
    LitBy::new(model, layout).expect("a model that supports this layout")
}

fn header(language: Language, layout: Layout) -> String {
    LitBy::from(layout).comment(language)
}

fn ported(language: Language, lit_by: impl Into<LitBy>) -> Vec<u8> {
    let lit_by = lit_by.into();
    port(language, lit_by).unwrap_or_else(|error| panic!("{lit_by:?}: {error}"))
}

fn programs() -> impl Iterator<Item = Language> {
    Language::ALL.iter().copied().filter(|language| language.has_programs())
}

fn text(language: Language, lit_by: impl Into<LitBy>) -> String {
    String::from_utf8(ported(language, lit_by)).expect("UTF-8")
}

/// The code without comments and header.
fn code(text: &str) -> String {
    text.lines()
        .filter(|line| !line.trim_start().starts_with("//"))
        .fold(String::new(), |code, line| code + line + "\n")
}

/// Whether a text starts with a comment, after the `#version` line of GLSL. The digest in `header` is still a
/// placeholder.
fn begins_with(text: &str, header: &str) -> bool {
    let text = text.strip_prefix("#version").and_then(|rest| rest.split_once('\n')).map_or(text, |(_, below)| below);
    let (before, behind) = header.split_once("{digest}").expect("a digest");
    text.strip_prefix(before)
        .is_some_and(|rest| rest.split_at_checked(16).is_some_and(|(_, rest)| rest.starts_with(behind)))
}

/// The values in the lines of a header that start with `word`, in the order of the cases.
fn numbers_after<'a>(text: &'a str, word: &'a str) -> impl Iterator<Item = Vec<f64>> + 'a {
    text.lines()
        .filter_map(move |line| line.trim_start_matches(['/', ' ']).strip_prefix(word))
        .map(|line| line.split([' ', '(', ')']).filter_map(|word| word.parse().ok()).collect::<Vec<f64>>())
}

#[test]
fn every_language_has_header_and_functions_of_either_layout() {
    for &layout in Layout::ALL {
        for language in programs().filter(|language| *language != Language::Spirv) {
            let text = text(language, layout);
            let name = language.name();
            let header = header(language, layout);
            assert!(
                header.is_ascii() && header.lines().all(|line| line.starts_with("//") && line.len() <= 124),
                "{name}"
            );
            assert!(begins_with(&text, &header), "{name}");
            for line in ["MIT OR Apache-2.0", "BINDINGS", "EXAMPLE", "FUNCTIONS", "CHECK", layout.name()] {
                assert!(header.contains(line), "{name}: {line}");
            }
            let code = code(&text);
            for function in TABLE_FUNCTIONS {
                assert!(code.contains(&format!("{function}(")), "{name}: {function}");
            }
        }
    }
}

/// The light models without a table. Each has its comment and its functions.
fn without_a_table(language: Language) -> [(LitBy, String, &'static [&'static str]); 3] {
    let formula = lit_by(LightModel::LtcFormula, None);
    [
        (formula, formula.comment(language), &FORMULA_FUNCTIONS),
        (lit_by(LightModel::Normals, None), lit_by(LightModel::Normals, None).comment(language), &NORMALS_FUNCTIONS),
        (lit_by(LightModel::Asg, None), lit_by(LightModel::Asg, None).comment(language), &GAUSSIANS_FUNCTIONS),
    ]
}

const TABLE_FUNCTIONS: [&str; 8] =
    ["ltc_lookup", "ltc_inverse", "ltc_rectangle", "ltc_polygon", "ltc_disk", "ltc_sphere", "ltc_tube", "ltc_line"];
const FORMULA_FUNCTIONS: [&str; 7] =
    ["ltc_formula", "ltc_rectangle", "ltc_polygon", "ltc_disk", "ltc_sphere", "ltc_tube", "ltc_line"];
const NORMALS_FUNCTIONS: [&str; 4] = ["normals_view", "normals_rectangle", "normals_polygon", "normals_disk"];
const GAUSSIANS_FUNCTIONS: [&str; 5] =
    ["gaussians_view", "gaussians_rectangle", "gaussians_polygon", "gaussians_disk", "gaussians_sg"];

const GAUSSIANS_TABLE_FUNCTIONS: [&str; 5] =
    ["gaussians_lookup", "gaussians_rectangle", "gaussians_polygon", "gaussians_disk", "gaussians_sg"];

#[test]
fn every_language_has_the_shader_of_a_table_of_gaussians() {
    for layout in [Layout::Reflected, Layout::Kt2022] {
        let lit_by = lit_by(LightModel::Asg, Some(layout));
        for language in programs().filter(|language| *language != Language::Spirv) {
            let (text, name) = (text(language, lit_by), language.name());
            let header = lit_by.comment(language);
            assert!(header.is_ascii() && header.lines().all(|l| l.starts_with("//") && l.len() <= 124), "{name}");
            assert!(begins_with(&text, &header) && header.contains(layout.name()), "{name}");
            let code = code(&text);
            for function in GAUSSIANS_TABLE_FUNCTIONS {
                assert!(code.contains(&format!("{function}(")), "{name}: {function}");
            }
            assert!(code.contains("ltc_lookup(") && !code.contains("ltc_inverse("), "{name}");
        }
        assert_eq!(ported(Language::Spirv, lit_by)[..4], [0x03, 0x02, 0x23, 0x07]);
    }
}

#[test]
fn every_language_has_the_shaders_without_a_table() {
    for language in programs().filter(|language| *language != Language::Spirv) {
        for (lit_by, header, functions) in without_a_table(language) {
            let (text, name) = (text(language, lit_by), language.name());
            assert!(header.is_ascii() && header.lines().all(|l| l.starts_with("//") && l.len() <= 124), "{name}");
            assert!(begins_with(&text, &header), "{name}");
            let code = code(&text);
            for function in functions {
                assert!(code.contains(&format!("{function}(")), "{name}: {function}");
            }
            assert!(!code.contains("ltc_table") && !code.contains("sampler"), "{name} needs a table");
        }
    }
    for (lit_by, ..) in without_a_table(Language::Spirv) {
        assert_eq!(ported(Language::Spirv, lit_by)[..4], [0x03, 0x02, 0x23, 0x07]);
    }
}

#[test]
fn each_language_has_its_own_syntax() {
    // GLSL has a fixed name for the entry point.
    let entries =
        [(Language::Glsl, "void main()"), (Language::Hlsl, "void ltc_example()"), (Language::Msl, "void ltc_example(")];
    let signs = [
        (Language::Glsl, "#version 450"),
        (Language::GlslEs, "#version 310 es"),
        (Language::Hlsl, "[numthreads(1, 1, 1)]"),
        (Language::Msl, "#include <metal_stdlib>"),
    ];
    for (language, sign) in signs.into_iter().chain(entries) {
        assert!(code(&text(language, Layout::Reflected)).contains(sign), "{}", language.name());
    }
}

#[test]
fn the_version_of_glsl_comes_before_the_comment() {
    for (language, version) in [(Language::Glsl, "#version 450"), (Language::GlslEs, "#version 310 es")] {
        assert!(text(language, lit_by(LightModel::Normals, None)).starts_with(version), "{}", language.name());
    }
}

#[test]
fn a_translation_has_no_code_of_the_other_layout_nor_a_sampler() {
    for language in [Language::Glsl, Language::Hlsl, Language::Msl] {
        let name = language.name();
        let (kt2022, reflected) = (code(&text(language, Layout::Kt2022)), code(&text(language, Layout::Reflected)));
        for (code, own, other) in [(&kt2022, "kt2022", "reflected"), (&reflected, "reflected", "kt2022")] {
            assert!(code.contains(&format!("ltc_restore_{own}")), "{name}");
            assert!(!code.contains(&format!("ltc_restore_{other}")), "{name}");
        }
        for code in [kt2022, reflected] {
            assert!(!code.contains("ltc_fetch_filtered") && !code.to_lowercase().contains("samplerstate"), "{name}");
        }
    }
}

#[test]
fn wgsl_with_a_fixed_layout_is_valid() {
    for &layout in Layout::ALL {
        let text = text(Language::Wgsl, layout);
        let own = layout.shader();
        assert!(
            text.contains(&format!("return {}(", own.restore))
                && (text.contains("fn ltc_place_of(") || text.contains("fn ltc_steps(")),
            "{layout}"
        );
        for other in Layout::ALL.iter().map(|other| other.shader()) {
            let is_there = text.contains(&format!("fn {}(", other.restore));
            let is_own = own.sources.concat().contains(&format!("fn {}(", other.restore));
            assert_eq!(is_there, is_own, "{layout}: {}", other.restore);
        }
        let module =
            naga::front::wgsl::parse_str(&text).unwrap_or_else(|error| panic!("{}", error.emit_to_string(&text)));
        let valid = Validator::new(ValidationFlags::all(), Capabilities::empty()).validate(&module);
        assert!(valid.is_ok(), "{valid:?}");
    }
}

#[test]
fn spirv_is_words_that_begin_with_the_magic_number_and_hold_the_header() {
    for &layout in Layout::ALL {
        let bytes = ported(Language::Spirv, layout);
        assert_eq!(bytes.len() % 4, 0);
        assert_eq!(bytes[..8], [0x03, 0x02, 0x23, 0x07, 0x00, 0x03, 0x01, 0x00]);
        let header = header(Language::Spirv, layout);
        let first = header.lines().nth(2).expect("a line").as_bytes();
        assert!(bytes.windows(first.len()).any(|window| window == first));
    }
}

#[test]
fn metal_and_opengl_have_the_bindings_of_the_header() {
    let glsl = code(&text(Language::Glsl, Layout::Reflected));
    for line in [
        "layout(std140, binding = 0) uniform ",
        "layout(std140, binding = 1) uniform ",
        "layout(std430, binding = 2) buffer ",
        "layout(binding = 0) uniform sampler3D ",
        "layout(binding = 1) uniform sampler3D ",
        "layout(binding = 2) uniform sampler3D ",
    ] {
        assert_eq!(glsl.matches(line).count(), 1, "{line}:\n{glsl}");
    }
    let msl = code(&text(Language::Msl, Layout::Reflected));
    for slot in ["buffer(0)", "buffer(1)", "buffer(2)", "texture(0)", "texture(1)", "texture(2)"] {
        assert!(msl.contains(&format!("[[{slot}]]")), "{slot}");
    }
    let hlsl = code(&text(Language::Hlsl, Layout::Reflected));
    for register in ["b0)", "t1)", "t2)", "t3)", "b0, space1)", "u1, space1)"] {
        assert!(hlsl.contains(&format!("register({register}")), "{register}");
    }
}

#[test]
fn the_same_arguments_give_the_same_bytes() {
    for language in programs() {
        assert_eq!(ported(language, Layout::Reflected), ported(language, Layout::Reflected), "{}", language.name());
    }
}

#[test]
fn the_header_prints_the_values_of_the_table() {
    for &layout in Layout::ALL {
        let header = header(Language::Wgsl, layout);
        let matrices: Vec<_> = numbers_after(&header, "M ").filter(|numbers| numbers.len() == 9).collect();
        let terms: Vec<_> = numbers_after(&header, "amplitude ").filter(|numbers| numbers.len() == 3).collect();
        assert_eq!((matrices.len(), terms.len()), (CASES.len(), CASES.len()));
        for (case, (matrix, terms)) in CASES.iter().zip(matrices.iter().zip(&terms)) {
            let golden = case.golden(layout);
            let expected = golden.matrix.iter().chain([&golden.amplitude, &golden.fresnel, &golden.covered]);
            for (printed, expected) in matrix.iter().chain(terms).zip(expected) {
                assert!((printed - expected).abs() <= 0.51e-6, "{case:?}: {printed} {expected}");
            }
        }
    }
}

#[test]
fn the_cases_cover_every_fold_and_partly_cover_the_lobe() {
    assert!(CASES.iter().any(|case| case.alpha_y > case.alpha_x));
    assert!(CASES.iter().any(|case| case.wo[0] < 0.0) && CASES.iter().any(|case| case.wo[1] < 0.0));
    for (layout, case) in Layout::ALL.iter().flat_map(|layout| CASES.map(|case| (*layout, case))) {
        let length2: f64 = case.wo.iter().map(|x| x * x).sum();
        assert!((length2 - 1.0).abs() < 1e-12);
        let covered = case.golden(layout).covered;
        assert!((0.02..0.98).contains(&covered), "{layout:?} {case:?}: {covered}");
    }
}

/// Every shader text, by language and kind of light.
fn includes() -> impl Iterator<Item = (Language, LitBy, String)> {
    let gaussian = lit_by(LightModel::Sg, None);
    let gaussian_table = lit_by(LightModel::Asg, Some(Layout::Reflected));
    let [formula, normals] = [LightModel::LtcFormula, LightModel::Normals].map(|model| lit_by(model, None));
    let lights = [Layout::Reflected.into(), Layout::Kt2022.into(), formula, normals, gaussian, gaussian_table];
    let languages = Language::ALL.iter().copied().filter(|language| language.has_includes());
    languages.flat_map(move |language| {
        lights.into_iter().flat_map(move |lit_by| {
            Reading::ALL.into_iter().map(move |reading| {
                let text = include(language, lit_by, reading, Lights::All, &Namespace::default())
                    .unwrap_or_else(|error| panic!("{lit_by:?}: {error}"));
                (language, lit_by, text)
            })
        })
    })
}

#[test]
fn texts_to_include_have_functions_and_no_program() {
    for (language, lit_by, text) in includes() {
        let name = language.name();
        // The text for a rule does not have these sections.
        let has_sections = lit_by.rule().is_none();
        for word in ["FUNCTIONS", "USE"].into_iter().filter(|_| has_sections).chain(["MIT OR Apache-2.0", "CHECK"]) {
            assert!(text.contains(word), "{name}: {word}");
        }
        let code = code(&text);
        for word in [
            "main(",
            "ltc_included",
            "ltc_example",
            "ltc_formula_example",
            "normals_example",
            "gaussians_example",
            "gaussians_table_example",
            "#version",
            "@compute",
            "numthreads",
            "_group_",
        ] {
            assert!(!code.contains(word), "{name}: {word}");
        }
        let functions: &[&str] = match (lit_by.model(), lit_by.layout()) {
            (LightModel::Ltc, _) => &TABLE_FUNCTIONS,
            (LightModel::LtcFormula, _) => &FORMULA_FUNCTIONS,
            (LightModel::Normals, _) => &NORMALS_FUNCTIONS,
            (LightModel::Sg | LightModel::Asg, None) => &GAUSSIANS_FUNCTIONS,
            (LightModel::Sg | LightModel::Asg, Some(_)) => &GAUSSIANS_TABLE_FUNCTIONS,
        };
        for function in functions {
            assert!(code.contains(&format!("{function}(")), "{name}: {function}");
        }
        assert!(lit_by.layout().is_some() || !code.contains("ltc_table"), "{name}");
    }
}

/// The text for polygons is the text for all lights, but without the other shapes.
#[test]
fn texts_for_polygons_omit_the_other_shapes() {
    let texts = |language, lights| {
        let function = IsotropicFunction::of(&planted_isotropic(Layout::Reflected)).expect("a function");
        [
            include(language, Layout::Reflected, Reading::default(), lights, &Namespace::default()),
            include_function(language, &function, &[], lights, Additions::default(), &Namespace::default()),
        ]
        .map(|text| text.expect("a translation"))
    };
    for language in Language::ALL.iter().copied().filter(|language| language.has_includes()) {
        let name = language.name();
        for (all, polygons) in texts(language, Lights::All).iter().zip(&texts(language, Lights::Polygons)) {
            let (left, right) = TABLE_FUNCTIONS.split_at(4);
            assert!(left.iter().all(|function| code(polygons).contains(&format!("{function}("))), "{name}");
            for shape in right {
                assert!(!polygons.contains(shape) && all.contains(shape), "{name}: {shape}");
            }
            println!("{name}: {} bytes, {} for polygons", all.len(), polygons.len());
            assert!(polygons.len() + 10_000 < all.len(), "{name}: {} {}", polygons.len(), all.len());
        }
        let normals = [Lights::All, Lights::Polygons].map(|lights| {
            include(language, lit_by(LightModel::Normals, None), Reading::default(), lights, &Namespace::default())
        });
        assert_eq!(normals[0].as_ref().ok(), normals[1].as_ref().ok(), "{name}");
    }
}

#[test]
fn texts_to_include_have_the_bindings_of_their_comment() {
    let included_from = |language, filter, bound| {
        let reading = Reading { filter, bound, two_lobes: false };
        code(&include(language, Layout::Reflected, reading, Lights::All, &Namespace::default()).expect("a text"))
    };
    let included = |language, filter| included_from(language, filter, Bound::Volumes);
    let glsl = included(Language::Glsl, Filter::Exact);
    for line in [
        "layout(std140, binding = 0) uniform ",
        "layout(binding = 1) uniform sampler3D ltc_matrix_a;",
        "layout(binding = 2) uniform sampler3D ltc_matrix_b;",
        "layout(binding = 3) uniform sampler3D ltc_terms;",
    ] {
        assert_eq!(glsl.matches(line).count(), 1, "{line}:\n{glsl}");
    }
    for language in [Language::Glsl330, Language::GlslEs] {
        for (filter, fetch) in [(Filter::Exact, "texelFetch("), (Filter::Hardware, "textureLod(")] {
            let text = included(language, filter);
            for line in ["uniform LtcTable ltc_table;", "sampler3D ltc_matrix_a;"] {
                assert_eq!(text.matches(line).count(), 1, "{} {line}:\n{text}", language.name());
            }
            assert!(text.contains(fetch) && !text.contains("buffer"), "{} {filter:?}", language.name());
        }
    }
    let hlsl = included(Language::Hlsl, Filter::Hardware);
    for register in ["b0)", "t1)", "t2)", "t3)", "s4)"] {
        assert_eq!(hlsl.matches(&format!("register({register}")).count(), 1, "{register}");
    }
    assert!(!hlsl.contains("nagaSampler") && !included(Language::Hlsl, Filter::Exact).contains("ltc_sampler"));
    let array = |language| included_from(language, Filter::Hardware, Bound::Array);
    for language in [Language::Glsl330, Language::GlslEs] {
        let text = array(language);
        assert!(text.contains("sampler2DArray ltc_layers;") && !text.contains("sampler3D"), "{text}");
        assert_eq!(text.matches("sampler2DArray").count(), 1, "{text}");
    }
    let hlsl = array(Language::Hlsl);
    for register in ["b0)", "t1)", "s2)"] {
        assert_eq!(hlsl.matches(&format!("register({register}")).count(), 1, "{register}");
    }
    assert_eq!(hlsl.matches("register(").count(), 3);
    let refused = include(Language::Spirv, Layout::Reflected, Reading::default(), Lights::All, &Namespace::default())
        .expect_err("no text");
    assert!(refused.to_string().contains("include"), "{refused}");
    assert!(
        port(Language::Glsl330, lit_by(LightModel::Normals, None))
            .expect_err("no program")
            .to_string()
            .contains("compute")
    );
}
