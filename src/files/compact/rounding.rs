//! The steps to which a table's numbers are rounded, and the places where a rounded sum is corrected.
//!
//! Measured on tables of the presets and of 64 x 64 nodes in layouts `reflected` and `ltc2017`: the mean error between
//! nodes grows by less than 1 %. For tables where it grows by more, steps become finer.

use super::{decoder::CHANNELS, header::TERMS};
use ltcforge_fit::{ALPHA_FLOOR, Reflection, THETA_CEILING, Table};

/// The factor by which each channel's step is finer: how far the lobe moves, in widths, per change of the number. For
/// the terms, the factor follows from their small errors.
const WEIGHTS: [f64; CHANNELS] = [1.5, 1.3, 1.3, 5.0, 4.0, 1.0, 1.0, 45.0, 45.0];
/// The step of a number, as the fraction of its width by which the lobe moves, and the unit of corrections in steps.
const ANISOTROPIC: (f64, f32) = (0.015, 8.0);
/// Like [`ANISOTROPIC`], for tables of isotropic surfaces, which have fewer numbers and finer nodes.
const ISOTROPIC: (f64, f32) = (0.007, 8.0);
/// Like [`ANISOTROPIC`], for tables whose numbers minimise the error between nodes.
const CHOSEN: (f64, f32) = (0.015, 0.25);
/// The factor by which the terms of [`CHOSEN`] tables are rounded more coarsely.
const CHOSEN_TERMS: f64 = 1.75;
/// The number of rows of [`CHOSEN`] tables whose numbers differ most from those of their own lobes. These rows have the
/// smallest roughness.
const MIRROR_ROWS: usize = 2;
/// The distance from the median of its neighbourhood, in steps, above which a number is left to corrections.
const OUTLIER: f64 = 8.0;
/// The largest error of a Fresnel term that is not corrected, in steps.
const UNSEEN: f64 = 0.08;

/// The factor by which steps become finer.
const FINER: f64 = 0.8;

/// The rounding of a table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Rounding {
    pub(super) part_of_width: f64,
    pub(super) correction_steps: f32,
    /// Whether the numbers minimise the error between nodes. Then the numbers of the smallest roughness and at the
    /// horizon depend more on their neighbours than on their own lobes.
    is_chosen: bool,
}

impl Rounding {
    pub(super) fn of(table: &Table) -> Self {
        let lengths = table.axes().lengths();
        let is_chosen = table.layout().free_numbers().is_some()
            && lengths.alpha > MIRROR_ROWS
            && lengths.theta > 1
            && lengths.ratio * lengths.phi == 1;
        let (part_of_width, correction_steps) = match () {
            () if is_chosen => CHOSEN,
            () if table.serves_every_phi() => ISOTROPIC,
            () => ANISOTROPIC,
        };
        Self { part_of_width, correction_steps, is_chosen }
    }

    /// The same rounding with finer steps.
    pub(super) fn finer(self) -> Self {
        Self { part_of_width: FINER * self.part_of_width, ..self }
    }

    /// The step of a channel.
    pub(super) fn step(self, channel: usize) -> f64 {
        let coarser = if self.is_chosen && TERMS.contains(&channel) { CHOSEN_TERMS } else { 1.0 };
        self.part_of_width * coarser / WEIGHTS[channel]
    }

    /// The numbers that polynomials should follow, for a channel with this step. If the numbers minimise the error
    /// between nodes, neighbours replace the numbers of the smallest roughness and at the horizon, and corrections
    /// restore them. Outliers of such tables are replaced too, because polynomials would bend all numbers around them.
    pub(super) fn smoothed(self, table: &Table, step: f64, mut exact: Vec<f64>) -> Vec<f64> {
        if self.is_chosen {
            let columns = table.axes().theta.len();
            for row in exact.chunks_exact_mut(columns) {
                row[columns - 1] = row[columns - 2];
            }
            let (mirror, rest) = exact.split_at_mut(MIRROR_ROWS * columns);
            for row in mirror.chunks_exact_mut(columns) {
                row.copy_from_slice(&rest[..columns]);
            }
            exact = without_outliers(&exact, columns, OUTLIER * step);
        }
        exact
    }

    /// The error allowed for a number, relative to other numbers. A lobe that is narrower than its reflection needs
    /// finer numbers.
    pub(super) fn tolerance(self, channel: usize, numbers: &[f64; CHANNELS]) -> f64 {
        let narrow = numbers[0].min(numbers[2]);
        if self.is_chosen && !TERMS.contains(&channel) { (narrow * narrow).min(1.0) } else { 1.0 }
    }

    /// Whether an error is visible. Near the normal, a Fresnel term is so small that its stored root may have a large
    /// error.
    pub(super) fn is_seen(
        self,
        table: &Table,
        channel: usize,
        entry: usize,
        [exact, value]: [f64; 2],
        step: f64,
    ) -> bool {
        if !self.is_chosen || channel != TERMS[1] {
            return true;
        }
        let mut place = table.axes().node(entry);
        (place.alpha, place.theta) = (place.alpha.max(ALPHA_FLOOR), place.theta.min(THETA_CEILING));
        let grazing = Reflection::at(&place).grazing;
        let fifth = |x: f64| (x + grazing).max(0.0).powi(5);
        (fifth(exact) - fifth(value)).abs() >= UNSEEN * step
    }
}

/// Numbers in rows of `columns`. A number farther than `most` from the median of the nine numbers around it is replaced
/// by the median.
fn without_outliers(numbers: &[f64], columns: usize, most: f64) -> Vec<f64> {
    let rows = numbers.len() / columns;
    let median = |row: usize, column: usize| {
        let mut around: [f64; 9] = std::array::from_fn(|k| {
            let near = |at: usize, step: usize, count: usize| (at + step).saturating_sub(1).min(count - 1);
            numbers[near(row, k / 3, rows) * columns + near(column, k % 3, columns)]
        });
        around.sort_by(f64::total_cmp);
        around[4]
    };
    let kept = |(i, number): (usize, &f64)| {
        let median = median(i / columns, i % columns);
        if (number - median).abs() > most { median } else { *number }
    };
    numbers.iter().enumerate().map(kept).collect()
}
