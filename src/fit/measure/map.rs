//! Maps of errors over roughness and view angle.

use std::f64::consts::PI;

use super::{
    figures::{self, Figures, GoOn},
    places,
};
use crate::{Configuration, Table};

/// Errors over a square of configurations, at the centres of its cells.
#[derive(Debug, Clone, PartialEq)]
pub struct ErrorMap {
    /// Smaller divided by larger roughness, for all configurations.
    pub ratio: f64,
    /// Azimuth of the view direction, for all configurations, radians, in [0, pi/2].
    pub phi: f64,
    /// The number of cells on each side.
    pub cells: usize,
    /// The range of the rows: the square root of alpha, ascending.
    pub roughness: [f64; 2],
    /// The range of the columns: the polar angle of the view direction, radians.
    pub theta: [f64; 2],
    /// Distance between lobe and LTC relative to the lobe's width, row by row from the smoothest.
    pub width: Vec<f64>,
    /// Mean absolute error of the fraction of the lobe's energy that a few square lights cover, row by row from the
    /// smoothest.
    pub light: Vec<f64>,
}

/// Measures a table at `cells` by `cells` configurations of one `ratio` and `phi`. Ratio and phi are clamped to the
/// ranges of the table's axes. Runs on the current rayon pool. The size of the pool does not change the result. Returns
/// `None` if `go_on`, called before each configuration, returns false.
///
/// Domain: a table with at least one node on each axis, finite numbers.
#[must_use]
pub fn error_map_while(go_on: &GoOn, table: &Table, ratio: f64, phi: f64, cells: usize) -> Option<ErrorMap> {
    let axes = &table.axes;
    let within = |x: f64, nodes: &[f64]| {
        let [low, high] = places::extent(nodes);
        x.clamp(low, high)
    };
    let ratio = within(ratio, &axes.ratio);
    // The lobes at phi, -phi and pi - phi are mirror images of each other.
    let turned = phi.rem_euclid(PI);
    let phi = within(turned.min(PI - turned), &axes.phi);
    let (roughness, theta) = places::roughness_and_theta(axes);
    let middle = |[low, high]: [f64; 2], i: usize| low + (high - low) * (i as f64 + 0.5) / cells as f64;
    let places: Vec<Configuration> = (0..cells * cells)
        .map(|index| {
            let roughness = middle(roughness, index / cells);
            places::configuration(roughness * roughness, ratio, middle(theta, index % cells), phi)
        })
        .collect();
    let figures = figures::all_while(go_on, table, &places)?;
    let all = |error: fn(&Figures) -> f64| figures.iter().map(error).collect();
    Some(ErrorMap { ratio, phi, cells, roughness, theta, width: all(|f| f.width), light: all(|f| f.light) })
}
