use std::{f64::consts::FRAC_PI_2, ops::ControlFlow};

use proptest::prelude::*;

use super::*;
use crate::brdf::{BrdfKind, Fuzz, Ggx};
use crate::{
    ALPHA_FLOOR, Configuration, FITTER_VERSION, GivenNodes, Layout, Metric, PerAxis, Plan, Precision, RATIO_FLOOR,
    Recipe, StoredTerms, THETA_CEILING, assemble, fit_shard,
    lobe::ltc::Ltc,
    math::{direction, from_row_major},
};

fn fit(settings: FitSettings, ggx: &Ggx, wo: DVec3, stream: u64) -> FittedEntry {
    let fitted = Fitter::new(&settings).fit(ggx, wo, stream, &mut StopCheck::new(&mut unstopped));
    fitted.expect("nothing stops it")
}

fn settings(solver: Solver, samples: u32, directions: u32, steps: u32) -> FitSettings {
    FitSettings { metric: Metric::Sw1, solver, samples, directions, steps, seed: 0, simplex: None }
}

/// Draws one of `values`, where fits are hardest, moved by a few ulps, or any value from `low` to `high`.
fn hard(values: &'static [f64], low: f64, high: f64) -> impl Strategy<Value = f64> {
    let near = (prop::sample::select(values), -3_i64..=3)
        .prop_map(move |(x, ulps)| f64::from_bits(x.to_bits().saturating_add_signed(ulps)).clamp(low, high));
    prop_oneof![near, low..high]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn every_lobe_gets_a_finite_upright_matrix(
        alpha in hard(&[ALPHA_FLOOR, 1e-3, 1.0], ALPHA_FLOOR, 1.0),
        ratio in hard(&[RATIO_FLOOR, 1e-3, 1.0], RATIO_FLOOR, 1.0),
        theta in hard(&[0.0, 1e-9, 1.57, THETA_CEILING], 0.0, THETA_CEILING),
        phi in hard(&[0.0, 1e-12, FRAC_PI_2], 0.0, FRAC_PI_2),
    ) {
        let ggx = Ggx { alpha_x: alpha, alpha_y: alpha * ratio };
        let wo = direction(theta, phi);
        let entry = fit(settings(Solver::Bfgs, 64, 6, 20), &ggx, wo, 0);
        prop_assert!(entry.matrix.iter().all(|x| x.is_finite()), "{entry:?}");
        prop_assert!(from_row_major(&entry.matrix).determinant() > 0.0, "{entry:?}");
        prop_assert!(entry.error.is_finite() && entry.error < 0.2, "{entry:?}");
        prop_assert!((0.0..=1.0).contains(&entry.fresnel) && (0.0..=1.0 + 1e-9).contains(&entry.amplitude), "{entry:?}");
    }
}

/// Tests the sharpest and the broadest isotropic lobes, from above and at the horizon.
#[test]
fn every_metric_and_solver_fits_the_hardest_isotropic_lobes() {
    let pairs = Solver::ALL.iter().flat_map(|solver| Metric::ALL.iter().map(move |metric| (*solver, *metric)));
    for (solver, metric) in pairs.filter(|(solver, _)| *solver != Solver::Sgd) {
        for (alpha, theta) in [1e-4, 1e-2, 1.0].into_iter().flat_map(|a| [0.0, 1.5, THETA_CEILING].map(|t| (a, t))) {
            let ggx = Ggx { alpha_x: alpha, alpha_y: alpha };
            let settings = FitSettings { metric, ..settings(solver, 64, 6, 40) };
            let entry = fit(settings, &ggx, direction(theta, 0.0), 0);
            assert!(entry.matrix.iter().all(|x| x.is_finite()), "{solver} {metric} {alpha} {theta}: {entry:?}");
            assert!(from_row_major(&entry.matrix).determinant() > 0.0, "{solver} {metric} {alpha} {theta}: {entry:?}");
            assert!(entry.error < 0.2, "{solver} {metric} {alpha} {theta}: {entry:?}");
        }
    }
}

/// A sharp lobe seen from above is an LTC: `M = diag(2 alpha_x, 2 alpha_y, 1)`.
#[test]
fn a_sharp_lobe_from_above_has_the_limit_s_matrix() {
    let ggx = Ggx { alpha_x: 1e-3, alpha_y: 4e-4 };
    let entry = fit(settings(Solver::Bfgs, 512, 16, 60), &ggx, DVec3::Z, 0);
    let [xx, _, _, _, yy, _, _, _, zz] = entry.matrix;
    assert!((xx / zz / 2e-3 - 1.0).abs() < 0.01 && (yy / zz / 8e-4 - 1.0).abs() < 0.01, "{entry:?}");
    assert!((entry.amplitude - 1.0).abs() < 1e-4 && entry.fresnel < 1e-9, "{entry:?}");
}

#[test]
fn more_samples_fit_better() {
    let ggx = Ggx { alpha_x: 0.4, alpha_y: 0.1 };
    let wo = direction(1.0, 0.6);
    let [coarse, fine] = [32, 1024].map(|n| fit(settings(Solver::Bfgs, n, 16, 60), &ggx, wo, 0).matrix);
    let mut judge = Fitter::new(&settings(Solver::Bfgs, 2048, 48, 1));
    let [coarse, fine] = [coarse, fine].map(|m| judge.error(&ggx, wo, &from_row_major(&m)));
    assert!(fine < coarse, "{fine} {coarse}");
}

/// Algorithm 3 of the paper converges to the same fit, but more slowly. After a few hundred steps, the fit of a broad
/// lobe is near the best fit.
#[test]
fn the_paper_s_descent_comes_near_the_same_error() {
    let ggx = Ggx { alpha_x: 0.8, alpha_y: 0.5 };
    let wo = direction(0.7, 0.4);
    let ours = fit(settings(Solver::Bfgs, 1024, 32, 60), &ggx, wo, 0).matrix;
    let descended = |seed| {
        let settings = FitSettings { seed, ..settings(Solver::Sgd, 256, 8, 600) };
        fit(settings, &ggx, wo, 7).matrix
    };
    let mut judge = Fitter::new(&settings(Solver::Bfgs, 1024, 32, 1));
    let [ours, theirs, identity] = [ours, descended(0), [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]]
        .map(|m| judge.error(&ggx, wo, &from_row_major(&m)));
    assert!(ours <= theirs && theirs < 3.0 * ours && theirs < 0.2 * identity, "{ours} {theirs} {identity}");
    assert_eq!(descended(0), descended(0));
    assert_ne!(descended(0), descended(1));
}

/// With the L3 norm, the descent from the identity finds broad lobes. For sharp lobes the gradient at the identity
/// vanishes.
#[test]
fn the_descent_by_l3_finds_broad_lobes_and_stays_finite_at_sharp_ones() {
    let descended = |alpha: f64| {
        let settings = FitSettings { metric: Metric::L3, ..settings(Solver::Sgd, 256, 8, 1000) };
        let ggx = Ggx { alpha_x: alpha, alpha_y: alpha };
        let wo = direction(0.5, 0.4);
        let found = fit(settings, &ggx, wo, 7).matrix;
        let mut judge = Fitter::new(&FitSettings { metric: Metric::L3, ..self::settings(Solver::Bfgs, 1024, 32, 60) });
        let target = judge.training.target(&ggx, wo);
        let lobe = Lobe { brdf: &ggx, wo, target: &target };
        let mut go_on = unstopped;
        let mut stop_check = StopCheck::new(&mut go_on);
        let mut loss = judge.training.distance.to(&lobe, &mut stop_check).expect("nothing stops it");
        let mut of = |m: DMat3| loss.value(&(target.frame.transpose() * m), &mut stop_check).expect("nothing stops it");
        [of(from_row_major(&found)), of(DMat3::IDENTITY)]
    };
    let [found, identity] = descended(0.7);
    assert!(found < 0.35 * identity, "{found} {identity}");
    for alpha in [1e-4, 0.03] {
        let [found, identity] = descended(alpha);
        assert!(found.is_finite() && found < 1.1 * identity, "{alpha}: {found} {identity}");
    }
}

/// With the largest settings of a recipe, an entry takes minutes. Each call of `go_on` can stop the fit. It is called
/// after every 2^23 projections of a sample on a direction: while the lobe is tabulated, within an evaluation and
/// within a step.
#[test]
fn an_entry_of_any_size_is_stopped_within_a_moment() {
    let ggx = Ggx { alpha_x: 0.4, alpha_y: 0.1 };
    let (samples, directions) = (16_384, 256);
    // The smallest number of calls: for the tabulation of both sample sets, and for one evaluation or the sorts in the
    // one step of `sgd`.
    let least = |solver: Solver, metric: Metric| {
        let sorts = match (solver, metric) {
            (Solver::Sgd, Metric::Sw1) => 16,
            (Solver::Sgd, Metric::L3) => 0,
            _ => 1,
        };
        let tabulations = if metric == Metric::Sw1 { 2 } else { 1 };
        ((tabulations * TARGET_SAMPLES_PER_SAMPLE + sorts) * samples as usize * directions as usize) >> 23
    };
    let pairs = Solver::ALL.iter().flat_map(|solver| Metric::ALL.iter().map(move |metric| (*solver, *metric)));
    for (solver, metric) in pairs {
        let settings = FitSettings { metric, ..settings(solver, samples, directions, 1) };
        let stopped_at = |stop: usize| {
            let mut calls = 0;
            let mut go_on = || {
                calls += 1;
                if calls == stop { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            };
            let entry = Fitter::new(&settings).fit(&ggx, direction(1.0, 0.6), 0, &mut StopCheck::new(&mut go_on));
            (calls, entry)
        };
        let (calls, entry) = stopped_at(usize::MAX);
        assert!(entry.is_some() && calls >= least(solver, metric), "{solver} {metric}: {calls} calls");
        for stop in [1, calls / 2, calls].into_iter().filter(|stop| *stop > 0) {
            assert_eq!(stopped_at(stop), (stop, None), "{solver} {metric}");
        }
    }
}

/// If the model is an LTC, the entry has the matrix and terms of the model, for every solver and setting.
#[test]
fn a_model_that_is_an_ltc_is_not_fitted() {
    let searches = Solver::ALL.iter().map(|solver| settings(*solver, 64, 6, 1));
    for (alpha, theta) in [(0.01, 1.3), (0.3, 0.9), (1.0, 0.2)] {
        let (fuzz, wo) = (BrdfKind::Fuzz.surface([alpha; 2]), direction(theta, 0.4));
        for settings in searches.clone() {
            let entry =
                Fitter::new(&settings).fit(&*fuzz, wo, 0, &mut StopCheck::new(&mut unstopped)).expect("unstopped");
            assert_eq!(Some(from_row_major(&entry.matrix)), fuzz.ltc(wo), "{settings:?}");
            let albedo = Fuzz::new(alpha.sqrt()).albedo(wo.z);
            assert!((entry.amplitude / albedo - 1.0).abs() < 1e-12 && entry.error < 0.05, "{entry:?} {albedo}");
        }
        let mut gaussian = Fitter::new(&settings(Solver::Bfgs, 64, 6, 20)).of(LobeModel::Sg);
        let entry = gaussian.fit(&*fuzz, wo, 0, &mut StopCheck::new(&mut unstopped)).expect("unstopped");
        assert_ne!(Some(from_row_major(&entry.matrix)), fuzz.ltc(wo), "a Gaussian is searched");
    }
}

/// Layouts that choose entries for the error between nodes store the model's own lobes too.
#[test]
fn tables_of_an_ltc_have_its_matrices_at_their_nodes() {
    for layout in [Layout::Kt2022, Layout::Ltc2017] {
        let (nodes, quarter) = (PerAxis { alpha: 5, ratio: 1, theta: 6, phi: 1 }, [0.0, FRAC_PI_2]);
        let plan = Plan::new(&Recipe {
            fitter: FITTER_VERSION,
            brdf: BrdfKind::Fuzz.into(),
            lobe: LobeModel::Ltc,
            layout,
            resolution: nodes,
            range: PerAxis { alpha: [0.0, 1.0], ratio: [1.0; 2], theta: quarter, phi: [0.0; 2] },
            fit: settings(Solver::Bfgs, 64, 6, 1),
            terms: StoredTerms::Schlick,
            precision: Precision::F32,
            given: GivenNodes::default(),
        });
        let fit = |shard| fit_shard(&plan, shard, &mut |_| ControlFlow::Continue(())).expect("nothing stops it");
        let table = assemble(&plan, &(0..plan.shards()).flat_map(fit).collect::<Vec<_>>());
        let places = (0..plan.entries()).map(|index| (plan.nodes().node(index as usize), plan.place(index)));
        let kept: Vec<_> = places.filter(|(node, place)| node == place).collect();
        assert!(kept.len() >= 20, "{layout}: {}", kept.len());
        for (_, place) in kept {
            let [alpha_x, alpha_y] = place.roughness();
            let at = Configuration { alpha_x, alpha_y, theta: place.theta, phi: place.phi };
            let found = Ltc::new(from_row_major(&table.lookup(&at).matrix)).expect("a lobe");
            let fuzz = BrdfKind::Fuzz.surface_at(&place);
            for u in Lattice::new(16, [0.3, 0.1]).points() {
                let wi = fuzz.sample(place.view(), u).wi;
                let apart = found.pdf(wi) / fuzz.pdf(place.view(), wi) - 1.0;
                assert!(apart.abs() < 2e-3, "{layout} {place:?}: {apart}");
            }
        }
    }
}
