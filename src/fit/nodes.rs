//! Where a layout puts its nodes.

use std::f64::consts::FRAC_PI_2;

use super::Recipe;
use crate::ltc::{Layout, PerAxis};

/// The sharpest roughness that is fitted. Below it the lobe is a mirror's for every light a scene can hold.
pub const ALPHA_FLOOR: f64 = 1e-4;
/// The smallest ratio that is fitted: a needle ten thousand times longer than wide.
pub const RATIO_FLOOR: f64 = 1e-4;
/// The smaller roughness is fitted as if it were at least this: of a lobe that is already a mirror's in one direction,
/// the other would be a line thinner than f32 directions are apart, and nothing could be interpolated.
pub const ALPHA_Y_FLOOR: f64 = 1e-5;
/// The steepest view that is fitted; at the horizon itself no light is reflected [KT et al. 2022, published table].
pub const THETA_CEILING: f64 = 0.9999 * FRAC_PI_2;

/// Ascending nodes of each axis of a recipe's table.
///
/// `kt2022`: uniform in alpha, ratio, theta and phi. A node below a floor is moved onto it; the range of theta ends
/// at its ceiling before it is divided.
#[must_use]
pub fn nodes(recipe: &Recipe) -> PerAxis<Vec<f64>> {
    let (range, n) = (&recipe.range, &recipe.resolution);
    match recipe.layout {
        Layout::Kt2022 => PerAxis {
            alpha: uniform(range.alpha, n.alpha).map(|alpha| alpha.max(ALPHA_FLOOR)).collect(),
            ratio: uniform(range.ratio, n.ratio).map(|ratio| ratio.max(RATIO_FLOOR)).collect(),
            theta: uniform(range.theta.map(|theta| theta.min(THETA_CEILING)), n.theta).collect(),
            phi: uniform(range.phi, n.phi).collect(),
        },
    }
}

/// `n` values from one end of a range to the other, both met exactly; its beginning for `n` of one.
fn uniform([low, high]: [f64; 2], n: u32) -> impl Iterator<Item = f64> {
    let last = n.saturating_sub(1).max(1);
    (0..n).map(move |i| if i == last { high } else { low + (high - low) * (f64::from(i) / f64::from(last)) })
}
