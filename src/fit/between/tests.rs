use std::ops::ControlFlow;

use super::*;
use crate::{
    BrdfKind, Configuration, FITTER_VERSION, FitSettings, Fitter, Layout, LobeModel, Metric, PerAxis, Precision,
    Recipe, Solver, StoredTerms, Table, Terms, assemble,
    brdf::{Ggx, Mirrors},
    fit_shard,
    math::{direction, from_row_major, row_major},
    stop_check::{StopCheck, unstopped},
};

const OF_ENGINES: [Layout; 4] = [Layout::Ltc2017, Layout::Ltc2016, Layout::Godot, Layout::Hdrp];
const ISOTROPIC: [Layout; 6] =
    [Layout::Ltc2017, Layout::Ltc2016, Layout::Godot, Layout::Hdrp, Layout::Inverse, Layout::Matrix33];
const SETTINGS: FitSettings = FitSettings {
    metric: Metric::Sw1,
    solver: Solver::Bfgs,
    samples: 128,
    directions: 8,
    steps: 30,
    seed: 0,
    simplex: None,
};

fn fitted(layout: Layout, nodes: u32, precision: Precision) -> (Plan, Vec<FittedEntry>) {
    let plan = Plan::new(&Recipe {
        fitter: FITTER_VERSION,
        given: crate::GivenNodes::default(),
        brdf: BrdfKind::Ggx.into(),
        lobe: LobeModel::Ltc,
        layout,
        resolution: PerAxis { alpha: nodes, ratio: 1, theta: nodes, phi: 1 },
        range: layout.only_ranges().expect("the layout has one domain"),
        fit: SETTINGS,
        terms: StoredTerms::Schlick,
        precision,
    });
    let fit = |shard| fit_shard(&plan, shard, &mut |_| ControlFlow::Continue(())).expect("nothing stops it");
    let entries = (0..plan.shards()).flat_map(fit).collect();
    (plan, entries)
}

/// The stored numbers of entries fitted to their own lobes.
fn own_numbers(plan: &Plan, entries: &[FittedEntry]) -> Vec<LobeNumbers> {
    let rules = plan.recipe().layout.rules();
    let own = |(index, entry): (u64, &FittedEntry)| {
        let place = plan.place(index);
        let matrix = from_row_major(&entry.matrix);
        let terms = LobeTerms { amplitude: entry.amplitude, fresnel: entry.fresnel };
        rules.store(&place, &LobeNumbers { matrix, terms }, Mirrors::of(place.view()), Precision::F32)
    };
    (0..).zip(entries).map(own).collect()
}

/// The table of the numbers that `own_numbers` returns.
fn as_fitted(plan: &Plan, entries: &[FittedEntry], chosen: &Table) -> Table {
    let own = own_numbers(plan, entries);
    let matrix = own.iter().map(|own| row_major(&own.matrix).map(|x| x as f32)).collect();
    let term = |of: fn(&LobeTerms) -> f64| own.iter().map(|own| of(&own.terms) as f32).collect();
    let terms = Terms { amplitude: term(|terms| terms.amplitude), fresnel: term(|terms| terms.fresnel), edge: None };
    Table { matrix, terms: Some(terms), ..chosen.clone() }
}

/// Mean errors of lobes and amplitudes at the centres of the cells. The error of a lobe is relative to the error of a
/// fit at that point.
fn errors(table: &Table) -> [f64; 2] {
    let mut judge = Fitter::new(&SETTINGS);
    let mut sums = [0.0; 2];
    let mut count = 0.0;
    for (i, j) in (2..15).flat_map(|i| (0..15).map(move |j| (i, j))) {
        let (roughness, theta) = ((f64::from(i) + 0.5) / 15.0, (f64::from(j) + 0.5) / 15.0 * 1.55);
        let alpha = roughness * roughness;
        let at = Configuration { alpha_x: alpha, alpha_y: alpha, theta, phi: 0.0 };
        let (ggx, wo) = (Ggx { alpha_x: alpha, alpha_y: alpha }, direction(theta, 0.0));
        let found = table.lookup(&at);
        let best = judge.fit(&ggx, wo, 0, &mut StopCheck::new(&mut unstopped)).expect("nothing stops it");
        sums[0] += judge.error(&ggx, wo, &from_row_major(&found.matrix)) / best.error;
        sums[1] += (found.amplitude.expect("terms") - best.amplitude).abs();
        count += 1.0;
    }
    sums.map(|sum| sum / count)
}

#[test]
fn chosen_entries_are_nearer_between_nodes_than_fitted_entries() {
    // The test leaves out two layouts: with 16 nodes, `inverse` is stored as fitted and `matrix33` hardly improves.
    for layout in OF_ENGINES {
        let (plan, entries) = fitted(layout, 16, Precision::F32);
        let chosen = assemble(&plan, &entries);
        let ([lobes, amplitude], [own_lobes, own_amplitude]) =
            (errors(&chosen), errors(&as_fitted(&plan, &entries, &chosen)));
        assert!(lobes - 1.0 < 0.6 * (own_lobes - 1.0), "{layout}: {lobes}, as fitted {own_lobes}");
        assert!(amplitude < 0.8 * own_amplitude, "{layout}: {amplitude}, as fitted {own_amplitude}");
    }
}

/// On a grid with few nodes, the quadratic form is a poor estimate of the displacement.
#[test]
fn coarse_tables_are_no_worse_than_as_fitted() {
    let mut kept = 0;
    for (layout, nodes) in ISOTROPIC.iter().flat_map(|layout| [2, 3, 5, 8].map(|nodes| (*layout, nodes))) {
        let (plan, entries) = fitted(layout, nodes, Precision::F32);
        let (own, free) = (own_numbers(&plan, &entries), layout.rules().free_numbers().expect("an engine's layout"));
        let (grid, lobes) = (Grid { rows: nodes as usize, columns: nodes as usize }, Lobes::of(&plan, &entries));
        let errors = |stored: &[DMat3]| errors_between(grid, &lobes, stored, free, &Displacement::new());
        let fitted: Vec<DMat3> = own.iter().map(|own| own.matrix).collect();
        let found = matrices(&plan, grid, &lobes, &own, free);
        assert!(errors(&found) <= errors(&fitted), "{layout} {nodes}");
        kept += usize::from(found == fitted);
    }
    assert!((1..24).contains(&kept), "{kept} of 24 tables are stored as fitted");
}

/// Tests nodes and points between them, including the smallest roughness and the horizon, in both precisions.
#[test]
fn every_interpolated_matrix_is_upright_and_every_number_finite() {
    for (layout, precision) in ISOTROPIC.iter().flat_map(|layout| Precision::ALL.iter().map(|p| (*layout, *p))) {
        let (plan, entries) = fitted(layout, 12, precision);
        let table = assemble(&plan, &entries);
        let numbers = table.matrix.iter().flatten();
        assert!(numbers.clone().all(|x| x.abs() <= 60_000.0), "{layout} {precision}");
        let counts = table.axes.lengths();
        let at =
            |i: usize, j: usize| DMat3::from_cols_array(&table.matrix[i * counts.theta + j].map(f64::from)).transpose();
        for (cell, part) in observed(Grid { rows: counts.alpha, columns: counts.theta }) {
            for part in [part, [0.0, 0.0], [1.0, 1.0]] {
                let between = corners(part).map(|(down, right, phi)| at(cell[0] + down, cell[1] + right) * phi);
                let between = between.into_iter().fold(DMat3::ZERO, |sum, m| sum + m);
                let diagonal = [between.x_axis.x, between.y_axis.y, between.z_axis.z];
                assert!(
                    between.determinant() > 0.0 && diagonal.iter().all(|x| *x > 0.0),
                    "{layout} {precision} {cell:?} {part:?}: {between}"
                );
            }
        }
    }
}

#[test]
fn layouts_without_free_numbers_and_large_tables_are_stored_as_fitted() {
    let (plan, entries) = fitted(Layout::Ltc2017, 12, Precision::F32);
    let own = vec![LobeNumbers { matrix: DMat3::IDENTITY, terms: LobeTerms { amplitude: 1.0, fresnel: 0.0 } }; 144];
    assert!(chosen(&plan, &entries, &own).is_some());
    let mut recipe = plan.recipe().clone();
    recipe.layout = Layout::Kt2022;
    assert!(chosen(&Plan::new(&recipe), &entries, &own).is_none());
    let mut recipe = plan.recipe().clone();
    recipe.resolution.alpha = 65_536;
    recipe.resolution.theta = 2;
    assert!(chosen(&Plan::new(&recipe), &vec![entries[0]; 131_072], &own).is_none());
}
