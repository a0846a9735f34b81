//! How many configurations are measured: as many as a fixed part of the fit's own time allows, and more between nodes
//! than at them, because there a few bad ones count for much.

use crate::{Recipe, fit_seconds};

/// Least configurations at nodes, and again between them.
const LEAST_POINTS: usize = 8;
/// Most configurations at nodes, and again between them.
pub const MOST_POINTS: usize = 1024;
/// The part of the fit's time that measuring nodes may take, and as much again between them.
const SHARE: f64 = 0.1;
/// The part of the fit's time that measuring between nodes may take, up to [`STEADY`] configurations.
const SHARE_BETWEEN: f64 = 0.25;
/// The time that one measurement takes, on the scale of [`fit_seconds`].
const POINT_SECONDS: f64 = 1.8e-3;
/// Configurations between nodes whose mean is worth stating beside a table. Of the 64 x 64 lobes of an isotropic table
/// a few next to the mirror miss by several widths: the mean is 0.079 at 68 configurations, 0.047 at 512, 0.039
/// at 4096.
const STEADY: usize = 512;

/// How many configurations a table is measured at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ReportPoints {
    /// At most this many nodes.
    pub nodes: usize,
    /// This many configurations between nodes.
    pub between: usize,
}

impl From<usize> for ReportPoints {
    /// As many of both.
    fn from(points: usize) -> Self {
        Self { nodes: points, between: points }
    }
}

/// How many nodes, and how many configurations between nodes, the table of a recipe is measured at.
#[must_use]
pub fn report_points(recipe: &Recipe) -> ReportPoints {
    let points = fit_seconds(recipe) / POINT_SECONDS;
    let nodes = ((SHARE * points) as usize).clamp(LEAST_POINTS, MOST_POINTS);
    ReportPoints { nodes, between: ((SHARE_BETWEEN * points) as usize).min(STEADY).max(nodes) }
}
