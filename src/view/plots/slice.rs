//! Where the errors of a table are cut.

use serde::Serialize;

use super::error;
use ltcforge_fit::{GoOn, Table};

/// Where the domain is cut.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ErrorSlice {
    /// Smaller over larger roughness.
    pub ratio: f64,
    /// Azimuth of the view direction, radians.
    pub phi: f64,
}

impl ErrorSlice {
    /// The errors of a table there as JSON: `alpha` and `theta` of 40 rows and columns, `width` and `light` row by row from the
    /// smoothest surface. `None` as soon as `go_on`, which is asked before each configuration, says no.
    #[must_use]
    pub fn numbers_while(&self, go_on: &GoOn, table: &Table) -> Option<String> {
        error::numbers_while(go_on, table, *self)
    }
}

/// Between the axes of a surface, where an anisotropic one differs most from an isotropic one.
impl Default for ErrorSlice {
    fn default() -> Self {
        Self { ratio: 0.25, phi: 0.7 }
    }
}
