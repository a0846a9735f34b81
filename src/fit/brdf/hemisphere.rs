//! Directions for broad lobes: uniform on the hemisphere, cosine-distributed, and all between.

use std::f64::consts::PI;

use glam::DVec3;

use crate::math::SquarePoint;

/// The density `(u + 2 (1 - u) cos(theta)) / (2 pi)` over the hemisphere, per steradian: a part `u` of all directions
/// is uniform, the others follow the cosine.
///
/// Diffuse lobes near the horizon have more light at low directions than a cosine has; the uniform part keeps their
/// weights bounded.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Hemisphere {
    /// The uniform part, in [0, 1].
    pub(super) uniform: f64,
}

impl Hemisphere {
    /// A direction, by the height below which a part `u_1` of all directions is: `u z + (1 - u) z^2 = u_1`.
    pub(super) fn sample(self, point: &SquarePoint) -> DVec3 {
        let (uniform, below) = (self.uniform, point.u[1]);
        let root = (uniform * uniform + 4.0 * (1.0 - uniform) * below).sqrt();
        // Without uniform part the lowest direction of all would be 0 / 0.
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
