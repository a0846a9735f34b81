//! A table at any configuration.

use super::Table;

/// A material and a view direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Configuration {
    /// Roughness along x.
    pub alpha_x: f64,
    /// Roughness along y.
    pub alpha_y: f64,
    /// Polar angle of the view direction, radians.
    pub theta: f64,
    /// Its azimuth, radians.
    pub phi: f64,
}

/// What a table holds for a configuration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LookedUp {
    /// `M`, row-major.
    pub matrix: [f64; 9],
    /// Amplitude, where the table has terms.
    pub amplitude: Option<f64>,
    /// Fresnel term, where the table has terms.
    pub fresnel: Option<f64>,
}

impl Table {
    /// What the table holds for `configuration`.
    #[must_use]
    pub fn lookup(&self, _configuration: &Configuration) -> LookedUp {
        todo!()
    }
}
