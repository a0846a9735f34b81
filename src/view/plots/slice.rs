//! The slice of a table's domain that an error plot shows.

use serde::Serialize;

/// The slice that an error plot shows: all theta and alpha at one ratio and phi.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ErrorSlice {
    /// The smaller roughness divided by the larger.
    pub ratio: f64,
    /// Azimuth of the view direction, radians.
    pub phi: f64,
}

/// The default azimuth is halfway between the axes of a surface, where anisotropic surfaces differ most from isotropic
/// surfaces.
impl Default for ErrorSlice {
    fn default() -> Self {
        Self { ratio: 0.25, phi: 0.7 }
    }
}
