use proptest::prelude::*;

use super::*;
use ltcforge_fit::{BrdfKind, Layout, LobeModel, Metric, Solver, StoredTerms};

fn recipe(json: &str) -> Result<Recipe, RecipeError> {
    parse(json.as_bytes(), DEFAULT_ENTRY_LIMIT)
}

fn pointers(json: &str) -> Vec<String> {
    match recipe(json) {
        Err(RecipeError::Faults(faults)) => faults.into_iter().map(|fault| fault.pointer).collect(),
        other => panic!("{json} gave {other:?}"),
    }
}

#[test]
fn an_empty_document_is_the_standard_preset() {
    let default = recipe("{}").expect("a recipe");
    assert_eq!(Ok(default.clone()), recipe(r#"{"preset": "standard"}"#));
    assert_eq!(default.entries(), 10 * 6 * 9 * 7);
    assert_eq!(default.fit, Preset::Standard.fit());
}

#[test]
fn explicit_fields_win_over_the_preset() {
    let paper = recipe(r#"{"preset": "paper", "fit": {"samples": 64, "solver": "sgd"}}"#).expect("a recipe");
    assert_eq!(paper.fit.samples, 64);
    assert_eq!(paper.fit.solver, Solver::Sgd);
    assert_eq!(paper.fit.directions, Preset::Paper.fit().directions);
}

#[test]
fn the_canonical_form_reads_back_as_itself() {
    for preset in Preset::ALL {
        let first = recipe(&format!(r#"{{"preset": "{}"}}"#, preset.name())).expect("a recipe");
        let text = canonical_json(&first);
        assert!(text.starts_with(r#"{"brdf":"ggx","fit":{"directions":"#), "{text}");
        let second = recipe(&text).expect("a recipe");
        assert_eq!((digest(&first), &first), (digest(&second), &second));
    }
}

#[test]
fn equal_recipes_have_equal_digests_however_they_are_written() {
    let a = recipe(r#"{"range": {"alpha": [-0.0, 1]}, "preset": "standard"}"#).expect("a recipe");
    let b = recipe(r#"{ "range": {"alpha": [0, 1.0]} }"#).expect("a recipe");
    assert_eq!(digest(&a), digest(&b));
    assert_ne!(digest(&a), digest(&recipe(r#"{"fit": {"seed": 1}}"#).expect("a recipe")));
}

#[test]
fn equal_mixes_of_materials_are_one_recipe_and_a_mix_is_another_than_none() {
    let of = |fresnel: &str| digest(&recipe(&format!(r#"{{"fresnel": {fresnel}}}"#)).expect("a recipe"));
    let none = digest(&recipe("{}").expect("a recipe"));
    let mix = of(r#"[{"f0": 0.04, "weight": 2}, {"f0": 1}]"#);
    assert_eq!([of(r#""one""#), of(r#"[{"f0": 1, "weight": 7}]"#)], [none, none]);
    assert_eq!(mix, of(r#"[{"weight": 3, "f0": 1}, {"f0": 0.5, "weight": 0}, {"f0": 0.04, "weight": 6}]"#));
    assert_ne!(mix, none);
    let read = recipe(r#"{"fresnel": [{"f0": 0.04, "weight": 2}, {"f0": 1}]}"#).expect("a recipe");
    let text = canonical_json(&read);
    assert!(text.contains(r#""fresnel":[{"f0":0.04,"weight":1},{"f0":1,"weight":0.5}]"#), "{text}");
    assert_eq!(recipe(&text), Ok(read));
}

#[test]
fn faults_of_materials_are_reported_at_their_place() {
    let found = pointers(
        r#"{"fresnel": [{"f0": -0.1, "weight": "much"}, {"f0": 1.5}, 0.04, {"weight": 1}, {"f0": 0.5, "F90": 1}]}"#,
    );
    let wanted =
        ["/fresnel/0/f0", "/fresnel/0/weight", "/fresnel/1/f0", "/fresnel/2", "/fresnel/3/f0", "/fresnel/4/F90"];
    assert_eq!(found, wanted);
    for alone in [
        r#"{"fresnel": []}"#,
        r#"{"fresnel": 0.04}"#,
        r#"{"fresnel": "two"}"#,
        r#"{"brdf": "charlie", "fresnel": "two_lobes"}"#,
        r#"{"lobe": "sg", "fresnel": "blended_lobes"}"#,
        r#"{"fresnel": null}"#,
        r#"{"fresnel": [{"f0": 0.04, "weight": 0}]}"#,
        r#"{"fresnel": [{"f0": 0}, {"f0": 1, "weight": 0}]}"#,
        r#"{"brdf": "charlie", "fresnel": [{"f0": 0.04}]}"#,
    ] {
        assert_eq!(pointers(alone), ["/fresnel"], "{alone}");
    }
    let wrong_too = r#"{"brdf": "charlie", "fresnel": [{"f0": 1.5, "weight": -1}]}"#;
    assert_eq!(pointers(wrong_too), ["/fresnel", "/fresnel/0/f0", "/fresnel/0/weight"]);
    assert_eq!(pointers(r#"{"lobe": "sg", "fresnel": "two_lobes", "terms": false}"#), ["/terms", "/fresnel", "/terms"]);
    for two in ["two_lobes", "blended_lobes"] {
        let read = recipe(&format!(r#"{{"brdf": "beckmann", "fresnel": "{two}"}}"#)).expect("a recipe");
        assert!(canonical_json(&read).contains(&format!(r#""fresnel":"{two}""#)), "{}", canonical_json(&read));
        assert_eq!(recipe(&canonical_json(&read)), Ok(read));
    }
    assert!(recipe(r#"{"brdf": "beckmann", "fresnel": [{"f0": 0}, {"f0": 1}]}"#).is_ok());
}

#[test]
fn every_fault_is_reported_at_once() {
    let found = pointers(
        r#"{"preset": "papre", "colour": 1, "a/b": 0, "terms": "yes", "fitter": 0,
            "fit": {"samples": 1.5, "seed": -1, "speed": 9}, "range": {"alpha": [0.5, 0.1], "theta": [0, 2]},
            "resolution": {"alpha": 1, "phi": 0}}"#,
    );
    for pointer in [
        "/preset",
        "/colour",
        "/a~1b",
        "/terms",
        "/fitter",
        "/fit/samples",
        "/fit/seed",
        "/fit/speed",
        "/range/alpha",
        "/range/theta",
        "/resolution/alpha",
        "/resolution/phi",
    ] {
        assert!(found.iter().any(|p| p == pointer), "{pointer} is not in {found:?}");
    }
    assert_eq!(found.len(), 12, "{found:?}");
}

#[test]
fn a_single_value_takes_one_node() {
    let isotropic = r#"{"range": {"ratio": [1, 1], "phi": [0, 0]}}"#;
    assert_eq!(recipe(isotropic).expect("a recipe").entries(), 10 * 9);
    assert_eq!(pointers(r#"{"range": {"ratio": [1, 1]}, "resolution": {"ratio": 8}}"#), ["/resolution/ratio"]);
}

#[test]
fn nodes_replace_a_range_and_a_resolution() {
    let given = recipe(r#"{"nodes": {"alpha": [0.04, 0.09, 0.25], "ratio": [1]}, "range": {"phi": [0, 0]}}"#)
        .expect("a recipe");
    assert_eq!((given.entries(), given.range.alpha, given.resolution.ratio), (3 * 9, [0.04, 0.25], 1));
    assert_eq!(given.nodes().alpha, [0.04, 0.09, 0.25]);
    let text = canonical_json(&given);
    assert!(text.contains(r#""nodes":{"alpha":[0.04,0.09,0.25],"ratio":[1]}"#), "{text}");
    assert_eq!(recipe(&text), Ok(given));
    assert!(!canonical_json(&recipe("{}").expect("a recipe")).contains("nodes"));
    // A floor raises a node.
    assert_eq!(recipe(r#"{"nodes": {"alpha": [0, 0.5]}}"#).expect("a recipe").nodes().alpha, [1e-4, 0.5]);
}

#[test]
fn faults_of_given_nodes_are_reported_all_at_once() {
    let found =
        pointers(r#"{"nodes": {"alpha": [0.5, 0.25], "ratio": [], "theta": [0, 3], "phi": "0.1", "beta": [1]}}"#);
    assert_eq!(found, ["/nodes/beta", "/nodes/alpha", "/nodes/ratio", "/nodes/theta", "/nodes/phi"]);
    let others = r#"{"nodes": {"alpha": [0.1, 0.2]}, "range": {"alpha": [0, 1]}, "resolution": {"alpha": 3}}"#;
    assert_eq!(pointers(others), ["/range/alpha", "/resolution/alpha"]);
    assert_eq!(pointers(r#"{"nodes": {"alpha": [0.1, 0.1]}}"#), ["/nodes/alpha"]);
    assert_eq!(pointers(r#"{"nodes": {"alpha": [0, 0.00001]}}"#), ["/range/alpha"]);
    assert_eq!(pointers(r#"{"nodes": {"alpha": [0.1]}, "layout": "godot"}"#), ["/nodes/alpha"]);
    assert_eq!(pointers(r#"{"nodes": {"ratio": [0.5, 1]}, "brdf": "charlie"}"#), ["/range/ratio"]);
}

#[test]
fn nodes_that_floors_would_join_are_refused() {
    assert_eq!(pointers(r#"{"range": {"alpha": [0, 1e-5]}}"#), ["/range/alpha"]);
    assert_eq!(pointers(r#"{"range": {"theta": [1.5707, 1.57079]}}"#), ["/range/theta"]);
}

#[test]
fn the_entry_limit_counts_the_whole_table() {
    let large = r#"{"resolution": {"alpha": 1000, "ratio": 1000, "theta": 1000, "phi": 1000}}"#;
    assert_eq!(pointers(large), ["/resolution"]);
    assert!(parse(b"{}", 3780).is_ok());
    assert!(matches!(parse(b"{}", 3779), Err(RecipeError::Faults(_))));
}

#[test]
fn text_that_is_not_json_has_its_own_error() {
    for text in ["", "{", r#"{"fit": NaN}"#, r#"{"range": {"alpha": [0, 1e999]}}"#] {
        assert!(matches!(recipe(text), Err(RecipeError::Json(_))), "{text}");
    }
    assert_eq!(pointers("[]"), [""]);
}

#[test]
fn messages_name_the_unit_of_angles_and_the_form_of_a_recipe() {
    for (text, said) in [
        (r#"{"range": {"theta": [0, 85]}}"#, "[0,85] is not within [0, 1.5707963267948966] in radians"),
        (r#"{"range": {"alpha": [0, 85]}}"#, "[0,85] is not within [0, 1]"),
        ("[1]", "[1] is not an object; a recipe is one, such as {\"preset\": \"draft\"}"),
    ] {
        let Err(RecipeError::Faults(faults)) = recipe(text) else { panic!("{text} was accepted") };
        assert_eq!(faults[0].detail, said);
    }
}

#[test]
fn a_repeated_field_is_refused() {
    for text in [r#"{"preset": "draft", "preset": "paper"}"#, r#"{"fit": {"seed": 1, "steps": 2, "seed": 1}}"#] {
        match recipe(text) {
            Err(RecipeError::Json(detail)) => assert!(detail.contains("is repeated"), "{detail}"),
            other => panic!("{text} gave {other:?}"),
        }
    }
}

proptest! {
    #[test]
    fn any_bytes_give_an_answer(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        let _ = parse(&bytes, DEFAULT_ENTRY_LIMIT);
    }

    /// Documents with valid names and invalid values of every kind.
    #[test]
    fn any_values_give_an_answer(
        field in prop::sample::select(vec!["preset", "fitter", "resolution", "range", "fit", "terms", "layout"]),
        inner in prop::sample::select(vec!["alpha", "phi", "samples", "seed", "metric"]),
        value in prop::sample::select(vec!["null", "-1", "1e300", "0.5", "\"x\"", "[]", "[0,1,2]", "[1,null]", "{}"]),
    ) {
        let _ = recipe(&format!(r#"{{"{field}": {value}}}"#));
        let _ = recipe(&format!(r#"{{"{field}": {{"{inner}": {value}}}}}"#));
    }
}

/// Layouts with a fixed domain. A document may name this domain, and no other.
#[test]
fn a_layout_of_isotropic_tables_has_its_own_ranges() {
    let plain = recipe(r#"{"layout": "ltc2017"}"#).expect("a recipe");
    assert_eq!((plain.entries(), plain.range.ratio, plain.range.phi), (64 * 64, [1.0, 1.0], [0.0, 0.0]));
    let named = recipe(r#"{"layout": "ltc2017", "range": {"ratio": [1, 1], "alpha": [0, 1], "phi": [0, 0]}}"#);
    assert_eq!(named.map(|named| digest(&named)), Ok(digest(&plain)));
    for layout in ["ltc2017", "ltc2016", "godot", "hdrp", "inverse", "matrix33"] {
        let other = format!(
            r#"{{"layout": "{layout}", "range": {{"alpha": [0.1, 1], "ratio": [0, 1]}}, "resolution": {{"phi": 2}}}}"#
        );
        assert_eq!(pointers(&other), ["/range/alpha", "/range/ratio", "/resolution/phi"]);
    }
}

/// Isotropic surfaces have a ratio of one. Lobes that follow no reflection have a layout that stores them unchanged.
#[test]
fn a_scattering_model_has_its_own_defaults() {
    for brdf in BrdfKind::formulas() {
        let plain = recipe(&format!(r#"{{"brdf": "{brdf}"}}"#)).expect("a recipe");
        assert_eq!(plain.brdf, brdf);
        assert_eq!(plain.range.ratio == [1.0, 1.0] && plain.range.phi == [0.0, 0.0], brdf.is_isotropic(), "{brdf}");
        assert_eq!(plain.layout.name(), if brdf.follows_reflection() { "reflected" } else { "kt2022" }, "{brdf}");
        assert_eq!(recipe(&canonical_json(&plain)), Ok(plain), "{brdf}");
        let engine = recipe(&format!(r#"{{"brdf": "{brdf}", "layout": "ltc2017"}}"#)).expect("a recipe");
        assert_eq!(engine.entries(), 64 * 64);
    }
    assert_eq!(recipe(r#"{"brdf": "charlie", "range": {"ratio": [1, 1]}}"#), recipe(r#"{"brdf": "charlie"}"#));
}

#[test]
fn combinations_that_cannot_work_name_the_fields_to_change_all_at_once() {
    let both = r#"{"brdf": "charlie", "layout": "reflected", "range": {"ratio": [0.2, 1]}, "terms": 1}"#;
    let Err(RecipeError::Faults(faults)) = recipe(both) else { panic!("it cannot work") };
    let reported: Vec<(&str, &str)> = faults.iter().map(|fault| (&*fault.pointer, &*fault.detail)).collect();
    assert_eq!(reported.iter().map(|(pointer, _)| *pointer).collect::<Vec<_>>(), ["/layout", "/terms", "/range/ratio"]);
    assert!(reported[0].1.contains(r#""charlie""#) && reported[0].1.contains(r#""kt2022""#), "{reported:?}");
    assert!(reported[2].1.contains("[1, 1]"), "{reported:?}");
    assert_eq!(pointers(r#"{"brdf": "oren_nayar", "layout": "hdrp", "range": {"ratio": [0, 1]}}"#), ["/range/ratio"]);
    assert!(recipe(r#"{"brdf": "beckmann", "range": {"ratio": [0.2, 1]}}"#).is_ok());
}

/// Only recipes with a simplex solver contain its choices, so other recipes keep their digests.
#[test]
fn a_simplex_has_its_choices_and_other_solvers_none() {
    let fit = |fit: &str| recipe(&format!(r#"{{"layout": "ltc2017", "fit": {{{fit}}}}}"#));
    let simplex = fit(r#""metric": "l3", "solver": "nelder_mead""#).expect("a recipe");
    assert!(canonical_json(&simplex).contains(r#""shear":"x","solver":"nelder_mead","start":"warm","steps""#));
    assert_eq!(recipe(&canonical_json(&simplex)), Ok(simplex.clone()));
    for other in [r#""shear": "z""#, r#""start": "independent""#] {
        let other = fit(&format!(r#""metric": "l3", "solver": "nelder_mead", {other}"#)).expect("a recipe");
        assert_ne!(digest(&other), digest(&simplex));
        assert_eq!(recipe(&canonical_json(&other)), Ok(other));
    }
    let plain = canonical_json(&recipe("{}").expect("a recipe"));
    assert!(!plain.contains("shear") && !plain.contains("start"), "{plain}");
    assert_eq!(pointers(r#"{"fit": {"shear": "x", "start": "warm"}}"#), ["/fit/shear", "/fit/start"]);
    assert_eq!(
        pointers(r#"{"layout": "godot", "fit": {"solver": "nelder_mead", "shear": "y", "start": 1}}"#),
        ["/fit/shear", "/fit/start"]
    );
}

/// For isotropic surfaces, every combination of metric and solver is a valid recipe.
#[test]
fn metrics_and_solvers_combine_freely() {
    for (metric, solver) in Metric::ALL.iter().flat_map(|m| Solver::ALL.iter().map(move |s| (*m, *s))) {
        let read = recipe(&format!(r#"{{"layout": "hdrp", "fit": {{"metric": "{metric}", "solver": "{solver}"}}}}"#));
        let fit = read.expect("a recipe").fit;
        assert_eq!((fit.metric, fit.solver), (metric, solver));
    }
    let Err(RecipeError::Faults(faults)) = recipe(r#"{"fit": {"solver": "nelder_mead", "metric": "l3"}}"#) else {
        panic!("its default ranges are anisotropic")
    };
    assert_eq!(faults.len(), 1, "{faults:?}");
    assert_eq!(faults[0].pointer, "/range/ratio");
    assert!(
        faults[0].detail.contains("[1, 1]") && faults[0].detail.ends_with(r#"/fit/solver to "bfgs", "sgd""#),
        "{faults:?}"
    );
    let isotropic = r#"{"fit": {"solver": "nelder_mead"}, "range": {"ratio": [1, 1]}}"#;
    assert_eq!(recipe(isotropic).expect("a recipe").fit.metric, Metric::Sw1);
}

#[test]
fn requirements_of_gaussians_are_reported_all_at_once() {
    assert_eq!(recipe(r#"{"lobe": "asg"}"#).expect("a recipe").lobe, LobeModel::Asg);
    assert_eq!(recipe(r#"{"lobe": "sg", "brdf": "charlie"}"#).expect("a recipe").layout, Layout::Kt2022);
    let wrong = r#"{"lobe": "sg", "layout": "ltc2017", "terms": false, "fit": {"solver": "sgd"}}"#;
    let mut found = pointers(wrong);
    found.sort();
    assert_eq!(found, ["/fit/solver", "/layout", "/terms"]);
    assert_eq!(pointers(r#"{"lobe": "asg", "fit": {"metric": "l3"}}"#), ["/fit/metric"]);
}

#[test]
fn terms_of_f82_are_stored_and_refused_where_nothing_reflects() {
    let metal = recipe(r#"{"terms": "f82"}"#).expect("a recipe");
    assert_eq!((metal.terms, metal.terms.count()), (StoredTerms::F82, 3));
    let text = canonical_json(&metal);
    assert!(text.contains(r#""terms":"f82""#), "{text}");
    assert_eq!(recipe(&text), Ok(metal));
    let plain = canonical_json(&recipe("{}").expect("a recipe"));
    assert!(plain.contains(r#""terms":true"#), "{plain}");
    assert_eq!(pointers(r#"{"terms": "f90"}"#), ["/terms"]);
    assert_eq!(pointers(r#"{"terms": "f82", "brdf": "fuzz", "lobe": "sg"}"#), ["/terms", "/terms"]);
}

#[test]
fn a_byte_order_mark_is_not_part_of_a_document() {
    let marked = parse("\u{feff}{\"layout\": \"ltc2017\"}".as_bytes(), u64::MAX).expect("a recipe");
    assert_eq!(digest(&marked), digest(&parse(br#"{"layout": "ltc2017"}"#, u64::MAX).expect("a recipe")));
    assert!(parse("\u{feff}\u{feff}{}".as_bytes(), u64::MAX).is_err());
    let utf_16 = parse(b"\xff\xfe{\0}\0", u64::MAX).expect_err("UTF-16").to_string();
    assert!(utf_16.contains("UTF-8"), "{utf_16}");
}
