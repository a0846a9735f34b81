//! Samples directions for broad lobes, with a mix of a uniform and a cosine distribution.

use std::f64::consts::PI;

use glam::DVec3;

use crate::math::SquarePoint;

/// The density `(u + 2 (1 - u) cos(theta)) / (2 pi)` over the hemisphere, per steradian. A fraction `u` of the
/// directions is uniform, and the rest follow the cosine.
///
/// Diffuse lobes have more light near the horizon than a cosine lobe has. The uniform part keeps the weights of these
/// directions bounded.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Hemisphere {
    /// The uniform part, in [0, 1].
    pub(super) uniform: f64,
}

impl Hemisphere {
    /// Draws a direction. The height `z` inverts the cumulative distribution: `u z + (1 - u) z^2 = u_1`.
    pub(super) fn sample(self, point: &SquarePoint) -> DVec3 {
        let (uniform, below) = (self.uniform, point.u[1]);
        let root = (uniform * uniform + 4.0 * (1.0 - uniform) * below).sqrt();
        // Without a uniform part, the direction at the horizon would be computed as 0 / 0.
        let z = (2.0 * below / (uniform + root).max(f64::MIN_POSITIVE)).min(1.0);
        let radius = ((1.0 - z) * (1.0 + z)).sqrt();
        DVec3::new(radius * point.cos, radius * point.sin, z)
    }

    /// The density of [`Hemisphere::sample`]; zero below the horizon.
    pub(super) fn pdf(self, wi: DVec3) -> f64 {
        if wi.z < 0.0 {
            return 0.0;
        }
        (self.uniform + 2.0 * (1.0 - self.uniform) * wi.z) / (2.0 * PI)
    }
}
