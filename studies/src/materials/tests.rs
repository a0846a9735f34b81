use super::{
    list::{Base, MATERIALS},
    *,
};
use ltcforge::fit::Recipe;

/// Side of a panel in pixels, large enough for each material to show its highlight.
const SIDE: u32 = 24;

fn fitted(document: &str) -> (Recipe, Table) {
    let recipe = recipe_document::parse(document.as_bytes(), 1 << 16).expect("a recipe");
    let table = fit_plan(&Plan::new(&recipe), &|_| ControlFlow::Continue(())).expect("a table");
    (recipe, table)
}

fn drawn((recipe, table): &(Recipe, Table), choices: &MaterialChoices) -> Result<MaterialSpheres, LightError> {
    material_spheres(NamedTable { table, digest: "0123456789abcdef", range: &recipe.range }, choices)
}

/// The largest mean error of each material relative to its mean radiance, by a small table and by model `normals`.
const WITHIN: [(&str, [f64; 2]); 9] = [
    ("brushed steel", [0.12, 0.008]),
    ("gold, F82", [0.06, 0.004]),
    ("rough chrome", [0.05, 0.02]),
    ("plastic", [0.01, 0.004]),
    ("rough plastic", [0.01, 0.006]),
    ("car paint", [0.05, 0.01]),
    ("coated brass", [0.08, 0.006]),
    ("velvet", [1e-6, 1e-6]),
    ("frosted glass", [0.0, 0.004]),
];

/// Every material is lit, and each model is as near to the truth as the docs state. There is no table for glass.
#[test]
fn models_are_near_to_the_truth_of_nine_materials() {
    let small = r#"{"preset": "draft", "resolution": {"alpha": 6, "ratio": 4, "theta": 6, "phi": 4}, "fresnel": "two_lobes", "terms": "f82"}"#;
    let table = fitted(small);
    let choices = MaterialChoices { size: SIDE, ..MaterialChoices::default() };
    let found = drawn(&table, &choices).expect("a picture");
    assert!(found == drawn(&table, &choices).expect("a picture"), "the second picture differs");
    assert_eq!(found.errors.len(), 8 + 9);
    assert!(found.outside.is_empty(), "{:?}", found.outside);
    for MaterialError { material, model, mean_absolute_error, mean_radiance } in &found.errors {
        let (_, within) = WITHIN.iter().find(|(name, _)| name == material).expect("a limit");
        let most = within[usize::from(*model == LightModel::Normals)] * mean_radiance;
        assert!(*mean_radiance > 0.02 && *mean_absolute_error <= most, "{material} {model}: {mean_absolute_error}");
    }
    let of = |model: LightModel, name: &str| {
        let of_it = |error: &&MaterialError| error.model == model && error.material == name;
        found.errors.iter().find(of_it).map(|error| error.mean_absolute_error)
    };
    assert_eq!(of(LightModel::Ltc, "frosted glass"), None);
    assert!(of(LightModel::Ltc, "brushed steel") > of(LightModel::Normals, "brushed steel"));
    assert_eq!(MATERIALS.iter().filter(|material| matches!(material.base, Base::Glass { .. })).count(), 1);
}

#[test]
fn tables_of_other_models_are_rejected_and_materials_outside_a_table_are_listed() {
    let choices = MaterialChoices { size: SIDE, ..MaterialChoices::default() };
    let sheen = fitted(r#"{"brdf": "fuzz", "resolution": {"alpha": 4, "theta": 4}}"#);
    let refused = drawn(&sheen, &choices).expect_err("a table of fuzz");
    assert!(refused.to_string().contains("the table is of brdf fuzz"), "{refused}");
    let round = fitted(
        r#"{"preset": "draft", "resolution": {"alpha": 4, "ratio": 2, "theta": 4, "phi": 2}, "range": {"ratio": [0.4, 1]}}"#,
    );
    let found = drawn(&round, &choices).expect("a picture");
    assert_eq!(found.outside, ["brushed steel", "coated brass"]);
    // Gold does not need the table's edge term.
    let gold = found.errors.iter().find(|error| error.material == "gold, F82").expect("gold");
    assert!(gold.mean_absolute_error < 0.06 * gold.mean_radiance, "{gold:?}");
    let bare =
        fitted(r#"{"preset": "draft", "resolution": {"alpha": 3, "ratio": 2, "theta": 3, "phi": 2}, "terms": false}"#);
    assert_eq!(drawn(&bare, &choices).expect_err("no terms"), LightError::NoTerms);
}
