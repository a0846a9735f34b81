//! How many configurations are measured: as many as a fixed part of the fit's own time allows.

use crate::fit::{Recipe, fit_seconds};

/// Least configurations at nodes, and again between them.
const LEAST_POINTS: usize = 8;
/// Most configurations at nodes, and again between them.
pub const MOST_POINTS: usize = 1024;
/// The part of the fit's time that the report may take.
const SHARE: f64 = 0.2;
/// The time that one measurement takes, on the scale of [`fit_seconds`].
const POINT_SECONDS: f64 = 1.8e-3;

/// How many nodes, and how many configurations between nodes, the table of a recipe is measured at.
#[must_use]
pub fn report_points(recipe: &Recipe) -> usize {
    let points = SHARE * fit_seconds(recipe) / POINT_SECONDS;
    ((0.5 * points) as usize).clamp(LEAST_POINTS, MOST_POINTS)
}
