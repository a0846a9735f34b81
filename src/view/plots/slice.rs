//! The slice of a table's domain that an error plot shows.

use serde::Serialize;

/// The slice of the domain, over theta and alpha, that an error plot shows.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ErrorSlice {
    /// Smaller over larger roughness.
    pub ratio: f64,
    /// Azimuth of the view direction, radians.
    pub phi: f64,
}

/// The default azimuth is between the axes of a surface, where anisotropic surfaces differ most from isotropic
/// surfaces.
impl Default for ErrorSlice {
    fn default() -> Self {
        Self { ratio: 0.25, phi: 0.7 }
    }
}
