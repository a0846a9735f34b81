//! What is added to texts where it is chosen.

use std::collections::BTreeSet;

use super::*;

/// An addition is there where it is chosen and explained there, and the rest of the code is as it was.
#[test]
fn a_text_that_cuts_lights_at_the_surface_has_all_the_others_too() {
    let cut = Additions { cut: true, compensate: false };
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
            // Declarations may stand in another order.
            let lines: BTreeSet<&str> = with.lines().collect();
            let missing = code(without).lines().filter(|line| !lines.contains(line)).count();
            assert_eq!(missing, 0, "{name}");
            println!("{name} {}: {} bytes more", lights.name(), with.len() - without.len());
        }
    }
    let refused = lit_by(LightModel::Normals, None).with(cut).expect_err("nothing to cut");
    assert!(refused.to_string().contains("model normals"), "{refused}");
}

/// The factor for metals is there where it is chosen and explained there, by every model.
#[test]
fn a_text_that_compensates_has_a_factor_more() {
    let models = [
        (LightModel::Ltc, Some(Layout::Ltc2017), "ltc_compensation"),
        (LightModel::Normals, None, "normals_compensation"),
        (LightModel::Sg, None, "gaussians_compensation"),
        (LightModel::Asg, Some(Layout::Kt2022), "gaussians_compensation"),
    ];
    for language in Language::ALL.iter().copied().filter(|language| language.has_includes()) {
        for (model, layout, function) in models {
            let text = |compensate| {
                let additions = Additions { cut: false, compensate };
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
