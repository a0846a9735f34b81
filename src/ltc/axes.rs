//! The four axes of a table.

use serde::{Deserialize, Serialize};

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

impl<T> PerAxis<Vec<T>> {
    /// Nodes on each axis.
    #[must_use]
    pub fn lengths(&self) -> PerAxis<usize> {
        PerAxis { alpha: self.alpha.len(), ratio: self.ratio.len(), theta: self.theta.len(), phi: self.phi.len() }
    }
}
