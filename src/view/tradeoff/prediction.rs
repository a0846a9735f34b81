//! The accuracy of predictions.

use serde::Serialize;

use super::FittedRecipe;

/// The quotients of measured over predicted values: least, median and greatest.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct OffBy {
    /// The quotients of seconds. Their common factor is the machine's speed.
    pub seconds: [f64; 3],
    /// The quotients of mean errors.
    pub error: [f64; 3],
}

/// The quotients of the predictions of `rows`. Domain: at least one row.
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
