//! The gradient of the sliced Wasserstein distance by sorting, as in Algorithm 3 of KT et al. 2022.

use glam::{DMat3, DVec3};

use crate::{metric::distance::Draws, stop_check::StopCheck};

/// Work of a step for each sample and direction, in units of a projection. It covers two sorts.
const SORTING: usize = 16;

/// Returns `rate` times the gradient with respect to `M`. Along each direction, the sorted projections of lobe and LTC
/// form pairs, and each sample of the LTC moves towards its partner. The chain rule through `f = M c / |M c|` converts
/// these slopes to the gradient.
pub(super) fn step(m: &DMat3, rate: f64, draws: &Draws, stop_check: &mut StopCheck) -> Option<DMat3> {
    let Draws { lobe, cosines, directions } = draws;
    let n = lobe.len();
    let ltc: Vec<DVec3> = cosines.iter().map(|c| (*m * *c).normalize()).collect();
    let (mut slopes, mut wanted, mut order) = (vec![DVec3::ZERO; n], vec![0.0; n], vec![(0.0, 0_usize); n]);
    for d in directions {
        stop_check.worked(SORTING * n)?;
        wanted.iter_mut().zip(lobe).for_each(|(x, wi)| *x = d.dot(*wi));
        wanted.sort_unstable_by(f64::total_cmp);
        order.iter_mut().zip(&ltc).enumerate().for_each(|(i, (slot, f))| *slot = (d.dot(*f), i));
        order.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        for ((x, i), wanted) in order.iter().zip(&wanted) {
            slopes[*i] += if x > wanted { *d } else { -*d };
        }
    }
    let mut by_m = DMat3::ZERO;
    for ((f, g), c) in ltc.iter().zip(&slopes).zip(cosines) {
        let by_w = (*g - *f * f.dot(*g)) * (1.0 / (*m * *c).length());
        by_m += DMat3::from_cols(by_w * c.x, by_w * c.y, by_w * c.z);
    }
    Some(by_m * (rate / (n * directions.len()) as f64))
}
