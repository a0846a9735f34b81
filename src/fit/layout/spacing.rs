//! The spacing of nodes along an axis, and the limits of their range.

use std::f64::consts::{FRAC_PI_2, SQRT_2};

use crate::{
    axes::PerAxis,
    math::{atan2, pow, sin},
};

/// The smallest fitted roughness. A smoother surface looks like a mirror under all practical lights.
pub const ALPHA_FLOOR: f64 = 1e-4;
/// The smallest fitted ratio: a needle ten thousand times longer than wide.
pub const RATIO_FLOOR: f64 = 1e-4;
/// The most grazing fitted view. At the horizon no light is reflected [KT et al. 2022, published table].
pub const THETA_CEILING: f64 = 0.9999 * FRAC_PI_2;

/// The tolerance of even spacing, relative to a step. Nodes in a file are rounded decimals.
const EVEN: f64 = 1e-6;

/// The value of a node, as an ascending function of an evenly spaced variable `u`.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Spacing {
    /// `u`.
    Even,
    /// `u^p`.
    Power(f64),
    /// `(1 - (1 - u)^2)` times [`THETA_CEILING`].
    Grazing,
    /// `u^2`, which is alpha as a function of perceptual roughness.
    Squared,
    /// The angle whose `sqrt(1 - cos)` is `u`: `2 asin(u / sqrt 2)`. Domain: `u` in [0, 1].
    Versine,
}

impl Spacing {
    /// The value at `u`.
    pub(crate) fn value(self, u: f64) -> f64 {
        match self {
            Self::Even => u,
            Self::Power(p) => pow(u, p),
            Self::Grazing => (1.0 - (1.0 - u) * (1.0 - u)) * THETA_CEILING,
            Self::Squared => u * u,
            Self::Versine => 2.0 * atan2(u, (2.0 - u * u).sqrt()),
        }
    }

    /// The `u` of a value.
    pub(crate) fn invert(self, x: f64) -> f64 {
        match self {
            Self::Even => x,
            Self::Power(p) => pow(x, 1.0 / p),
            Self::Grazing => 1.0 - (1.0 - x / THETA_CEILING).max(0.0).sqrt(),
            Self::Squared => x.sqrt(),
            Self::Versine => SQRT_2 * sin(0.5 * x),
        }
    }

    /// The step of `u` between `n` nodes over a range, relative to the change of `u` from value 0 to value `whole`.
    pub(super) fn step(self, [low, high]: [f64; 2], n: u32, whole: f64) -> f64 {
        (self.invert(high) - self.invert(low)) / self.invert(whole) / f64::from(n.saturating_sub(1).max(1))
    }

    /// True if nodes are evenly spaced. With `is_first_free`, the first node may be above its even position.
    pub(super) fn is_even(self, nodes: &[f64], is_first_free: bool) -> bool {
        let [.., before, last] = *nodes else { return true };
        let [before, last] = [before, last].map(|node| self.invert(node));
        let step = last - before;
        let at = |i: usize| last - step * (nodes.len() - 1 - i) as f64;
        let is_near = |(i, node): (usize, &f64)| (self.invert(*node) - at(i)).abs() <= EVEN * step;
        let is_first_fine = is_near((0, &nodes[0])) || is_first_free && self.invert(nodes[0]) > at(0);
        is_first_fine && nodes.iter().enumerate().skip(1).all(is_near)
    }

    /// `n` values from one end of a range to the other, with both ends exact. A single value is the lower end.
    pub(super) fn divide(self, [low, high]: [f64; 2], n: u32) -> Vec<f64> {
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

/// The point whose lobe is stored at a node: the node, clamped to the limits of the fit.
pub(crate) fn within_limits(node: PerAxis<f64>) -> PerAxis<f64> {
    PerAxis { alpha: node.alpha.max(ALPHA_FLOOR), theta: node.theta.min(THETA_CEILING), ..node }
}

/// The range of theta, clamped to the ceiling.
pub(super) fn below_ceiling(theta: [f64; 2]) -> [f64; 2] {
    theta.map(|theta| theta.min(THETA_CEILING))
}

/// See [`super::Layout::steps`].
pub(super) fn steps(spacing: &PerAxis<Spacing>, range: &PerAxis<[f64; 2]>, resolution: &PerAxis<u32>) -> PerAxis<f64> {
    PerAxis {
        alpha: spacing.alpha.step(range.alpha, resolution.alpha, 1.0),
        ratio: spacing.ratio.step(range.ratio, resolution.ratio, 1.0),
        theta: spacing.theta.step(below_ceiling(range.theta), resolution.theta, THETA_CEILING),
        phi: spacing.phi.step(range.phi, resolution.phi, FRAC_PI_2),
    }
}
