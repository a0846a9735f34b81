//! The values of a tabulated BRDF and their integrals.

use super::TabulatedAxes;
use crate::math::{sin, sin_cos};

/// Nodes and weights of the eight-point Gauss-Legendre rule on [-1, 1]; the positive half. Over a quarter turn it
/// integrates `(a + b x) sin(2 x)` to the last digits.
const GAUSS: [(f64, f64); 4] = [
    (0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.525_532_409_916_329, 0.313_706_645_877_887_3),
    (0.796_666_477_413_626_7, 0.222_381_034_453_374_5),
    (0.960_289_856_497_536_3, 0.101_228_536_290_376_3),
];

/// A BRDF on a grid. It is linear between the nodes of each axis, and constant beyond the ends.
///
/// ```text
/// f(alpha, theta_o, theta_i, phi)      per steradian, without the cosine; isotropic, equal at -phi
/// E(alpha, theta_o) = 2 int_0^(pi/2) int_0^pi f dphi cos(theta_i) sin(theta_i) dtheta_i
///
/// f(alpha, ratio, theta_o, phi_o, theta_i, phi)      anisotropic
/// E(alpha, ratio, theta_o, phi_o) = int_0^(pi/2) int_0^(2 pi) f dphi cos(theta_i) sin(theta_i) dtheta_i
/// ```
///
/// An anisotropic surface is symmetric in the planes of its axes: `f` is the same at `(-phi_o, -phi)` and
/// `(pi - phi_o, -phi)`. The file therefore needs the views of one quadrant only. At the ends of the quadrant `f` is
/// equal at `phi` and `-phi`. The axis `phi` is the azimuth of the light relative to the view, so the lobe stays at the
/// same `phi` while the view turns. Linear interpolation between azimuths of the view depends on this.
///
/// The integral of a linear interpolation over `phi` is the trapezoid rule. The integral over `theta_i` has an
/// integrand of the form `(a + b x) sin(2 x)`. Both integrals are exact, so samples follow the interpolated function
/// exactly.
#[derive(Debug, Clone, PartialEq)]
pub struct TabulatedBrdf {
    axes: TabulatedAxes,
    /// `f` at the nodes, in the order of the axes.
    pub(super) values: Vec<f64>,
    /// `int_0^phi f` at the nodes.
    pub(super) below: Vec<f64>,
    /// The integrals of `(1 - x) sin cos` and of `x sin cos` over each interval of `theta_i`. `x` is the relative
    /// position in the interval.
    pub(super) moments: Vec<[f64; 2]>,
    /// `E` at the nodes of surface and view.
    albedo: Vec<f64>,
}

/// A point on the axes of surface and view.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Place {
    pub(super) alpha: Cell,
    pub(super) ratio: Cell,
    pub(super) theta_o: Cell,
    pub(super) phi_o: Cell,
}

/// A point between two neighbouring nodes.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Cell {
    /// The lower node.
    pub(super) node: usize,
    /// The upper node; the lower node again on an axis with one node.
    pub(super) next: usize,
    /// The position between the two nodes, in [0, 1].
    pub(super) part: f64,
}

impl Cell {
    /// The point at a node.
    pub(super) fn at(node: usize) -> Self {
        Self { node, next: node, part: 0.0 }
    }

    /// The point at `x`, clamped to the ends of the axis.
    pub(super) fn of(nodes: &[f64], x: f64) -> Self {
        if nodes.len() < 2 {
            return Self::at(0);
        }
        let next = nodes.partition_point(|node| *node <= x).clamp(1, nodes.len() - 1);
        let [low, high] = [nodes[next - 1], nodes[next]];
        Self { node: next - 1, next, part: ((x - low) / (high - low)).clamp(0.0, 1.0) }
    }

    /// Both nodes with their weights.
    pub(super) fn ends(self) -> [(usize, f64); 2] {
        [(self.node, 1.0 - self.part), (self.next, self.part)]
    }

    /// The nodes with a weight above zero.
    fn corners(self) -> impl Iterator<Item = (usize, f64)> {
        self.ends().into_iter().filter(|(_, weight)| *weight > 0.0)
    }
}

impl TabulatedBrdf {
    /// The grid of axes and values that are already checked.
    pub(super) fn of_checked(axes: TabulatedAxes, values: Vec<f64>) -> Self {
        let phis = axes.phi.len();
        let mut below = Vec::with_capacity(values.len());
        for row in values.chunks_exact(phis) {
            let mut sum = 0.0;
            below.push(0.0);
            for (pair, nodes) in row.windows(2).zip(axes.phi.windows(2)) {
                sum += 0.5 * (pair[0] + pair[1]) * (nodes[1] - nodes[0]);
                below.push(sum);
            }
        }
        let moments: Vec<[f64; 2]> = axes.theta_i.windows(2).map(|ends| moments(ends[0], ends[1])).collect();
        let rings: Vec<f64> = below.chunks_exact(phis).map(|row| row[phis - 1]).collect();
        let view = |rings: &[f64]| axes.sides() * masses(rings, &moments).sum::<f64>();
        let albedo = rings.chunks_exact(axes.theta_i.len()).map(view).collect();
        Self { axes, values, below, moments, albedo }
    }

    /// The nodes of the axes.
    #[must_use]
    pub fn axes(&self) -> &TabulatedAxes {
        &self.axes
    }

    /// `f` at the nodes; `phi` varies fastest.
    #[must_use]
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// The albedo under uniform light, at the nodes of `alpha`, `ratio`, `theta_o` and `phi_o`.
    #[must_use]
    pub fn albedos(&self) -> &[f64] {
        &self.albedo
    }

    /// The albedo between nodes, interpolated linearly.
    pub(super) fn albedo(&self, place: Place) -> f64 {
        self.views(place).map(|(view, weight)| weight * self.albedo[view]).sum()
    }

    /// The nodes of surface and view around a point, in storage order, with their weights.
    pub(super) fn views(&self, place: Place) -> impl Iterator<Item = (usize, f64)> {
        let [ratios, views, azimuths] =
            [&self.axes.ratio, &self.axes.theta_o, &self.axes.phi_o].map(|nodes| nodes.len().max(1));
        let Place { alpha, ratio, theta_o, phi_o } = place;
        alpha.corners().flat_map(move |(a, of_a)| {
            ratio.corners().flat_map(move |(r, of_r)| {
                theta_o.corners().flat_map(move |(o, of_o)| {
                    let node = move |v: usize| ((a * ratios + r) * views + o) * azimuths + v;
                    phi_o.corners().map(move |(v, of_v)| (node(v), of_a * of_r * of_o * of_v))
                })
            })
        })
    }

    /// The index of the first value of a row along `phi`, for a node of surface and view.
    pub(super) fn row(&self, view: usize, theta_i: usize) -> usize {
        (view * self.axes.theta_i.len() + theta_i) * self.axes.phi.len()
    }

    /// `f` at a point.
    pub(super) fn value(&self, place: Place, theta_i: Cell, phi: Cell) -> f64 {
        let mut sum = 0.0;
        for (view, weight) in self.views(place) {
            for (i, of_i) in theta_i.ends() {
                let row = self.row(view, i);
                let along = self.values[row + phi.node] * (1.0 - phi.part) + self.values[row + phi.next] * phi.part;
                sum += weight * of_i * along;
            }
        }
        sum
    }
}

/// The light reflected into each interval of `theta_i` on one side, from the integrals over `phi` at its ends.
pub(super) fn masses(rings: &[f64], moments: &[[f64; 2]]) -> impl Iterator<Item = f64> {
    rings.windows(2).zip(moments).map(|(ends, [low, high])| ends[0] * low + ends[1] * high)
}

/// The integrals of `(1 - x) sin cos` and `x sin cos` from `low` to `high`; `x` is the relative position.
fn moments(low: f64, high: f64) -> [f64; 2] {
    let half = 0.5 * (high - low);
    let mut sums = [0.0; 2];
    for (node, weight) in GAUSS.into_iter().flat_map(|(node, weight)| [(-node, weight), (node, weight)]) {
        let part = 0.5 * (1.0 + node);
        let value = 0.5 * sin(2.0 * (low + 2.0 * half * part)) * weight * half;
        sums[0] += (1.0 - part) * value;
        sums[1] += part * value;
    }
    sums
}

/// The integral of `(a + (b - a) y / width) sin cos` over the first `x` of an interval that begins at `low`:
///
/// ```text
/// a sin(x) sin(2 low + x) / 2 + (b - a) / width (cos(2 low + x) sin(x) - x cos(2 low + 2 x)) / 4
/// ```
pub(super) fn mass_below(low: f64, width: f64, [a, b]: [f64; 2], x: f64) -> f64 {
    let ((sin_x, cos_x), (sin_mid, cos_mid)) = (sin_cos(x), sin_cos(2.0 * low + x));
    let cos_end = cos_mid * cos_x - sin_mid * sin_x;
    0.5 * a * sin_x * sin_mid + 0.25 * (b - a) / width * (cos_mid * sin_x - x * cos_end)
}
