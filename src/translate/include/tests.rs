//! Includes several texts in one shader.

use std::collections::BTreeSet;

use naga::valid::{Capabilities, ValidationFlags, Validator};

use super::*;
use crate::{include_function, tests::lit_by};
use ltcforge_fit::{IsotropicFunction, Layout, testing::planted_isotropic};
use ltcforge_light::LightModel;
use ltcforge_shaders::{Additions, Filter, Lights, Namespace};

fn namespace(prefix: &str, first_binding: u16) -> Namespace {
    Namespace { prefix: Some(prefix.parse().expect("a prefix")), first_binding, group: 0 }
}

/// Six lights for one shader, each with its own prefix: two tables with different layouts, the two models without a
/// table, a table of Gaussians, and the light without textures.
fn lights(language: Language, reading: Reading) -> [(String, &'static str); 6] {
    let text = |lit_by: LitBy, namespace: &Namespace| {
        include(language, lit_by, reading, Lights::All, namespace).expect("a translation")
    };
    let function = IsotropicFunction::of(&planted_isotropic(Layout::Reflected)).expect("a function");
    let function =
        include_function(language, &function, &[], Lights::All, Additions::default(), &namespace("smooth", 0))
            .expect("a translation");
    [
        (text(Layout::Reflected.into(), &Namespace::default()), "ltc"),
        (text(Layout::Ltc2017.into(), &namespace("iso2", 5)), "iso2"),
        (text(lit_by(LightModel::Normals, None), &Namespace::default()), "normals"),
        (text(lit_by(LightModel::Sg, None), &Namespace::default()), "gaussians"),
        (text(lit_by(LightModel::Asg, Some(Layout::Reflected)), &namespace("fitted", 10)), "fitted"),
        (function, "smooth"),
    ]
}

fn texts() -> impl Iterator<Item = Language> {
    Language::ALL.iter().copied().filter(|language| language.has_includes())
}

/// The names that C-like code declares at file scope: names after a type or keyword, outside all brackets.
fn globals(code: &str) -> BTreeSet<String> {
    let is_code = |line: &&str| !["//", "#", "precision ", "using "].iter().any(|start| line.starts_with(start));
    let code: String = code.lines().filter(is_code).flat_map(|line| [line, "\n"]).collect();
    let code = code.replace("metal::", "");
    let is_part = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let (mut found, mut depth, mut before, mut rest) = (BTreeSet::new(), 0_i32, false, code.as_str());
    while let Some(next) = rest.chars().next() {
        let length = if is_part(next) { rest.find(|c| !is_part(c)).unwrap_or(rest.len()) } else { next.len_utf8() };
        let (token, after) = rest.split_at(length);
        rest = after.trim_start();
        match next {
            '(' | '[' | '{' => depth += 1,
            ')' | ']' | '}' => depth -= 1,
            _ if depth == 0 && is_part(next) && before && rest.starts_with(['(', '{', ';', '=', '[', ':']) => {
                found.insert(token.to_owned());
            }
            _ => {}
        }
        before = is_part(next) || next == '>';
    }
    assert_eq!(depth, 0);
    found
}

#[test]
fn names_of_several_lights_differ_in_every_language() {
    for reading in Reading::ALL {
        for language in texts().filter(|language| *language != Language::Wgsl) {
            let mut all = BTreeSet::new();
            for (text, prefix) in lights(language, reading) {
                let names = globals(&text);
                let name = language.name();
                assert!(names.len() > 12 && names.contains(&format!("{prefix}_disk")), "{name}: {names:?}");
                let capital = prefix[..1].to_uppercase() + &prefix[1..];
                for own in names {
                    let begins = [format!("{prefix}_"), format!("{}_", prefix.to_uppercase()), capital.clone()];
                    assert!(begins.iter().any(|begin| own.starts_with(begin)), "{name}, {prefix}: {own}");
                    assert!(all.insert(own.clone()), "{name}: {own} twice");
                }
            }
        }
    }
}

#[test]
fn several_lights_are_one_module_of_wgsl() {
    let entry = "
@fragment
fn shown() -> @location(0) vec4<f32> {
    let wo = vec3(0.0, 0.0, 1.0);
    let view = normals_view(0.5, 0.5, wo);
    let corners = array<vec3<f32>, 4>(wo, wo, wo, wo);
    return vec4(ltc_lookup(0.5, 0.5, wo).amplitude, iso2_lookup(0.5, 0.5, wo).amplitude,
        smooth_lookup(0.5, 0.5, wo).amplitude, normals_rectangle(view, corners, true).x
            + gaussians_rectangle(gaussians_view(GAUSSIANS_ASG, 0.5, 0.5, wo), corners, true).x
            + fitted_rectangle(fitted_lookup(FITTED_ASG, 0.5, 0.5, wo), corners, true).x);
}
";
    let source = lights(Language::Wgsl, Reading::default()).map(|(text, _)| text).concat() + entry;
    let module =
        naga::front::wgsl::parse_str(&source).unwrap_or_else(|error| panic!("{}", error.emit_to_string(&source)));
    let valid = Validator::new(ValidationFlags::all(), Capabilities::empty()).validate(&module);
    assert!(valid.is_ok(), "{valid:?}");
    let mut bound: Vec<u32> =
        module.global_variables.iter().filter_map(|(_, v)| v.binding.as_ref()).map(|b| b.binding).collect();
    bound.sort_unstable();
    assert_eq!(bound, (0..15).collect::<Vec<u32>>());
}

#[test]
fn the_comment_of_a_second_table_names_its_own_functions_and_bindings() {
    for (language, line) in [
        (Language::Wgsl, "group 0: uniform 5, matrix_a 6, matrix_b 7, terms 8, sampler 9"),
        (Language::Glsl, "block 5, textures iso2_matrix_a 6, iso2_matrix_b 7, iso2_terms 8:"),
        (Language::Hlsl, "uniform b5, matrix_a t6, matrix_b t7, terms t8, sampler s9"),
        (Language::GlslEs, "uniforms iso2_table.nodes and .reading"),
        (Language::Msl, "iso2_terms and iso2_sampler"),
    ] {
        let text = include(language, Layout::Ltc2017, Reading::default(), Lights::All, &namespace("iso2", 5))
            .expect("a translation");
        let name = language.name();
        assert!(text.contains(line) && text.contains("//   iso2_lookup(alpha_x, alpha_y, wo)"), "{name}:\n{text}");
        // Names of files do not change.
        assert!(
            !text.replace("ltc_lookup.wgsl", "").replace("ltc_lookup_round.wgsl", "").contains("ltc_lookup"),
            "{name}"
        );
    }
    for (language, line) in [
        (Language::Wgsl, "group 3: uniform 5, matrix_a 6"),
        (Language::Glsl, "3, the textures with samplers; OpenGL has no sets"),
        (Language::Hlsl, "terms t8, sampler s9, all of space3"),
    ] {
        let namespace = Namespace { group: 3, ..namespace("iso2", 5) };
        let text =
            include(language, Layout::Ltc2017, Reading::default(), Lights::All, &namespace).expect("a translation");
        assert!(text.contains(line), "{}:\n{text}", language.name());
        if language == Language::Wgsl {
            let module = naga::front::wgsl::parse_str(&text).expect("WGSL");
            let bound = module.global_variables.iter().filter_map(|(_, variable)| variable.binding.as_ref());
            let bound: BTreeSet<(u32, u32)> = bound.map(|bound| (bound.group, bound.binding)).collect();
            assert_eq!(bound, (5..10).map(|number| (3, number)).collect());
        }
    }
    let hlsl = include(
        Language::Hlsl,
        Layout::Ltc2017,
        Reading { filter: Filter::Hardware, ..Reading::default() },
        Lights::All,
        &namespace("iso2", 5),
    )
    .expect("a translation");
    for register in ["b5)", "t6)", "t7)", "t8)", "s9)"] {
        assert_eq!(hlsl.matches(&format!("register({register}")).count(), 1, "{register}");
    }
}

/// In every language, the text contains the unevenly spaced nodes, and no other nodes.
#[test]
fn the_text_contains_explicit_nodes() {
    let mut table = ltcforge_shaders::golden_table(Layout::Reflected);
    assert_eq!(GivenAxes::of(&table), None);
    table.axes.alpha = vec![0.04, 0.09, 0.25];
    let given = GivenAxes::of(&table).expect("uneven nodes");
    let about = ["table sha256:12".to_owned()];
    for language in Language::ALL.iter().copied().filter(|language| language.has_includes()) {
        let made = |reading| {
            let lit_by = LitBy::from(Layout::Reflected);
            include_given(language, lit_by, &given, &about, reading, Lights::All, &namespace("brushed", 5))
        };
        for reading in Reading::ALL.into_iter().filter(|reading| reading.filter == Filter::Exact) {
            let text = made(reading).unwrap_or_else(|error| panic!("{error}"));
            assert!(text.contains("BRUSHED_NODES_OF_ALPHA") && text.contains("0.04"), "{text}");
            assert!(!text.contains("NODES_OF_RATIO") && text.contains("table sha256:12"), "{text}");
            assert!(!text.contains("CHECK"), "the check of another table is in the text");
        }
    }
    assert!(
        include_given(
            Language::Spirv,
            LitBy::from(Layout::Reflected),
            &given,
            &about,
            Reading::default(),
            Lights::All,
            &Namespace::default()
        )
        .is_err()
    );
}
