//! Computes amplitude and Fresnel term for a table without terms.

use rayon::prelude::*;

use super::{
    axes::PerAxis,
    brdf::{BrdfKind, BrdfModel, edge_spread},
    layout::{Layout, within_limits},
    math::{Lattice, SquarePoint},
    table::Terms,
};

/// The number of samples of a lobe. The terms are then within 1e-3 of their limit.
const SAMPLES: usize = 4096;

/// GGX's amplitude and Fresnel term at every node; see [`terms_of`].
#[must_use]
pub fn ggx_terms(layout: Layout, axes: &PerAxis<Vec<f64>>) -> Terms {
    terms_of(&BrdfKind::Ggx.into(), layout, axes)
}

/// A scattering model's amplitude and Fresnel term at every node, as a layout stores them, in storage order. Runs on
/// the current rayon pool. The size of the pool does not change the result.
///
/// Domain: nodes that a fit can have, and a model that [is complete](BrdfModel::is_complete).
#[must_use]
pub fn terms_of(brdf: &BrdfModel, layout: Layout, axes: &PerAxis<Vec<f64>>) -> Terms {
    let PerAxis { alpha, ratio, theta, phi } = layout.lengths(axes);
    let points: Vec<SquarePoint> = Lattice::new(SAMPLES, [0.0; 2]).points().map(SquarePoint::new).collect();
    let (amplitude, fresnel) = (0..alpha * ratio * theta * phi)
        .into_par_iter()
        .map(|index| {
            let place = within_limits(layout.node(axes, index));
            let wo = place.view();
            let terms = brdf.surface_at(&place).terms(wo, &points);
            let stored = layout.rules().store_terms(&place, terms);
            (stored.amplitude as f32, stored.fresnel as f32)
        })
        .unzip();
    Terms { amplitude, fresnel, edge: None }
}

/// A scattering model's [`edge_spread`] at every node, in storage order. All layouts store the edge term in this form.
/// Runs on the current rayon pool. The size of the pool does not change the result.
///
/// Domain: the same as for [`terms_of`].
#[must_use]
pub fn edge_spreads(brdf: &BrdfModel, layout: Layout, axes: &PerAxis<Vec<f64>>) -> Vec<f64> {
    let PerAxis { alpha, ratio, theta, phi } = layout.lengths(axes);
    let points: Vec<SquarePoint> = Lattice::new(SAMPLES, [0.0; 2]).points().map(SquarePoint::new).collect();
    (0..alpha * ratio * theta * phi)
        .into_par_iter()
        .map(|index| {
            let place = within_limits(layout.node(axes, index));
            edge_spread(&*brdf.surface_at(&place), place.view(), &points)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use std::{f64::consts::FRAC_PI_2, ops::ControlFlow};

    use super::*;
    use crate::{
        BrdfKind, FITTER_VERSION, FitSettings, LobeModel, Metric, Plan, Precision, Recipe, Solver, StoredTerms,
        assemble, fit_shard,
    };

    #[test]
    fn terms_equal_the_terms_of_a_fit() {
        let (one, quarter) = ([0.0, 1.0], [0.0, FRAC_PI_2]);
        for &layout in &[Layout::Reflected, Layout::Kt2022] {
            let plan = Plan::new(&Recipe {
                fitter: FITTER_VERSION,
                given: crate::GivenNodes::default(),
                brdf: BrdfKind::Ggx.into(),
                lobe: LobeModel::Ltc,
                layout,
                resolution: PerAxis { alpha: 3, ratio: 3, theta: 4, phi: 2 },
                range: PerAxis { alpha: one, ratio: one, theta: quarter, phi: quarter },
                fit: FitSettings {
                    metric: Metric::Sw1,
                    solver: Solver::Bfgs,
                    samples: 512,
                    directions: 2,
                    steps: 1,
                    seed: 0,
                    simplex: None,
                },
                terms: StoredTerms::Schlick,
                precision: Precision::F32,
            });
            let fit = |shard| fit_shard(&plan, shard, &mut |_| ControlFlow::Continue(())).expect("nothing stops it");
            let table = assemble(&plan, &(0..plan.shards()).flat_map(fit).collect::<Vec<_>>());
            let (found, fitted) = (ggx_terms(layout, &table.axes), table.terms.expect("the recipe asks for them"));
            assert_eq!(found.amplitude.len(), 72);
            let pairs = |a: &[f32], b: &[f32]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
            // The fit takes only 2048 samples of the lobe, which limits the agreement. The smallest amplitude, at the
            // horizon, is 0.5.
            assert!(pairs(&found.amplitude, &fitted.amplitude) < 4e-3, "{found:?} {fitted:?}");
            assert!(pairs(&found.fresnel, &fitted.fresnel) < 4e-3, "{found:?} {fitted:?}");
        }
    }
}
