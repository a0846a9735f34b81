//! The four axes of a table.

use glam::DVec3;
use serde::{Deserialize, Serialize};

use crate::fit::{brdf::Ggx, math::direction};

/// The smaller roughness is fitted as if it were at least this: of a lobe that is already a mirror's in one direction,
/// the other would be a line thinner than f32 directions are apart, and nothing could be interpolated.
pub const ALPHA_Y_FLOOR: f64 = 1e-5;

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
    /// Its surface, x along the larger roughness.
    #[must_use]
    pub fn surface(&self) -> Ggx {
        Ggx { alpha_x: self.alpha, alpha_y: (self.alpha * self.ratio).max(ALPHA_Y_FLOOR) }
    }

    /// Its view direction: unit length, exactly in a coordinate plane at `phi` of zero or pi/2.
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
