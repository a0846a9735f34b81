//! A tabulated BRDF at one roughness, sampled by its own inverse.

use std::{f64::consts::PI, sync::Arc};

use glam::DVec3;

use super::{
    TabulatedAxes, TabulatedBrdf,
    grid::{Cell, mass_below, masses},
};
use crate::{
    brdf::scattering::{Bends, Brdf, BrdfSample, cos_theta_d},
    math::{SquarePoint, atan2, sin_cos},
};

/// Newton's steps within an interval, at most; three or four are taken.
const STEPS: usize = 40;
/// The search ends with a step that is shorter than this part of its interval.
const SHORT_STEP: f64 = 1e-13;

/// A surface of a tabulated BRDF.
#[derive(Debug, Clone)]
pub(crate) struct TabulatedSurface {
    data: Arc<TabulatedBrdf>,
    alpha: Cell,
}

impl TabulatedBrdf {
    /// The surface of this roughness, or of the nearest that the file has.
    pub(crate) fn surface(self: &Arc<Self>, alpha: f64) -> TabulatedSurface {
        TabulatedSurface { alpha: Cell::of(&self.axes().alpha, alpha), data: Arc::clone(self) }
    }
}

/// The polar angle of a direction, exact at the pole and the horizon.
fn polar(w: DVec3) -> f64 {
    atan2((w.x * w.x + w.y * w.y).sqrt(), w.z)
}

impl TabulatedSurface {
    fn view(&self, wo: DVec3) -> Cell {
        Cell::of(&self.data.axes().theta_o, polar(wo))
    }
}

impl Brdf for TabulatedSurface {
    fn eval_cos(&self, wo: DVec3, wi: DVec3) -> f64 {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return 0.0;
        }
        let apart = atan2((wo.x * wi.y - wo.y * wi.x).abs(), wo.x * wi.x + wo.y * wi.y);
        let axes = self.data.axes();
        let (theta_i, phi) = (Cell::of(&axes.theta_i, polar(wi)), Cell::of(&axes.phi, apart));
        self.data.value(self.alpha, self.view(wo), theta_i, phi) * wi.z
    }

    /// At every node.
    fn bends(&self, _: DVec3) -> Bends {
        let TabulatedAxes { theta_i, phi, .. } = self.data.axes();
        Bends { theta_i: theta_i[1..theta_i.len() - 1].to_vec(), phi: phi.clone() }
    }

    fn sample(&self, wo: DVec3, u: [f64; 2]) -> BrdfSample {
        Inverse::new(self, wo).sample(u)
    }

    fn sample_all(&self, wo: DVec3, points: &[SquarePoint], drawn: &mut Vec<BrdfSample>) {
        let inverse = Inverse::new(self, wo);
        drawn.extend(points.iter().map(|point| inverse.sample(point.u)));
    }

    /// `f cos / E`: samples are in proportion to the reflected light.
    fn pdf(&self, wo: DVec3, wi: DVec3) -> f64 {
        let albedo = self.data.albedo(self.alpha, self.view(wo));
        if albedo > 0.0 { self.eval_cos(wo, wi) / albedo } else { 0.0 }
    }
}

/// The distribution of lights for one view: a marginal one of polar angles, one of azimuths for each of them.
struct Inverse<'a> {
    data: &'a TabulatedBrdf,
    wo: DVec3,
    /// The rows for the four nodes around roughness and view, with their weights: the first of `theta_i`.
    corners: [(usize, f64); 4],
    /// The integral over `phi` at each node of `theta_i`.
    rings: Vec<f64>,
    /// The light reflected below each node of `theta_i`, on one side.
    below: Vec<f64>,
}

impl<'a> Inverse<'a> {
    fn new(surface: &'a TabulatedSurface, wo: DVec3) -> Self {
        let data = &*surface.data;
        let ends = [surface.alpha.ends(), surface.view(wo).ends()];
        let corners = [(0, 0), (0, 1), (1, 0), (1, 1)].map(|(a, o)| {
            let ((alpha, of_alpha), (theta_o, of_view)) = (ends[0][a], ends[1][o]);
            (data.row(alpha, theta_o, 0), of_alpha * of_view)
        });
        let phis = data.axes().phi.len();
        let ring = |i: usize| corners.iter().map(|(row, weight)| weight * data.below[row + (i + 1) * phis - 1]).sum();
        let rings: Vec<f64> = (0..data.axes().theta_i.len()).map(ring).collect();
        let mut below = Vec::with_capacity(rings.len());
        below.push(0.0);
        below.extend(masses(&rings, &data.moments).scan(0.0, |sum, mass| {
            *sum += mass;
            Some(*sum)
        }));
        Self { data, wo, corners, rings, below }
    }

    fn sample(&self, u: [f64; 2]) -> BrdfSample {
        let total = self.below[self.below.len() - 1];
        let (theta, cell) = self.polar_angle(u[1] * total);
        // Both sides alike: a full turn of `u` goes from 0 to pi and back.
        let turn = 2.0 * u[0];
        let azimuth = if turn < 1.0 { self.azimuth(turn, cell) } else { -self.azimuth(2.0 - turn, cell) };
        let ((sin_theta, cos_theta), (sin_phi, cos_phi)) = (sin_cos(theta), sin_cos(azimuth));
        let along = (self.wo.x * self.wo.x + self.wo.y * self.wo.y).sqrt();
        let (x, y) = if along > 0.0 { (self.wo.x / along, self.wo.y / along) } else { (1.0, 0.0) };
        let wi =
            DVec3::new(sin_theta * (x * cos_phi - y * sin_phi), sin_theta * (y * cos_phi + x * sin_phi), cos_theta);
        let weight = if cos_theta > 0.0 { 2.0 * total } else { 0.0 };
        BrdfSample { wi, weight, cos_theta_d: cos_theta_d(self.wo, wi) }
    }

    /// The polar angle below which `wanted` is reflected on one side, and its place among the nodes. Newton's method on
    /// [`mass_below`], within bounds.
    fn polar_angle(&self, wanted: f64) -> (f64, Cell) {
        let nodes = &self.data.axes().theta_i;
        let next = self.below.partition_point(|below| *below <= wanted).clamp(1, nodes.len() - 1);
        let node = next - 1;
        let (low, width) = (nodes[node], nodes[next] - nodes[node]);
        let (rings, wanted) = ([self.rings[node], self.rings[next]], wanted - self.below[node]);
        let density = |x: f64| {
            let (sin, cos) = sin_cos(low + x);
            (rings[0] + (rings[1] - rings[0]) * x / width) * sin * cos
        };
        let (mut least, mut most) = (0.0, width);
        let mut x = linear_inverse(density(0.0), density(width), width, wanted);
        for _ in 0..STEPS {
            let over = mass_below(low, width, rings, x) - wanted;
            if over > 0.0 {
                most = x;
            } else {
                least = x;
            }
            let newton = x - over / density(x);
            let stepped = if newton >= least && newton <= most { newton } else { 0.5 * (least + most) };
            let step = (stepped - x).abs();
            x = stepped;
            if step <= SHORT_STEP * width {
                break;
            }
        }
        (low + x, Cell { node, next, part: x / width })
    }

    /// The azimuth from the view's, in [0, pi], below which a part of the ring's light is.
    fn azimuth(&self, part: f64, theta_i: Cell) -> f64 {
        let phi = &self.data.axes().phi;
        let blend = |numbers: &[f64], p: usize| -> f64 {
            let at = |i: usize| {
                self.corners.iter().map(|(row, weight)| weight * numbers[row + i * phi.len() + p]).sum::<f64>()
            };
            at(theta_i.node) * (1.0 - theta_i.part) + at(theta_i.next) * theta_i.part
        };
        let below = |p: usize| blend(&self.data.below, p);
        let wanted = part * below(phi.len() - 1);
        // The last node below which no more than that is: halving.
        let (mut node, mut end) = (0, phi.len() - 1);
        while end - node > 1 {
            let middle = usize::midpoint(node, end);
            if below(middle) <= wanted { node = middle } else { end = middle }
        }
        let (low, width) = (phi[node], phi[node + 1] - phi[node]);
        let ends = [blend(&self.data.values, node), blend(&self.data.values, node + 1)];
        (low + linear_inverse(ends[0], ends[1], width, wanted - below(node))).min(PI)
    }
}

/// Where a density that goes from `a` to `b` over `width` has `wanted` below: `a x + (b - a) x^2 / (2 width) = wanted`.
fn linear_inverse(a: f64, b: f64, width: f64, wanted: f64) -> f64 {
    let root = (a * a + 2.0 * (b - a) * wanted / width).max(0.0).sqrt();
    // Where both densities are zero nothing is wanted.
    (2.0 * wanted / (a + root).max(f64::MIN_POSITIVE)).clamp(0.0, width)
}
