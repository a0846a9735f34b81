//! A row of the trade-off: a recipe, its cost and its error.

use serde::Serialize;

use super::{Fronts, front};
use ltcforge_files::{
    digest::Digest,
    recipe_document::{self, Preset},
};
use ltcforge_fit::{Expectation, Layout, PerAxis, Precision, Recipe, Spread, expectation};

/// The number of configurations at which each table is measured: this many at nodes, and this many between nodes.
pub const POINTS: usize = 512;

/// The measurements of a recipe's table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measurement {
    /// Processor time of the fit over all threads, in seconds.
    pub processor_seconds: f64,
    /// Wall-clock time, in seconds.
    pub wall_seconds: f64,
    /// Error between nodes, relative to the lobe's width.
    pub width: Spread,
    /// Error between nodes: the sliced Wasserstein distance.
    pub sw1: Spread,
    /// Absolute error of the reflected energy of random lights. All models are measured with the same lights.
    pub light: Spread,
    /// Bytes of the compact form, if the table has one.
    pub compact_bytes: Option<u64>,
}

/// A row of the trade-off.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FittedRecipe {
    /// The recipe's digest.
    pub recipe_digest: Digest,
    /// The preset with this effort. `None` if the row's layout, resolution or precision differs from the base recipe.
    pub preset: Option<&'static str>,
    /// Layout.
    pub layout: Layout,
    /// Number of nodes on each axis.
    pub resolution: PerAxis<u32>,
    /// Samples of the LTC per entry.
    pub samples: u32,
    /// Directions.
    pub directions: u32,
    /// Largest number of steps of the solver.
    pub steps: u32,
    /// Number format.
    pub precision: Precision,
    /// Entries of the table.
    pub entries: u64,
    /// Size of the matrices and terms in bytes.
    pub bytes: u64,
    /// Size of the compact form in bytes, if there is one. A decoder rebuilds the table from the compact form.
    pub compact_bytes: Option<u64>,
    /// Processor time of the fit divided by the number of threads. It is the duration of the fit if each thread has its
    /// own core.
    pub seconds: f64,
    /// Wall-clock time. It depends on the load of the machine.
    pub wall_seconds: f64,
    /// Mean error between nodes, relative to the lobe's width. The fronts use this error.
    pub error_mean: f64,
    /// 95th percentile of the error between nodes.
    pub error_p95: f64,
    /// Mean sliced Wasserstein distance between nodes.
    pub sw1_mean: f64,
    /// 95th percentile of the sliced Wasserstein distance.
    pub sw1_p95: f64,
    /// Mean absolute error of the reflected energy of random lights.
    pub light_mean: f64,
    /// 95th percentile of the light's error.
    pub light_p95: f64,
    /// The prediction of `seconds`.
    pub predicted_seconds: f64,
    /// The prediction of `error_mean`.
    pub predicted_error: f64,
    /// The Pareto fronts that contain the row.
    pub on_front: Fronts,
}

/// The rows for a family that was fitted on `threads` threads, in the order of the family.
#[must_use]
pub fn rows(base: &Recipe, fitted: &[(Recipe, Measurement)], threads: usize) -> Vec<FittedRecipe> {
    let mut rows: Vec<FittedRecipe> =
        fitted.iter().map(|(recipe, measured)| row(base, recipe, measured, threads)).collect();
    let [mut seconds, mut bytes, mut at_base] = [const { Vec::new() }; 3];
    for row in &rows {
        seconds.push([row.seconds, row.error_mean]);
        bytes.push([row.bytes as f64, row.error_mean]);
        if is_base(base, row) {
            at_base.push([row.seconds, row.error_mean]);
        }
    }
    let (seconds, bytes, mut at_base) = (front(&seconds), front(&bytes), front(&at_base).into_iter());
    for ((row, seconds), bytes) in rows.iter_mut().zip(seconds).zip(bytes) {
        let is_on_base_front = is_base(base, row) && at_base.next().unwrap_or(false);
        row.on_front = Fronts { seconds, bytes, base: is_on_base_front };
    }
    rows
}

/// Whether a row differs from the base recipe only in effort.
fn is_base(base: &Recipe, row: &FittedRecipe) -> bool {
    (row.layout, row.resolution, row.precision) == (base.layout, base.resolution, base.precision)
}

fn row(base: &Recipe, recipe: &Recipe, measured: &Measurement, threads: usize) -> FittedRecipe {
    let Expectation { seconds, error, .. } = expectation(recipe);
    let effort = |of: &ltcforge_fit::FitSettings| (of.samples, of.directions, of.steps);
    let has_effort = |preset: &Preset| effort(&preset.fit()) == effort(&recipe.fit);
    let number_bytes = match recipe.precision {
        Precision::F32 => 4,
        Precision::F16 => 2,
    };
    let mut row = FittedRecipe {
        recipe_digest: recipe_document::digest(recipe),
        preset: None,
        layout: recipe.layout,
        resolution: recipe.resolution,
        samples: recipe.fit.samples,
        directions: recipe.fit.directions,
        steps: recipe.fit.steps,
        precision: recipe.precision,
        entries: recipe.entries(),
        bytes: recipe.entries() * recipe.entry_numbers() * number_bytes,
        compact_bytes: measured.compact_bytes,
        seconds: measured.processor_seconds / threads as f64,
        wall_seconds: measured.wall_seconds,
        error_mean: measured.width.mean,
        error_p95: measured.width.p95,
        sw1_mean: measured.sw1.mean,
        sw1_p95: measured.sw1.p95,
        light_mean: measured.light.mean,
        light_p95: measured.light.p95,
        predicted_seconds: seconds / threads as f64,
        predicted_error: error,
        on_front: Fronts { seconds: false, bytes: false, base: false },
    };
    if is_base(base, &row) {
        row.preset = Preset::ALL.into_iter().find(has_effort).map(Preset::name);
    }
    row
}
