//! A surface of a tabulated BRDF, with a sampler that inverts its distribution exactly.

use std::{
    f64::consts::{PI, TAU},
    sync::Arc,
};

use glam::{DVec2, DVec3, Vec3Swizzles as _};

use super::{
    TabulatedAxes, TabulatedBrdf,
    grid::{Cell, Place, mass_below, masses},
};
use crate::{
    axes::LEAST_ALPHA,
    brdf::scattering::{Bends, Brdf, BrdfSample, cos_theta_d},
    math::{SquarePoint, atan2, sin_cos},
};

/// The largest number of Newton steps within an interval. Three or four are usually enough.
const STEPS: usize = 40;
/// The search ends when a step is shorter than this fraction of the interval.
const SHORT_STEP: f64 = 1e-13;

/// A surface of a tabulated BRDF.
#[derive(Debug, Clone)]
pub(crate) struct TabulatedSurface {
    data: Arc<TabulatedBrdf>,
    alpha: Cell,
    ratio: Cell,
    /// True if the larger roughness is along y. Files have it along x.
    is_swapped: bool,
}

impl TabulatedBrdf {
    /// The surface with these roughnesses along x and y. Roughnesses outside the range of the file are clamped to the
    /// range.
    pub(crate) fn surface(self: &Arc<Self>, [alpha_x, alpha_y]: [f64; 2]) -> TabulatedSurface {
        let axes = self.axes();
        let larger = alpha_x.max(alpha_y);
        let ratio = alpha_x.min(alpha_y) / larger.max(LEAST_ALPHA);
        TabulatedSurface {
            alpha: Cell::of(&axes.alpha, larger),
            ratio: Cell::of(&axes.ratio, ratio),
            is_swapped: !axes.is_isotropic() && alpha_y > alpha_x,
            data: Arc::clone(self),
        }
    }
}

/// The polar angle of a direction. It is accurate at the pole and at the horizon.
fn polar(w: DVec3) -> f64 {
    atan2((w.x * w.x + w.y * w.y).sqrt(), w.z)
}

/// The reflections that map a view of an anisotropic surface to the quadrant of the file's views.
#[derive(Debug, Clone, Copy)]
struct Mirrored {
    is_swapped: bool,
    signs: DVec3,
}

impl Mirrored {
    /// Converts a direction from the surface's frame to the file's frame.
    fn to_file(self, w: DVec3) -> DVec3 {
        (if self.is_swapped { w.yxz() } else { w }) * self.signs
    }

    /// Converts a direction from the file's frame to the surface's frame.
    fn to_surface(self, w: DVec3) -> DVec3 {
        let w = w * self.signs;
        if self.is_swapped { w.yxz() } else { w }
    }
}

impl TabulatedSurface {
    /// The reflections for a view. Isotropic surfaces need no reflections.
    fn mirrored(&self, wo: DVec3) -> Mirrored {
        let Self { is_swapped, .. } = *self;
        if self.data.axes().is_isotropic() {
            return Mirrored { is_swapped, signs: DVec3::ONE };
        }
        let sign = |x: f64| if x < 0.0 { -1.0 } else { 1.0 };
        let wo = if is_swapped { wo.yxz() } else { wo };
        Mirrored { is_swapped, signs: DVec3::new(sign(wo.x), sign(wo.y), 1.0) }
    }

    /// The position of a view on the file's axes.
    fn place(&self, wo: DVec3) -> Place {
        let axes = self.data.axes();
        // In a view along the normal, x can be a negative zero, for which `atan2` would return pi.
        let azimuth = || atan2(wo.y.abs(), wo.x.abs());
        let phi_o = if axes.is_isotropic() { Cell::at(0) } else { Cell::of(&axes.phi_o, azimuth()) };
        Place { alpha: self.alpha, ratio: self.ratio, theta_o: Cell::of(&axes.theta_o, polar(wo)), phi_o }
    }

    /// The azimuth of a light relative to a view, both in the file's frame.
    fn azimuth(&self, wo: DVec3, wi: DVec3) -> f64 {
        if self.data.axes().is_isotropic() {
            return atan2((wo.x * wi.y - wo.y * wi.x).abs(), wo.x * wi.x + wo.y * wi.y);
        }
        let along = along(wo);
        let apart = atan2(along.perp_dot(wi.xy()), along.dot(wi.xy()));
        if apart < 0.0 { apart + TAU } else { apart }
    }
}

/// The azimuth of a view as a unit vector in the xy plane; +x for a view along the normal.
fn along(wo: DVec3) -> DVec2 {
    let along = (wo.x * wo.x + wo.y * wo.y).sqrt();
    if along > 0.0 { DVec2::new(wo.x / along, wo.y / along) } else { DVec2::X }
}

impl Brdf for TabulatedSurface {
    fn eval_cos(&self, wo: DVec3, wi: DVec3) -> f64 {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return 0.0;
        }
        let mirrored = self.mirrored(wo);
        let [wo, wi] = [wo, wi].map(|w| mirrored.to_file(w));
        let axes = self.data.axes();
        let (theta_i, phi) = (Cell::of(&axes.theta_i, polar(wi)), Cell::of(&axes.phi, self.azimuth(wo, wi)));
        self.data.value(self.place(wo), theta_i, phi) * wi.z
    }

    /// The kinks are the nodes. The nodes of a whole turn of `phi` are symmetric, so the first half is enough.
    fn bends(&self, _: DVec3) -> Bends {
        let TabulatedAxes { theta_i, phi, .. } = self.data.axes();
        let half = phi.iter().copied().filter(|phi| *phi <= PI);
        Bends { theta_i: theta_i[1..theta_i.len() - 1].to_vec(), phi: half.collect() }
    }

    fn sample(&self, wo: DVec3, u: [f64; 2]) -> BrdfSample {
        Inverse::new(self, wo).sample(u)
    }

    fn sample_all(&self, wo: DVec3, points: &[SquarePoint], drawn: &mut Vec<BrdfSample>) {
        let inverse = Inverse::new(self, wo);
        drawn.extend(points.iter().map(|point| inverse.sample(point.u)));
    }

    /// `f cos / E`: the density is proportional to the reflected light.
    fn pdf(&self, wo: DVec3, wi: DVec3) -> f64 {
        let albedo = self.data.albedo(self.place(self.mirrored(wo).to_file(wo)));
        if albedo > 0.0 { self.eval_cos(wo, wi) / albedo } else { 0.0 }
    }
}

/// The distribution of light directions for one view: a marginal distribution of polar angles, and a distribution of
/// azimuths for each polar angle.
struct Inverse<'a> {
    data: &'a TabulatedBrdf,
    wo: DVec3,
    mirrored: Mirrored,
    /// For each node around surface and view: the index of its first row of values, and its weight.
    corners: Vec<(usize, f64)>,
    /// The integral over `phi` at each node of `theta_i`.
    rings: Vec<f64>,
    /// The light reflected at polar angles up to each node of `theta_i`; for isotropic surfaces, on one side only.
    below: Vec<f64>,
}

impl<'a> Inverse<'a> {
    fn new(surface: &'a TabulatedSurface, wo: DVec3) -> Self {
        let data = &*surface.data;
        let mirrored = surface.mirrored(wo);
        let place = surface.place(mirrored.to_file(wo));
        let corners: Vec<(usize, f64)> = data.views(place).map(|(view, weight)| (data.row(view, 0), weight)).collect();
        let phis = data.axes().phi.len();
        let ring = |i: usize| corners.iter().map(|(row, weight)| weight * data.below[row + (i + 1) * phis - 1]).sum();
        let rings: Vec<f64> = (0..data.axes().theta_i.len()).map(ring).collect();
        let mut below = Vec::with_capacity(rings.len());
        below.push(0.0);
        below.extend(masses(&rings, &data.moments).scan(0.0, |sum, mass| {
            *sum += mass;
            Some(*sum)
        }));
        Self { data, wo, mirrored, corners, rings, below }
    }

    fn sample(&self, u: [f64; 2]) -> BrdfSample {
        let total = self.below[self.below.len() - 1];
        let (theta, cell) = self.polar_angle(u[1] * total);
        let azimuth = if self.data.axes().is_isotropic() {
            // Both sides are equal: as `u` goes from 0 to 1, the azimuth goes from 0 to pi and back.
            let turn = 2.0 * u[0];
            if turn < 1.0 { self.azimuth(turn, cell) } else { -self.azimuth(2.0 - turn, cell) }
        } else {
            self.azimuth(u[0], cell)
        };
        let ((sin_theta, cos_theta), (sin_phi, cos_phi)) = (sin_cos(theta), sin_cos(azimuth));
        let DVec2 { x, y } = along(self.mirrored.to_file(self.wo));
        let of_file =
            DVec3::new(sin_theta * (x * cos_phi - y * sin_phi), sin_theta * (y * cos_phi + x * sin_phi), cos_theta);
        let wi = self.mirrored.to_surface(of_file);
        let weight = if cos_theta > 0.0 { self.data.axes().sides() * total } else { 0.0 };
        BrdfSample { wi, weight, cos_theta_d: cos_theta_d(self.wo, wi) }
    }

    /// The polar angle up to which the light `wanted` is reflected, counted as in `below`, and its position among the
    /// nodes. Solved with Newton's method on [`mass_below`], within bounds.
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

    /// The azimuth relative to the view, on the axis `phi`, below which the ring reflects the fraction `part` of its
    /// light.
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
        // Binary search for the last node with at most the wanted light below it.
        let (mut node, mut end) = (0, phi.len() - 1);
        while end - node > 1 {
            let middle = usize::midpoint(node, end);
            if below(middle) <= wanted { node = middle } else { end = middle }
        }
        let (low, width) = (phi[node], phi[node + 1] - phi[node]);
        let ends = [blend(&self.data.values, node), blend(&self.data.values, node + 1)];
        (low + linear_inverse(ends[0], ends[1], width, wanted - below(node))).min(phi[phi.len() - 1])
    }
}

/// Inverts the integral of a density that is linear from `a` to `b` over `width`:
/// `a x + (b - a) x^2 / (2 width) = wanted`.
fn linear_inverse(a: f64, b: f64, width: f64, wanted: f64) -> f64 {
    let root = (a * a + 2.0 * (b - a) * wanted / width).max(0.0).sqrt();
    // If both densities are zero, `wanted` is zero too.
    (2.0 * wanted / (a + root).max(f64::MIN_POSITIVE)).clamp(0.0, width)
}
