//! Optional functions in shader texts.

use std::collections::BTreeSet;

use super::*;

/// An added function is in the text and described in its comment. The other code does not change.
#[test]
fn a_text_that_cuts_lights_keeps_all_other_functions() {
    let cut = Additions { cut: true, compensate: false, textured: None };
    let function = IsotropicFunction::of(&planted_isotropic(Layout::Reflected)).expect("a function");
    for (language, lights) in Language::ALL
        .iter()
        .copied()
        .filter(|language| language.has_includes())
        .flat_map(|language| Lights::ALL.iter().map(move |lights| (language, *lights)))
    {
        let texts = |additions: Additions| {
            let table = LitBy::from(Layout::Reflected).with(additions).expect("a table of LTCs");
            [
                include(language, table, Reading::default(), lights, &Namespace::default()),
                include_function(language, &function, &[], lights, additions, &Namespace::default()),
            ]
            .map(|text| text.expect("a translation"))
        };
        let name = language.name();
        for (with, without) in texts(cut).iter().zip(&texts(Additions::default())) {
            for function in TABLE_FUNCTIONS.iter().filter(|function| without.contains(&format!("{function}("))) {
                let function = function.replace("ltc_", "ltc_cut_");
                let wanted = !["ltc_cut_lookup", "ltc_cut_inverse"].contains(&function.as_str());
                assert_eq!(code(with).contains(&format!("{function}(")), wanted, "{name}: {function}");
                assert_eq!(with.lines().filter(|line| line.starts_with("//")).any(|l| l.contains(&function)), wanted);
                assert!(!without.contains(&function), "{name}: {function}");
            }
            let explained =
                with.lines().skip_while(|line| *line != "// LIGHT FROM BELOW").take_while(|line| *line != "//");
            let lengths: Vec<usize> = explained.map(str::len).collect();
            assert!(lengths.len() == 4 && lengths.iter().all(|length| *length <= 124), "{name}: {lengths:?}");
            // The order of the declarations can differ.
            let lines: BTreeSet<&str> = with.lines().collect();
            let missing = code(without).lines().filter(|line| !lines.contains(line)).count();
            assert_eq!(missing, 0, "{name}");
            println!("{name} {}: {} bytes more", lights.name(), with.len() - without.len());
        }
    }
    let refused = lit_by(LightModel::Normals, None).with(cut).expect_err("nothing to cut");
    assert!(refused.to_string().contains("model normals"), "{refused}");
}

/// For every model, the factor for metals is in the text and described in its comment.
#[test]
fn a_text_that_compensates_has_the_factor() {
    let models = [
        (LightModel::Ltc, Some(Layout::Ltc2017), "ltc_compensation"),
        (LightModel::LtcFormula, None, "ltc_formula_compensation"),
        (LightModel::Normals, None, "normals_compensation"),
        (LightModel::Sg, None, "gaussians_compensation"),
        (LightModel::Asg, Some(Layout::Kt2022), "gaussians_compensation"),
    ];
    for language in Language::ALL.iter().copied().filter(|language| language.has_includes()) {
        for (model, layout, function) in models {
            let text = |compensate| {
                let additions = Additions { cut: false, compensate, textured: None };
                let lit_by = lit_by(model, layout).with(additions).expect("a model");
                include(language, lit_by, Reading::default(), Lights::All, &Namespace::default()).expect("a text")
            };
            let (with, without) = (text(true), text(false));
            assert!(code(&with).contains(&format!("{function}(")), "{}: {function}", language.name());
            assert!(with.contains("// ENERGY") && with.contains(&format!("//   {function}(")), "{function}");
            assert!(!without.contains("compensation") && !without.contains("_albedo("), "{function}");
            println!("{} {model}: {} bytes more", language.name(), with.len() - without.len());
        }
    }
}

/// In every language, the text reads pictures on lights, with its own names and with bindings that follow those of a
/// table. The other code does not change.
#[test]
fn a_text_with_pictures_binds_and_reads_them() {
    let readings = [
        (LightModel::LtcFormula, None, Reading::default(), [0, 1]),
        (LightModel::Normals, None, Reading::default(), [0, 1]),
        (LightModel::Ltc, Some(Layout::Reflected), Reading::default(), [5, 6]),
        (LightModel::Ltc, Some(Layout::Ltc2017), Reading { bound: Bound::Array, ..Reading::default() }, [3, 4]),
    ];
    for language in Language::ALL.iter().copied().filter(|language| language.has_includes()) {
        for (model, layout, reading, [picture, sampler]) in readings {
            let text = |textured| {
                let additions = Additions { textured, ..Additions::default() };
                let lit_by = lit_by(model, layout).with(additions).expect("a model");
                include(language, lit_by, reading, Lights::Polygons, &Namespace::default()).expect("a text")
            };
            let name = language.name();
            let (with, without) = (text(Some(Readings::Six)), text(None));
            let own = if model.is_of_ltcs() { "ltc" } else { "normals" };
            for function in [format!("{own}_textured_rectangle("), format!("{own}_profile_rectangle(")] {
                assert!(code(&with).contains(&function) && !without.contains(&function), "{name}: {function}");
                assert!(with.contains("// PICTURES ON LIGHTS") && with.contains(&format!("//   {function}")), "{name}");
            }
            assert!(!without.contains("textured"), "{name}");
            let explained =
                with.lines().skip_while(|line| *line != "// PICTURES ON LIGHTS").take_while(|line| *line != "//");
            let lengths: Vec<usize> = explained.map(str::len).collect();
            assert!(lengths.len() == 12 && lengths.iter().all(|length| *length <= 130), "{name}: {lengths:?}");
            let lines: BTreeSet<&str> = with.lines().collect();
            let missing = code(&without).lines().filter(|line| !lines.contains(line)).count();
            // Functions in MSL take resources as arguments.
            assert!(missing == 0 || language == Language::Msl, "{name}: {missing}");
            let bound = match language {
                Language::Wgsl => [
                    format!("@group(0) @binding({picture}) var {own}_pictures: texture_2d_array<f32>;"),
                    format!("@group(0) @binding({sampler}) var {own}_picture_sampler: sampler;"),
                ],
                Language::Glsl => [
                    format!("layout(binding = {picture}) uniform sampler2DArray {own}_pictures;"),
                    "textureLod(".to_owned(),
                ],
                Language::Glsl330 | Language::GlslEs => {
                    [format!("sampler2DArray {own}_pictures;"), "textureLod(".to_owned()]
                }
                Language::Hlsl => [
                    format!("Texture2DArray<float4> {own}_pictures : register(t{picture});"),
                    format!("SamplerState {own}_picture_sampler : register(s{sampler});"),
                ],
                Language::Msl => [format!("{own}_pictures"), format!("{own}_picture_sampler")],
                Language::Spirv => unreachable!("it has no text"),
            };
            assert!(bound.iter().all(|line| with.contains(line.as_str())), "{name}: {bound:?}\n{with}");
            println!("{name} {model}: {} bytes more", with.len() - without.len());
        }
    }
}

/// The text for rectangles has no other lights, with and without the cut, and is short enough to paste: 9 KiB of GLSL.
#[test]
fn texts_for_rectangles_are_short() {
    let text = |language, cut| {
        let additions = Additions { cut, ..Additions::default() };
        let lit_by = lit_by(LightModel::LtcFormula, None).with(additions).expect("an LTC");
        include(language, lit_by, Reading::default(), Lights::Rectangles, &Namespace::default()).expect("a text")
    };
    for language in Language::ALL.iter().copied().filter(|language| language.has_includes()) {
        let [short, cut] = [false, true].map(|cut| text(language, cut));
        assert!(code(&short).contains("ltc_rectangle(") && code(&cut).contains("ltc_cut_rectangle("), "{language:?}");
        assert!(!short.contains("ltc_polygon") && !short.contains("CHEAP_HORIZON"), "{language:?}");
        println!("{}: {} bytes", language.name(), short.len());
        assert!(short.len() < 9700, "{language:?}: {}", short.len());
    }
    let glsl = text(Language::Glsl, false);
    let lobe = glsl.find("// An LTC of anisotropic GGX").expect("the lobe");
    assert!(glsl.len() <= 9 * 1024 && glsl.len() - lobe <= 4 * 1024, "{} {}", glsl.len(), glsl.len() - lobe);
}
