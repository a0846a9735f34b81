//! The accuracy of predictions.

use serde::Serialize;

use super::FittedRecipe;

/// The ratios of measured to predicted values: least, median and greatest.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct OffBy {
    /// The ratios of seconds. All have the machine's speed as a factor.
    pub seconds: [f64; 3],
    /// The ratios of mean errors.
    pub error: [f64; 3],
}

/// The ratios for the predictions of `rows`. Domain: at least one row.
#[must_use]
pub fn off_by(rows: &[FittedRecipe]) -> OffBy {
    let spread = |ratio: fn(&FittedRecipe) -> f64| {
        let mut ratios: Vec<f64> = rows.iter().map(ratio).collect();
        ratios.sort_by(f64::total_cmp);
        [ratios[0], ratios[ratios.len() / 2], ratios[ratios.len() - 1]]
    };
    OffBy {
        seconds: spread(|row| row.seconds / row.predicted_seconds),
        error: spread(|row| row.error_mean / row.predicted_error),
    }
}
