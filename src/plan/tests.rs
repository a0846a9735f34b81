//! Plans held to what their tables are measured to be.

use std::ops::ControlFlow;

use super::*;
use ltcforge_fit::{Plan, Recipe, Table, fit_plan};

fn fitted(recipe: &Recipe) -> Table {
    fit_plan(&Plan::new(recipe), &|_| ControlFlow::Continue(())).expect("nothing stops it")
}

/// Lists of materials of some kinds.
fn scenes() -> Vec<(&'static str, Scene)> {
    let lists = [
        (
            "isotropic",
            r#"{"materials": [{"alpha_x": 0.04, "alpha_y": 0.04}, {"alpha_x": 0.25, "alpha_y": 0.25, "weight": 3}, {"alpha_x": 0.6, "alpha_y": 0.6}]}"#,
        ),
        (
            "anisotropic",
            r#"{"materials": [{"alpha_x": 0.09, "alpha_y": 0.3}, {"alpha_x": 0.25, "alpha_y": 0.25, "weight": 3, "f0": 0.04}, {"alpha_x": 0.36, "alpha_y": 0.1}]}"#,
        ),
        (
            "many",
            r#"{"materials": [{"alpha_x": 0.01, "alpha_y": 0.3}, {"alpha_x": 0.25, "alpha_y": 0.25}, {"alpha_x": 0.36, "alpha_y": 0.1}, {"alpha_x": 0.9, "alpha_y": 0.8}, {"alpha_x": 0.5, "alpha_y": 0.02}, {"alpha_x": 0.05, "alpha_y": 0.05}, {"alpha_x": 0.7, "alpha_y": 0.3}]}"#,
        ),
    ];
    lists.map(|(name, list)| (name, Scene::from_list(list.as_bytes()).expect("a scene"))).into()
}

#[test]
fn plans_are_as_good_as_predicted() {
    for (name, scene) in scenes() {
        for budget in [Budget::Bytes(20_790), Budget::Knee, Budget::Bytes(6_000), Budget::Seconds(0.5)] {
            let needs = Needs::of(&scene, false).expect("lobes");
            let started = std::time::Instant::now();
            let mut plan = TablePlan::new(needs, budget, None, &|| true).expect("nothing stops it");
            let planned = started.elapsed();
            let table = fitted(&plan.chosen.recipe);
            let whole = fitted(&plan.whole.recipe);
            let chosen = plan.chosen.clone();
            plan.measure(&table, Some(&whole));
            let measured = plan.measured.map(|m| m.error).unwrap_or_default();
            println!(
                "{name} {budget:?} {:?} {} bytes {:.4} predicted {measured:.4} measured; whole {:.4}; limit {:.4} {planned:?}",
                chosen.recipe.resolution,
                chosen.bytes,
                chosen.error,
                plan.whole.error.unwrap_or_default(),
                plan.limit
            );
        }
    }
}
