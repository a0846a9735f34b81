//! The four axes along which a lobe changes: two of the surface, two of the view.

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::math::direction;

/// The least roughness along either axis. Below it a lobe is thinner than the distance between neighbouring f32
/// directions, and cannot be interpolated. A lookup raises both roughnesses to it before it takes their ratio, so that
/// mirrors stay isotropic.
pub const LEAST_ALPHA: f64 = 1e-5;

/// One value for each axis of a table, in the order in which entries are stored: `phi` varies fastest.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PerAxis<T> {
    /// Larger roughness, GGX alpha.
    pub alpha: T,
    /// Smaller over larger roughness.
    pub ratio: T,
    /// Polar angle of the view direction, radians.
    pub theta: T,
    /// Azimuth of the view direction, radians.
    pub phi: T,
}

impl<T> PerAxis<T> {
    /// The four values with their axes' names, in storage order.
    pub fn named(&self) -> [(&'static str, &T); 4] {
        [("alpha", &self.alpha), ("ratio", &self.ratio), ("theta", &self.theta), ("phi", &self.phi)]
    }
}

/// A place in the space that a table covers.
impl PerAxis<f64> {
    /// The roughness along x, which is the larger one, and along y, which is at least [`LEAST_ALPHA`].
    #[must_use]
    pub fn roughness(&self) -> [f64; 2] {
        [self.alpha, (self.alpha * self.ratio).max(LEAST_ALPHA)]
    }

    /// The view direction: unit length, exactly in a coordinate plane at `phi` of zero or pi/2.
    #[must_use]
    pub fn view(&self) -> DVec3 {
        direction(self.theta, self.phi)
    }
}

impl<T> PerAxis<Vec<T>> {
    /// Nodes on each axis.
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
