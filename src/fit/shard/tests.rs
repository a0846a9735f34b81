use std::ops::ControlFlow;

use super::*;
use crate::{
    BrdfKind, FITTER_VERSION, FitSettings, Layout, LobeFresnel, LobeModel, Metric, Precision, SecondLobe, Simplex,
    Solver, StoredTerms, Table, assemble,
};

/// The plan of the whole domain at a resolution, with a coarse fit.
fn plan(resolution: [u32; 4]) -> Plan {
    plan_of(Layout::Kt2022, resolution)
}

fn plan_of(layout: Layout, [alpha, ratio, theta, phi]: [u32; 4]) -> Plan {
    let quarter = [0.0, std::f64::consts::FRAC_PI_2];
    let whole = PerAxis { alpha: [0.0, 1.0], ratio: [0.0, 1.0], theta: quarter, phi: quarter };
    let range = layout.only_ranges().unwrap_or(whole);
    let nodes = |n: u32, [low, high]: [f64; 2]| if low < high { n } else { 1 };
    Plan::new(&Recipe {
        fitter: FITTER_VERSION,
        given: crate::GivenNodes::default(),
        brdf: BrdfKind::Ggx.into(),
        lobe: LobeModel::Ltc,
        layout,
        resolution: PerAxis { alpha, ratio: nodes(ratio, range.ratio), theta, phi: nodes(phi, range.phi) },
        range,
        fit: FitSettings {
            metric: Metric::Sw1,
            solver: Solver::Bfgs,
            samples: 128,
            directions: 8,
            steps: 30,
            seed: 0,
            simplex: None,
        },
        terms: StoredTerms::Schlick,
        precision: Precision::F32,
    })
}

fn fit_all(plan: &Plan) -> Vec<FittedEntry> {
    let fit = |shard| fit_shard(plan, shard, &mut |_| ControlFlow::Continue(())).expect("nothing stops it");
    (0..plan.shards()).flat_map(fit).collect()
}

fn table(layout: Layout, resolution: [u32; 4]) -> Table {
    let plan = plan_of(layout, resolution);
    assemble(&plan, &fit_all(&plan))
}

const SMALL: [u32; 4] = [3, 3, 4, 3];
const ANISOTROPIC: &[Layout] = &[Layout::Reflected, Layout::Kt2022];

#[test]
fn a_shard_takes_about_a_second_at_most_and_a_large_table_has_no_tiny_shards() {
    let seconds = |plan: &Plan| fit_seconds(plan.recipe()) / f64::from(plan.shards());
    let slow = plan([16, 8, 16, 8]);
    let slow = Plan::new(&Recipe {
        fit: FitSettings { samples: 65_536, steps: 400, ..slow.recipe().fit },
        ..slow.recipe().clone()
    });
    assert!((0.5..1.2).contains(&(seconds(&slow) / SHARD_SECONDS)), "{}", seconds(&slow));
    assert!(u64::from(slow.shards()) != slow.entries() / FEW_ENTRIES, "the number of entries decides");
    let large = plan([64, 16, 64, 16]);
    assert!((MANY_SHARDS..2 * MANY_SHARDS).contains(&large.shards().into()), "{}", large.shards());
    assert!(seconds(&large) < SHARD_SECONDS);
}

#[test]
fn shards_are_a_partition_of_the_entries_in_whole_rows() {
    for resolution in [[8; 4], SMALL, [2, 2, 2, 100]] {
        let plan = plan(resolution);
        let mut next = 0;
        for shard in 0..plan.shards() {
            let range = plan.shard_entries(shard);
            assert_eq!(range.start, next);
            assert!(range.end > range.start && (range.end - range.start).is_multiple_of(plan.row_length()));
            next = range.end;
        }
        assert_eq!(next, plan.entries());
        assert!(plan.shard_entries(plan.shards()).is_empty());
    }
}

#[test]
fn a_fit_reports_every_entry_and_can_be_stopped() {
    let plan = plan(SMALL);
    let mut calls = Vec::new();
    let stopped = fit_shard(&plan, 0, &mut |done| {
        calls.push(done);
        if done >= 6 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    assert_eq!((stopped, calls), (None, vec![1, 2, 3, 4, 5, 6]));
}

#[test]
fn bytes_round_trip_and_other_lengths_are_refused() {
    let two = LobeFresnel::Two(SecondLobe::Integrated);
    for fresnel in [LobeFresnel::One, two] {
        let has_second = fresnel.second().is_some();
        let recipe = plan(SMALL).recipe;
        let plan = Plan::new(&Recipe { brdf: recipe.brdf.clone().with_fresnel(fresnel), ..recipe });
        let entries = fit_shard(&plan, 1, &mut |_| ControlFlow::Continue(())).expect("nothing stops it");
        assert!(entries.iter().all(|entry| entry.second.is_some() == has_second));
        let bytes = shard_to_bytes(&entries);
        assert_eq!(shard_from_bytes(&plan, 1, &bytes), Ok(entries.clone()));
        let expected = bytes.len();
        let short = ShardBytesError { expected, actual: expected - 1 };
        assert_eq!(shard_from_bytes(&plan, 1, &bytes[1..]), Err(short));
    }
}

#[test]
fn stored_matrices_are_upright_and_normalised_as_the_layout_says() {
    for &layout in Layout::ALL {
        let small = if layout.is_of_materials() { [3, 1, 4, 3] } else { SMALL };
        for m in &table(layout, small).matrix {
            let m = from_row_major(&m.map(f64::from));
            // If the layout fixes no number, the fit chooses the scale of entries to minimise the error between nodes.
            let has_free_scale = [Layout::Godot, Layout::Inverse].contains(&layout);
            let is_normalised = has_free_scale || (layout.rules().norm(&m) - 1.0).abs() < 1e-6;
            assert!(m.determinant() > 0.0 && is_normalised, "{layout:?} {m}");
        }
    }
}

/// Tests mirror-like lobes down to the horizon. Some of them are lines, whose best fit has no width. Their f32 matrices
/// still have a positive determinant.
#[test]
fn f32_matrices_of_the_sharpest_lobes_are_upright() {
    for (seed, layout) in (0..3).flat_map(|seed| ANISOTROPIC.iter().map(move |layout| (seed, *layout))) {
        for top in [1e-3, 1e-2] {
            let mut recipe = plan_of(layout, [8, 4, 4, 6]).recipe;
            recipe.range.alpha = [0.0, top];
            recipe.range.theta[0] = 1.5;
            recipe.fit.seed = seed;
            let plan = Plan::new(&recipe);
            let table = assemble(&plan, &fit_all(&plan));
            for (index, m) in table.matrix.iter().enumerate() {
                assert!(
                    from_row_major(&m.map(f64::from)).determinant() > 0.0,
                    "{layout:?} {top} {seed} {index}: {m:?}"
                );
            }
        }
    }
}

/// The zeros of equation 16 of KT et al. 2022 hold exactly.
#[test]
fn symmetric_entries_have_exact_zeros() {
    for &layout in ANISOTROPIC {
        check_zeros(&table(layout, SMALL));
    }
}

fn check_zeros(table: &Table) {
    let at = |a: usize, r: usize, t: usize, p: usize| table.matrix[((a * 3 + r) * 4 + t) * 3 + p];
    for (a, r, t) in (0..3).flat_map(|a| (0..3).flat_map(move |r| (0..4).map(move |t| (a, r, t)))) {
        let [_, m01, _, m10, _, m12, _, m21, _] = at(a, r, t, 0);
        assert_eq!([m01, m10, m12, m21], [0.0; 4], "phi = 0, {a} {r} {t}");
        let [_, m01, m02, m10, _, _, m20, _, _] = at(a, r, t, 2);
        assert_eq!([m01, m02, m10, m20], [0.0; 4], "phi = pi/2, {a} {r} {t}");
    }
    assert_eq!(at(1, 1, 0, 0), at(1, 1, 0, 1));
    assert_eq!(at(1, 1, 0, 0), at(1, 1, 0, 2));
    let [xx, _, _, _, yy, ..] = at(1, 2, 0, 0);
    assert_eq!(xx, yy, "a round lobe");
}

/// Aligned matrices change little between neighbours along any axis. If the alignment jumped between two neighbours,
/// the matrix halfway between them would collapse.
#[test]
fn halfway_between_neighbours_no_determinant_collapses() {
    for &layout in ANISOTROPIC {
        check_halfway(&table(layout, [4, 4, 8, 5]));
    }
}

fn check_halfway(table: &Table) {
    let lengths = [4, 4, 8, 5];
    let determinant = |m: &[f32; 9]| from_row_major(&m.map(f64::from)).determinant();
    let strides = [160, 40, 5, 1];
    let mut pairs = 0;
    for index in 0..table.matrix.len() {
        for (stride, length) in strides.into_iter().zip(lengths) {
            if index / stride % length + 1 == length {
                continue;
            }
            let (here, there) = (&table.matrix[index], &table.matrix[index + stride]);
            let halfway = std::array::from_fn(|k| 0.5 * (here[k] + there[k]));
            let least = determinant(here).min(determinant(there));
            assert!(determinant(&halfway) > 0.5 * least, "{index} {stride}: {here:?} {there:?}");
            pairs += 1;
        }
    }
    assert!(pairs > 2000);
}

/// Tests many steps of few samples, and few steps of many samples. In every long entry, the progress callback is called
/// after a fixed amount of work. The call that stops the fit is the last call.
#[test]
fn every_solver_stops_in_the_middle_of_a_long_entry() {
    let plan = plan([2; 4]);
    for &solver in Solver::ALL {
        for (samples, directions, steps) in [(64, 4, 1_000_000), (65_536, 64, 2)] {
            let fit = FitSettings { solver, samples, directions, steps, ..plan.recipe().fit };
            let long = Plan::new(&Recipe { fit, ..plan.recipe().clone() });
            for last in [1, 3] {
                let mut calls = Vec::new();
                let stopped = fit_shard(&long, 0, &mut |done| {
                    calls.push(done);
                    if calls.len() == last { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
                });
                assert_eq!((stopped, calls.len()), (None, last), "{solver} {samples} {steps}");
                // Only the descent takes this many steps. The other solvers end much earlier.
                assert!(calls == vec![0; last] || (solver != Solver::Sgd && samples == 64), "{solver}: {calls:?}");
            }
        }
    }
}

/// An isotropic plan for the simplex with warm starts.
fn warm_plan(layout: Layout, [alpha, theta]: [u32; 2]) -> Plan {
    let mut recipe = plan_of(layout, [alpha, 1, theta, 1]).recipe;
    recipe.range = PerAxis { ratio: [1.0, 1.0], phi: [0.0, 0.0], ..recipe.range };
    recipe.fit = FitSettings {
        metric: Metric::L3,
        solver: Solver::NelderMead,
        simplex: Some(Simplex::default()),
        samples: 64,
        directions: 4,
        ..recipe.fit
    };
    Plan::new(&recipe)
}

/// A view starts from the previous view, so all views of a roughness are one row, for any number of views.
#[test]
fn rows_with_warm_starts_are_whole_and_do_not_depend_on_other_rows() {
    for resolution in [[9, 5], [2, 100]] {
        let plan = warm_plan(Layout::Ltc2017, resolution);
        assert_eq!((plan.rows(), plan.row_length()), (u64::from(resolution[0]), u64::from(resolution[1])));
        let by_shard = fit_all(&plan);
        assert_eq!(by_shard.len() as u64, plan.entries());
        let mut fitter = Fitter::new(&plan.recipe.fit);
        let mut row = |row: u64| fit_rows(&plan, row..row + 1, &mut fitter, &mut |_| ControlFlow::Continue(()));
        // Fits the rows from the last to the first, with one fitter.
        let mut by_row: Vec<Vec<FittedEntry>> =
            (0..plan.rows()).rev().map(|r| row(r).expect("nothing stops it")).collect();
        by_row.reverse();
        assert_eq!(by_row.concat(), by_shard, "{resolution:?}");
    }
}

/// The start of a search changes its result by less than the uncertainty of the samples.
#[test]
fn either_start_ends_at_about_the_same_errors() {
    let errors = |start: Start| {
        let mut recipe = warm_plan(Layout::Godot, [3, 12]).recipe;
        recipe.fit.simplex = Some(Simplex { start, ..Simplex::default() });
        let entries = fit_all(&Plan::new(&recipe));
        entries.iter().map(|entry| entry.error).collect::<Vec<f64>>()
    };
    let [warm, independent] = [Start::Warm, Start::Independent].map(errors);
    assert_ne!(warm, independent);
    let [warm, independent] = [warm, independent].map(|errors| errors.iter().sum::<f64>());
    assert!((warm / independent - 1.0).abs() < 0.03, "{warm} {independent}");
}
