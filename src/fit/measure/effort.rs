//! Chooses the number of measured configurations: in proportion to the fit's time, within limits. More configurations
//! are measured between nodes than at nodes, because a few large errors between nodes change the mean strongly.

use crate::{Recipe, fit_seconds};

/// The smallest number of configurations at nodes, and of configurations between nodes.
const LEAST_POINTS: usize = 8;
/// The largest number of configurations at nodes, and of configurations between nodes.
pub const MOST_POINTS: usize = 1024;
/// The fraction of the fit's time for measuring at nodes, and the smallest fraction for measuring between nodes.
const SHARE: f64 = 0.1;
/// The fraction of the fit's time for measuring between nodes, up to [`STEADY`] configurations.
const SHARE_BETWEEN: f64 = 0.25;
/// The time of one measurement, in the unit of [`fit_seconds`].
const POINT_SECONDS: f64 = 1.8e-3;
/// The number of configurations between nodes that gives a steady mean. In an isotropic table of 64 x 64 lobes, a few
/// lobes near the smallest roughness have errors of several widths. The mean is 0.079 with 68 configurations, 0.047
/// with 512, 0.039 with 4096.
const STEADY: usize = 512;

/// The number of configurations at which a table is measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ReportPoints {
    /// The largest number of nodes.
    pub nodes: usize,
    /// The number of configurations between nodes.
    pub between: usize,
}

impl From<usize> for ReportPoints {
    /// The same number for nodes and for configurations between nodes.
    fn from(points: usize) -> Self {
        Self { nodes: points, between: points }
    }
}

/// The number of nodes and of configurations between nodes at which the table of a recipe is measured.
#[must_use]
pub fn report_points(recipe: &Recipe) -> ReportPoints {
    let points = fit_seconds(recipe) / POINT_SECONDS;
    let nodes = ((SHARE * points) as usize).clamp(LEAST_POINTS, MOST_POINTS);
    ReportPoints { nodes, between: ((SHARE_BETWEEN * points) as usize).min(STEADY).max(nodes) }
}
