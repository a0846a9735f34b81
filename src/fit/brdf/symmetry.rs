//! Symmetries that the lobes of axis-aligned surfaces have.

use glam::DVec3;

/// Mirror symmetries of a lobe, which its distribution shares.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Mirrors {
    /// Unchanged by x -> -x: the view direction lies in the yz plane.
    pub x: bool,
    /// Unchanged by y -> -y: the view direction lies in the xz plane.
    pub y: bool,
}

impl Mirrors {
    /// The symmetries of the lobe of an anisotropic, axis-aligned surface seen from `wo`.
    #[must_use]
    pub fn of(wo: DVec3) -> Self {
        Self { x: wo.x == 0.0, y: wo.y == 0.0 }
    }
}
