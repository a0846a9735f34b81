//! The numbers of a tabulated BRDF, and their integrals.

use super::TabulatedAxes;
use crate::math::{sin, sin_cos};

/// Nodes and weights of the Gauss-Legendre rule of eight points on [-1, 1], for its positive half. Over a quarter turn
/// it is exact to the last digits for `(a + b x) sin(2 x)`.
const GAUSS: [(f64, f64); 4] = [
    (0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.525_532_409_916_329, 0.313_706_645_877_887_3),
    (0.796_666_477_413_626_7, 0.222_381_034_453_374_5),
    (0.960_289_856_497_536_3, 0.101_228_536_290_376_3),
];

/// A BRDF on a grid, linear in each of its axes between the nodes and constant beyond their ends.
///
/// ```text
/// f(alpha, theta_o, theta_i, phi)      per steradian, without the cosine; isotropic, as much at -phi
/// E(alpha, theta_o) = 2 int_0^(pi/2) int_0^pi f dphi cos(theta_i) sin(theta_i) dtheta_i
///
/// f(alpha, ratio, theta_o, phi_o, theta_i, phi)      anisotropic
/// E(alpha, ratio, theta_o, phi_o) = int_0^(pi/2) int_0^(2 pi) f dphi cos(theta_i) sin(theta_i) dtheta_i
/// ```
///
/// An anisotropic surface is its own mirror image in the planes of its axes, so that `f` is the same at
/// `(-phi_o, -phi)` and `(pi - phi_o, -phi)`: views of one quadrant tell all others, and at its ends `f` is as much at
/// `-phi`. With the difference of azimuths as an axis a lobe stays where it is while the view turns, which a linear
/// interpolation between azimuths of the view needs.
///
/// The integral over `phi` of a linear interpolation is the trapezoid rule's, that over `theta_i` one of
/// `(a + b x) sin(2 x)`: both are exact, so samples are drawn from the interpolated function itself.
#[derive(Debug, Clone, PartialEq)]
pub struct TabulatedBrdf {
    axes: TabulatedAxes,
    /// `f` at the nodes, in the order of the axes.
    pub(super) values: Vec<f64>,
    /// `int_0^phi f` at the nodes.
    pub(super) below: Vec<f64>,
    /// For each interval of `theta_i`, of which `x` is the part from its lower end: the integrals of `(1 - x) sin cos`
    /// and of `x sin cos`.
    pub(super) moments: Vec<[f64; 2]>,
    /// `E` at the nodes of surface and view.
    albedo: Vec<f64>,
}

/// A place on the axes of surface and view.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Place {
    pub(super) alpha: Cell,
    pub(super) ratio: Cell,
    pub(super) theta_o: Cell,
    pub(super) phi_o: Cell,
}

/// A place between two neighbouring nodes.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Cell {
    /// The lower node.
    pub(super) node: usize,
    /// The upper one, the same on an axis of one node.
    pub(super) next: usize,
    /// The part of the way from one to the other, in [0, 1].
    pub(super) part: f64,
}

impl Cell {
    /// A node.
    pub(super) fn at(node: usize) -> Self {
        Self { node, next: node, part: 0.0 }
    }

    /// The place of `x`, moved to the nearer end where it lies beyond.
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

    /// The nodes that have any weight.
    fn corners(self) -> impl Iterator<Item = (usize, f64)> {
        self.ends().into_iter().filter(|(_, weight)| *weight > 0.0)
    }
}

impl TabulatedBrdf {
    /// The grid of axes and values that were checked.
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

    /// Its nodes.
    #[must_use]
    pub fn axes(&self) -> &TabulatedAxes {
        &self.axes
    }

    /// `f` at its nodes, `phi` fastest.
    #[must_use]
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// The albedo under uniform light, at the nodes of `alpha`, `ratio`, `theta_o` and `phi_o`.
    #[must_use]
    pub fn albedos(&self) -> &[f64] {
        &self.albedo
    }

    /// The same between nodes, which is linear there too.
    pub(super) fn albedo(&self, place: Place) -> f64 {
        self.views(place).map(|(view, weight)| weight * self.albedo[view]).sum()
    }

    /// The nodes of surface and view around a place, in storage order, with their weights.
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

    /// The first value of a row along `phi`, for a node of surface and view.
    pub(super) fn row(&self, view: usize, theta_i: usize) -> usize {
        (view * self.axes.theta_i.len() + theta_i) * self.axes.phi.len()
    }

    /// `f` at a place.
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

/// The light that each interval of `theta_i` reflects on one side, from the integrals over `phi` at its ends.
pub(super) fn masses(rings: &[f64], moments: &[[f64; 2]]) -> impl Iterator<Item = f64> {
    rings.windows(2).zip(moments).map(|(ends, [low, high])| ends[0] * low + ends[1] * high)
}

/// The integrals of `(1 - x) sin cos` and `x sin cos` from `low` to `high`, `x` the part of the way.
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
