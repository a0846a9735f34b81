//! The four axes of a table: two for the roughness of the surface, two for the view direction.

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::math::direction;

/// The smallest roughness along either axis. The lobe of a smoother surface is thinner than the distance between
/// neighbouring f32 directions, so it cannot be interpolated. A lookup raises both roughnesses to this value before it
/// divides them, so a mirror remains isotropic.
pub const LEAST_ALPHA: f64 = 1e-5;

/// A value for each axis of a table, in storage order of entries: `phi` varies fastest.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PerAxis<T> {
    /// Larger roughness, GGX alpha.
    pub alpha: T,
    /// Smaller roughness divided by larger roughness.
    pub ratio: T,
    /// Polar angle of the view direction, radians.
    pub theta: T,
    /// Azimuth of the view direction, radians.
    pub phi: T,
}

impl<T> PerAxis<T> {
    /// The four values with the names of their axes, in storage order.
    pub fn named(&self) -> [(&'static str, &T); 4] {
        [("alpha", &self.alpha), ("ratio", &self.ratio), ("theta", &self.theta), ("phi", &self.phi)]
    }
}

/// A point in the domain of a table.
impl PerAxis<f64> {
    /// The roughness along x (the larger one) and along y (at least [`LEAST_ALPHA`]).
    #[must_use]
    pub fn roughness(&self) -> [f64; 2] {
        [self.alpha, (self.alpha * self.ratio).max(LEAST_ALPHA)]
    }

    /// The view direction, of unit length. It lies exactly in a coordinate plane if `phi` is zero or pi/2.
    #[must_use]
    pub fn view(&self) -> DVec3 {
        direction(self.theta, self.phi)
    }
}

impl<T> PerAxis<Vec<T>> {
    /// The number of nodes on each axis.
    #[must_use]
    pub fn lengths(&self) -> PerAxis<usize> {
        PerAxis { alpha: self.alpha.len(), ratio: self.ratio.len(), theta: self.theta.len(), phi: self.phi.len() }
    }
}

impl PerAxis<Vec<f64>> {
    /// The node at `index` in storage order. Domain: `index` below the product of the lengths.
    #[must_use]
    pub fn node(&self, index: usize) -> PerAxis<f64> {
        let PerAxis { ratio, theta, phi, .. } = self.lengths();
        let row = index / phi;
        PerAxis {
            alpha: self.alpha[row / theta / ratio],
            ratio: self.ratio[row / theta % ratio],
            theta: self.theta[row % theta],
            phi: self.phi[index % phi],
        }
    }
}
