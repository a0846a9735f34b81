//! Where the errors of a table are cut.

use serde::Serialize;

/// Where the domain is cut.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ErrorSlice {
    /// Smaller over larger roughness.
    pub ratio: f64,
    /// Azimuth of the view direction, radians.
    pub phi: f64,
}

/// Between the axes of a surface, where an anisotropic one differs most from an isotropic one.
impl Default for ErrorSlice {
    fn default() -> Self {
        Self { ratio: 0.25, phi: 0.7 }
    }
}
