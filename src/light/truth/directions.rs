//! Integrates broad lobes directly over the directions of light.

use std::f64::consts::PI;

use glam::DVec3;

use super::space::{SHORT, Space, Weight};
use ltcforge_fit::{
    brdf::{Bends, Brdf, cos_theta_d},
    math::{cos, sin_cos},
};

/// The length of a part of an outline, in mean distances between kinks. The 15 rays over a part then include a ray
/// between neighbouring kinks.
const BENDS_A_PART: f64 = 9.0;
/// The smallest length of a part, in radians, for any distance between kinks.
const LEAST_PART: f64 = PI / 90.0;
/// Kinks of a ray closer than this are merged.
const SAME: f64 = 1e-9;

/// A lobe over directions of light. It has kinks on cones around the surface normal and on planes through the normal.
pub(super) struct Directions<'a> {
    brdf: &'a dyn Brdf,
    wo: DVec3,
    /// Squared cosines of the cones' angles, and normals of the planes.
    cones: Vec<f64>,
    planes: Vec<DVec3>,
    short: f64,
    weight: Weight,
}

impl<'a> Directions<'a> {
    pub(super) fn new(brdf: &'a dyn Brdf, wo: DVec3, weight: Weight) -> Self {
        let Bends { theta_i, phi } = brdf.bends(wo);
        // Nodes are dense towards the horizon, where rays cross them in any case. So the mean distance counts.
        let apart = |angles: &[f64]| match angles {
            [first, .., last] => (last - first) / (angles.len() - 1) as f64,
            _ => f64::INFINITY,
        };
        let part = (BENDS_A_PART * apart(&theta_i).min(apart(&phi))).clamp(LEAST_PART, 1.0);
        let along = DVec3::new(wo.x, wo.y, 0.0).try_normalize().unwrap_or(DVec3::X);
        let across = DVec3::Z.cross(along);
        let plane = |angle: &f64| {
            let (sin, cos) = sin_cos(*angle);
            [across * cos - along * sin, across * cos + along * sin]
        };
        Self {
            brdf,
            wo,
            cones: theta_i.iter().map(|angle| cos(*angle) * cos(*angle)).collect(),
            planes: phi.iter().flat_map(plane).collect(),
            short: cos(part).max(SHORT),
            weight,
        }
    }
}

impl Space for Directions<'_> {
    fn image(&self, w: DVec3) -> DVec3 {
        w
    }

    fn turning_image(&self, w: DVec3, turning: DVec3) -> (DVec3, DVec3) {
        (w, turning)
    }

    fn density(&self, c: DVec3) -> [f64; 2] {
        self.weight.weighted(self.brdf.eval_cos(self.wo, c), cos_theta_d(self.wo, c))
    }

    fn weight(&self) -> Weight {
        self.weight
    }

    fn brdf_and_view(&self) -> (&dyn Brdf, DVec3) {
        (self.brdf, self.wo)
    }

    fn short(&self) -> f64 {
        self.short
    }

    /// A plane cuts the ray where its normal is perpendicular to the point. A cone cuts it where `p_z^2 = cos^2 |p|^2`.
    fn bends(&self, from: DVec3, to: DVec3) -> Vec<f64> {
        let by = to - from;
        let of_plane = |normal: &DVec3| {
            let [at, change] = [from, by].map(|v| normal.dot(v));
            -at / change
        };
        let of_cone = |cosine2: &f64| {
            let product = |a: DVec3, b: DVec3| a.z * b.z - cosine2 * a.dot(b);
            let (square, half, rest) = (product(by, by), product(from, by), product(from, from));
            let root = (half * half - square * rest).sqrt();
            // This form has no cancellation in either root.
            let larger = if half < 0.0 { root - half } else { -root - half };
            [larger / square, rest / larger]
        };
        let cuts = self.planes.iter().map(of_plane).chain(self.cones.iter().flat_map(of_cone));
        // A kink that does not cut the ray gives infinity or NaN.
        let mut bends: Vec<f64> = cuts.filter(|s| *s > SAME && *s < 1.0 - SAME).collect();
        bends.sort_by(f64::total_cmp);
        bends.dedup_by(|next, last| *next - *last < SAME);
        bends
    }
}
