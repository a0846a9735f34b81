//! Symmetries of the lobes of axis-aligned surfaces.

use glam::DVec3;

/// Mirror symmetries of a lobe and of its distribution.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Mirrors {
    /// Symmetric under x -> -x: the view direction lies in the yz plane.
    pub x: bool,
    /// Symmetric under y -> -y: the view direction lies in the xz plane.
    pub y: bool,
}

impl Mirrors {
    /// The symmetries of the lobe of an anisotropic, axis-aligned surface seen from `wo`.
    #[must_use]
    pub fn of(wo: DVec3) -> Self {
        Self { x: wo.x == 0.0, y: wo.y == 0.0 }
    }
}
