use std::{
    f64::consts::FRAC_PI_2,
    ops::ControlFlow,
    sync::atomic::{AtomicUsize, Ordering},
};

use super::*;
use crate::{
    BrdfKind, BrdfModel, Configuration, FITTER_VERSION, FitSettings, Fitter, Layout, LobeFresnel, LobeModel, Metric,
    Plan, Precision, Recipe, SecondLobe, Solver, StoredTerms, WeightedF0, assemble, brdf::Ggx, fit_shard,
};

fn recipe([alpha, ratio, theta, phi]: [u32; 4], samples: u32, directions: u32, solver: Solver) -> Recipe {
    let quarter = [0.0, FRAC_PI_2];
    Recipe {
        fitter: FITTER_VERSION,
        given: crate::GivenNodes::default(),
        brdf: BrdfKind::Ggx.into(),
        lobe: LobeModel::Ltc,
        layout: Layout::Kt2022,
        resolution: PerAxis { alpha, ratio, theta, phi },
        range: PerAxis { alpha: [0.0, 1.0], ratio: [0.0, 1.0], theta: quarter, phi: quarter },
        fit: FitSettings { metric: Metric::Sw1, solver, samples, directions, steps: 60, seed: 0, simplex: None },
        terms: StoredTerms::Schlick,
        precision: Precision::F32,
    }
}

/// A table of rough and smooth surfaces, and its recipe.
fn small() -> (Recipe, Table) {
    of_brdf(BrdfKind::Ggx.into())
}

fn of_brdf(brdf: BrdfModel) -> (Recipe, Table) {
    let recipe = Recipe {
        brdf,
        range: PerAxis { alpha: [0.2, 1.0], ratio: [0.3, 1.0], theta: [0.0, 1.4], phi: [0.0, FRAC_PI_2] },
        ..recipe([2, 2, 3, 2], 256, 16, Solver::Bfgs)
    };
    let plan = Plan::new(&recipe);
    let entries = (0..plan.shards())
        .flat_map(|shard| fit_shard(&plan, shard, &mut |_| ControlFlow::Continue(())).expect("nothing stops it"));
    let table = assemble(&plan, &entries.collect::<Vec<_>>());
    (recipe, table)
}

fn report_of(recipe: &Recipe, table: &Table) -> Report {
    report(table, &recipe.range, 32)
}

#[test]
fn a_good_table_is_good_at_its_nodes_and_worse_between() {
    let (recipe, table) = small();
    let Report { nodes, between, matrices, floors, .. } = report_of(&recipe, &table);
    assert_eq!((nodes.points, between.points, matrices.entries), (24, 32, 24));
    assert!(nodes.sw1.mean < 0.03 && nodes.width.max < 0.2, "{nodes:?}");
    assert!(between.width.mean > 2.0 * nodes.width.mean, "{between:?}");
    let (amplitude, fresnel) = (nodes.amplitude.expect("terms"), nodes.fresnel.expect("terms"));
    assert!(amplitude.max < 0.01 && fresnel.max < 0.01, "{nodes:?}");
    assert!(between.amplitude.expect("terms").max > amplitude.max);
    assert_eq!((matrices.negative_determinants, matrices.singular), (0, 0));
    assert!(matrices.determinant.min > 0.0 && matrices.condition.min >= 3.0 - 1e-9, "{matrices:?}");
    assert_eq!([floors.alpha, floors.ratio, floors.alpha_y, floors.theta].map(|moved| moved.entries), [0; 4]);
    assert_eq!(nodes.worst.len(), 5);
}

/// Report and fit measure distances with different code and different samples. They agree on a fitted table.
#[test]
fn the_error_at_nodes_is_that_of_a_finer_fitter() {
    let (recipe, table) = small();
    let mut finer = Fitter::new(&FitSettings { samples: 2048, directions: 48, ..recipe.fit });
    let places = places::nodes(table.layout, &table.axes, 24);
    let errors = places.iter().map(|at| {
        let m = crate::math::from_row_major(&table.lookup(at).matrix);
        let wo = crate::math::direction(at.theta, at.phi);
        finer.error(&Ggx { alpha_x: at.alpha_x, alpha_y: at.alpha_y }, wo, &m)
    });
    let mean = errors.sum::<f64>() / places.len() as f64;
    let found = report_of(&recipe, &table).nodes.sw1.mean;
    assert!((found / mean - 1.0).abs() < 0.04, "{found} {mean}");
}

#[test]
fn a_spoiled_entry_is_named_as_the_worst() {
    let (recipe, mut table) = small();
    // The entry at alpha 0.2, ratio 0.3, theta 0.7, phi pi/2.
    let spoiled = 3;
    let at = places::node(table.layout, &table.axes, spoiled);
    assert_eq!(at, Configuration { alpha_x: 0.2, alpha_y: 0.06, theta: 0.7, phi: FRAC_PI_2 });
    for (matrix, farthest) in [([1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0], false), ([0.0; 9], true)] {
        table.matrix[spoiled] = matrix;
        let found = report_of(&recipe, &table);
        let worst = found.nodes.worst[0];
        assert_eq!((worst.alpha_x, worst.alpha_y, worst.theta, worst.phi), (0.2, 0.06, 0.7, FRAC_PI_2));
        assert!(worst.width > 1.0 && worst.sw1 > 0.3, "{worst:?}");
        // A matrix without a distribution has the farthest distance, which is a number that JSON can represent.
        assert_eq!((worst.sw1 == 2.0, found.matrices.singular), (farthest, usize::from(farthest)));
        assert!(worst.width.is_finite() && found.nodes.light.max > 0.1);
    }
}

#[test]
fn a_table_without_terms_has_no_error_of_terms() {
    let (recipe, table) = small();
    let found = report_of(&recipe, &Table { terms: None, ..table });
    assert_eq!((found.nodes.amplitude, found.between.fresnel), (None, None));
}

/// An integrated second lobe is measured like a table of this lobe alone. A blend is compared with the lobe of plastic,
/// and is closer to it than the first lobe alone.
#[test]
fn second_lobes_are_measured_as_they_are_used() {
    let of = |second| of_brdf(BrdfModel::from(BrdfKind::Ggx).with_fresnel(LobeFresnel::Two(second)));
    let (recipe, table) = of(SecondLobe::Integrated);
    let second = report_of(&recipe, &table).second.expect("two lobes");
    let alone = report_of(&recipe, &table.of_second().expect("a second lobe")).between;
    assert_eq!((second.f0, second.between.width, second.between.light), (1e-3, alone.width, alone.light));

    let (recipe, table) = of(SecondLobe::Blended);
    let blend = report_of(&recipe, &table).second.expect("two lobes");
    let (_, mut first) = small();
    first.brdf = first.brdf.with_fresnel(LobeFresnel::mix(vec![WeightedF0 { f0: 0.04, weight: 1.0 }]).expect("a mix"));
    let first = report_of(&recipe, &first).between.light.mean;
    assert!(blend.f0 == 0.04 && blend.between.light.mean < 0.8 * first, "{blend:?} {first}");
    assert_eq!(report_of(&recipe, &small().1).second, None);
}

#[test]
fn points_grow_with_the_fit_between_their_bounds() {
    let points =
        |resolution, samples, directions| report_points(&recipe(resolution, samples, directions, Solver::Bfgs)).nodes;
    assert_eq!(points([2; 4], 64, 4), 8);
    assert_eq!(points([64, 64, 64, 7], 2048, 48), MOST_POINTS);
    let (draft, paper) = (points([8; 4], 128, 8), points([8; 4], 512, 24));
    assert!(8 < draft && draft < paper && paper < MOST_POINTS, "{draft} {paper}");
    // Solver sgd always takes all steps.
    let sgd = report_points(&Recipe {
        fit: FitSettings { steps: 10_000, ..recipe([8; 4], 128, 8, Solver::Sgd).fit },
        ..recipe([8; 4], 128, 8, Solver::Sgd)
    });
    assert_eq!(sgd, ReportPoints::from(MOST_POINTS));
    // All phi of an isotropic surface share one fit.
    let isotropic = Recipe {
        range: PerAxis { ratio: [1.0, 1.0], ..recipe([8; 4], 512, 24, Solver::Bfgs).range },
        ..recipe([64, 1, 64, 8], 512, 24, Solver::Bfgs)
    };
    let shared = report_points(&isotropic).nodes;
    assert!(shared.abs_diff(points([64, 2, 32, 1], 512, 24)) <= shared / 20, "{shared}");
}

/// A fit of milliseconds must not wait for its report. In longer fits, a few bad configurations must not dominate the
/// mean.
#[test]
fn between_nodes_there_are_more_places_the_longer_the_fit_takes() {
    let points = |side: u32, samples, directions| {
        let layout = Layout::Ltc2017;
        let range = layout.only_ranges().expect("one domain");
        report_points(&Recipe { layout, range, ..recipe([side, 1, side, 1], samples, directions, Solver::Bfgs) })
    };
    let (best, quick, tiny) = (points(64, 1024, 48), points(64, 256, 16), points(2, 64, 4));
    assert!(best.between == 512 && best.nodes < 512, "{best:?}");
    assert!((2 * quick.nodes..=3 * quick.nodes).contains(&quick.between) && quick.between < 512, "{quick:?}");
    assert_eq!(tiny, ReportPoints::from(8));
    assert_eq!(points(64, 65_536, 1024), ReportPoints::from(MOST_POINTS));
    let (recipe, table) = small();
    let found = report(&table, &recipe.range, ReportPoints { nodes: 5, between: 70 });
    assert_eq!((found.nodes.points, found.between.points), (5, 70));
    assert_eq!(found.between.width, width_between(&table, 70));
}

#[test]
fn a_report_stops_as_soon_as_it_may_not_go_on() {
    let (recipe, table) = small();
    let asked = AtomicUsize::new(0);
    let go_on = |most: usize| {
        asked.store(0, Ordering::Relaxed);
        report_while(&|| asked.fetch_add(1, Ordering::Relaxed) < most, &table, &recipe.range, 40)
    };
    assert_eq!(go_on(usize::MAX), Some(report(&table, &recipe.range, 40)));
    let places = asked.load(Ordering::Relaxed);
    assert!(places > 40, "go_on was called {places} times");
    assert_eq!(go_on(3), None);
    // No new configuration starts after `go_on` returns false. Other threads may have called it at the same time.
    assert!(asked.load(Ordering::Relaxed) < places, "it went on to the end");
}
