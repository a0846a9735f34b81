//! Where a layout puts its nodes.

use std::f64::consts::FRAC_PI_2;

use super::Recipe;
use crate::fit::{
    ltc::{Layout, PerAxis},
    math::pow,
};

/// The sharpest roughness that is fitted. Below it the lobe is a mirror's for every light a scene can hold.
pub const ALPHA_FLOOR: f64 = 1e-4;
/// The smallest ratio that is fitted: a needle ten thousand times longer than wide.
pub const RATIO_FLOOR: f64 = 1e-4;
/// The steepest view that is fitted; at the horizon itself no light is reflected [KT et al. 2022, published table].
pub const THETA_CEILING: f64 = 0.9999 * FRAC_PI_2;

/// Ascending nodes of each axis of a recipe's table.
///
/// `kt2022`: uniform in alpha, ratio, theta and phi; a node below a floor is moved onto it. `reflected`: uniform in `u`,
/// with alpha = `u^1.6`, ratio = `u^1.3`, theta = `1 - (1 - u)^2` of the way to its ceiling and phi = `u pi/2`, from one
/// end of the range to the other, or the floor: a part of the domain is divided as the whole is. In both, the range of
/// theta ends at its ceiling before it is divided.
#[must_use]
pub fn nodes(recipe: &Recipe) -> PerAxis<Vec<f64>> {
    let (range, n) = (&recipe.range, &recipe.resolution);
    let theta = range.theta.map(|theta| theta.min(THETA_CEILING));
    let phi = Spacing::Even.divide(range.phi, n.phi);
    match recipe.layout {
        Layout::Kt2022 => {
            let above = |range, n, floor: f64| Spacing::Even.divide(range, n).into_iter().map(move |x| x.max(floor));
            PerAxis {
                alpha: above(range.alpha, n.alpha, ALPHA_FLOOR).collect(),
                ratio: above(range.ratio, n.ratio, RATIO_FLOOR).collect(),
                theta: Spacing::Even.divide(theta, n.theta),
                phi,
            }
        }
        Layout::Reflected => PerAxis {
            alpha: Spacing::Power(1.6).divide(range.alpha.map(|alpha| alpha.max(ALPHA_FLOOR)), n.alpha),
            ratio: Spacing::Power(1.3).divide(range.ratio.map(|ratio| ratio.max(RATIO_FLOOR)), n.ratio),
            theta: Spacing::Grazing.divide(theta, n.theta),
            phi,
        },
    }
}

/// The step between neighbouring nodes of each axis where they are even, as a part of the whole domain there: 1 for the
/// two ends alone, 0 for a single node.
pub(super) fn steps(recipe: &Recipe) -> PerAxis<f64> {
    let (range, n) = (&recipe.range, &recipe.resolution);
    let theta = range.theta.map(|theta| theta.min(THETA_CEILING));
    let [alpha, ratio, grazing] = match recipe.layout {
        Layout::Kt2022 => [Spacing::Even; 3],
        Layout::Reflected => [Spacing::Power(1.6), Spacing::Power(1.3), Spacing::Grazing],
    };
    PerAxis {
        alpha: alpha.step(range.alpha, n.alpha, 1.0),
        ratio: ratio.step(range.ratio, n.ratio, 1.0),
        theta: grazing.step(theta, n.theta, THETA_CEILING),
        phi: Spacing::Even.step(range.phi, n.phi, FRAC_PI_2),
    }
}

/// Where nodes lie, as an ascending function of even steps.
#[derive(Debug, Clone, Copy)]
enum Spacing {
    /// The steps themselves.
    Even,
    /// `u^p`.
    Power(f64),
    /// `(1 - (1 - u)^2)` of the way to [`THETA_CEILING`].
    Grazing,
}

impl Spacing {
    fn value(self, u: f64) -> f64 {
        match self {
            Self::Even => u,
            Self::Power(p) => pow(u, p),
            Self::Grazing => (1.0 - (1.0 - u) * (1.0 - u)) * THETA_CEILING,
        }
    }

    fn invert(self, x: f64) -> f64 {
        match self {
            Self::Even => x,
            Self::Power(p) => pow(x, 1.0 / p),
            Self::Grazing => 1.0 - (1.0 - x / THETA_CEILING).max(0.0).sqrt(),
        }
    }

    /// The step of `n` values over a range, where they are even, as a part of that from 0 to `whole`.
    fn step(self, [low, high]: [f64; 2], n: u32, whole: f64) -> f64 {
        (self.invert(high) - self.invert(low)) / self.invert(whole) / f64::from(n.saturating_sub(1).max(1))
    }

    /// `n` values from one end of a range to the other, both met exactly; its beginning for `n` of one.
    fn divide(self, [low, high]: [f64; 2], n: u32) -> Vec<f64> {
        let last = n.saturating_sub(1).max(1);
        let [from, to] = [low, high].map(|end| self.invert(end));
        let at = |i: u32| match i {
            0 => low,
            _ if i == last => high,
            _ => self.value(from + (to - from) * (f64::from(i) / f64::from(last))),
        };
        (0..n).map(at).collect()
    }
}
