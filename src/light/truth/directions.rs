//! Broad lobes, among the directions of light themselves.

use std::f64::consts::PI;

use glam::DVec3;

use super::space::{SHORT, Space, Weight};
use ltcforge_fit::{
    brdf::{Bends, Brdf, cos_theta_d},
    math::{cos, sin_cos},
};

/// A part of an outline spans at most so many bends at their mean distance: its rule of 15 points then has a ray
/// between two.
const BENDS_A_PART: f64 = 9.0;
/// Parts are not made shorter than this, radians, however near bends are to each other.
const LEAST_PART: f64 = PI / 90.0;
/// Two bends of a ray that are nearer are one.
const SAME: f64 = 1e-9;

/// A lobe among directions of light. It bends on cones around the surface's normal and on planes through it.
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
        // Nodes crowd towards the horizon, where rays cross them anyhow: their mean distance counts.
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
        self.weight.beside(self.brdf.eval_cos(self.wo, c), cos_theta_d(self.wo, c))
    }

    fn weight(&self) -> Weight {
        self.weight
    }

    fn seen(&self) -> (&dyn Brdf, DVec3) {
        (self.brdf, self.wo)
    }

    fn short(&self) -> f64 {
        self.short
    }

    /// A plane's normal is perpendicular to the ray where that is cut; a cone cuts it where `p_z^2 = cos^2 |p|^2`.
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
            // Neither cancels.
            let larger = if half < 0.0 { root - half } else { -root - half };
            [larger / square, rest / larger]
        };
        let cuts = self.planes.iter().map(of_plane).chain(self.cones.iter().flat_map(of_cone));
        // A bend that does not cut the ray is infinite or NaN.
        let mut bends: Vec<f64> = cuts.filter(|s| *s > SAME && *s < 1.0 - SAME).collect();
        bends.sort_by(f64::total_cmp);
        bends.dedup_by(|next, last| *next - *last < SAME);
        bends
    }
}
