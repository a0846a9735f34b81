//! The error of a lookup table after linear filtering.

use rayon::prelude::*;
use serde::Serialize;

use super::{
    recipe::{LutPrecision, LutRecipe},
    rows::Lut,
};
use crate::brdf::BrdfKind;

/// About the number of places on each axis at which a table of GGX, or of another model, is measured. They are not the
/// places of the fit. With 660 places on each axis the largest error of `dfg` is at most 3 % larger.
const PLACES: usize = 220;
const FEW_PLACES: usize = 64;

/// Absolute errors over the domain: alpha from .002, cosine from .01, evenly in the parameters of the axes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct LutError {
    /// The mean of all channels.
    pub mean: f64,
    /// The 95th percentile.
    pub p95: f64,
    /// The largest error.
    pub max: f64,
}

/// The errors of a lookup table.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LutReport {
    /// The number of places.
    pub places: usize,
    /// The error of the stored numbers.
    pub stored: LutError,
    /// The error of a table that has the exact values at its texels, rounded to the precision of the recipe.
    pub sampled: LutError,
    /// The error in each number format.
    pub formats: Vec<(LutPrecision, LutError)>,
}

/// Values and errors of a channel at the places of a report, evenly spaced in the parameters of the axes.
#[derive(Debug, Clone, PartialEq)]
pub struct LutMap {
    /// The number of places in a row.
    pub columns: usize,
    /// The values.
    pub values: Vec<f64>,
    /// The absolute errors after linear filtering.
    pub errors: Vec<f64>,
}

/// A recipe's values at the places of a report.
#[derive(Debug)]
pub struct MeasuredLut {
    recipe: LutRecipe,
    /// Parameters of roughness and view, and the values.
    truth: Vec<([f64; 2], [f64; 3])>,
}

impl MeasuredLut {
    /// Computes the values on the current rayon pool.
    #[must_use]
    pub fn new(recipe: &LutRecipe) -> Self {
        let count = if recipe.brdf == BrdfKind::Ggx { PLACES } else { FEW_PLACES };
        let grid = recipe.grid();
        let [rows, columns] = grid.map(|(parameter, texels)| parameter.even(recipe.axes.texels, texels, count));
        let truth = rows.into_par_iter().flat_map_iter(|row| {
            let alpha = grid[0].0.value(row);
            let columns = columns.iter();
            columns.map(move |column| ([row, *column], recipe.truth(alpha, grid[1].0.value(*column))))
        });
        Self { recipe: *recipe, truth: truth.collect() }
    }

    /// The absolute errors at all places, all channels of each. Domain: texels of the recipe's resolution.
    fn errors(&self, texels: &[f32]) -> Vec<f64> {
        let (axes, size) = (&self.recipe.axes, &self.recipe.resolution);
        let (channels, width) = (self.recipe.channels().len(), size.cos_theta as usize);
        let mut errors: Vec<f64> = Vec::with_capacity(channels * self.truth.len());
        for (at, truth) in &self.truth {
            let (row, down) = axes.texels.filter(at[0], size.roughness as usize);
            let (column, right) = axes.texels.filter(at[1], width);
            for (channel, truth) in truth.iter().take(channels).enumerate() {
                let texel = |row: usize, column: usize| f64::from(texels[(row * width + column) * channels + channel]);
                let mix = |row| texel(row, column) * (1.0 - right) + texel(row, column + 1) * right;
                errors.push((mix(row) * (1.0 - down) + mix(row + 1) * down - truth).abs());
            }
        }
        errors
    }

    /// The error of texels: rows of roughness, then texels of the view, then channels. Domain: texels of the recipe's
    /// resolution.
    #[must_use]
    pub fn error(&self, texels: &[f32]) -> LutError {
        let mut errors = self.errors(texels);
        errors.sort_by(f64::total_cmp);
        let count = errors.len();
        LutError {
            mean: errors.iter().sum::<f64>() / count as f64,
            p95: errors[count * 95 / 100],
            max: errors[count - 1],
        }
    }

    /// The values and errors of one channel: rows of roughness, from smooth surfaces, with low views first, and the
    /// number of places in a row.
    #[must_use]
    pub fn map(&self, lut: &Lut, channel: usize) -> LutMap {
        let columns = self.truth.iter().take_while(|(at, _)| at[0] == self.truth[0].0[0]).count();
        let errors = self.errors(&lut.texels).into_iter().skip(channel).step_by(self.recipe.channels().len());
        LutMap {
            columns,
            values: self.truth.iter().map(|(_, truth)| truth[channel]).collect(),
            errors: errors.collect(),
        }
    }

    /// The report of a table.
    #[must_use]
    pub fn report(&self, lut: &Lut) -> LutReport {
        let recipe = &self.recipe;
        let (axes, size) = (&recipe.axes, &recipe.resolution);
        let sampled: Vec<f32> = (0..size.roughness as usize)
            .into_par_iter()
            .flat_map_iter(|row| {
                let alpha = axes.roughness.alpha(axes.texels.parameter(row, size.roughness as usize));
                (0..size.cos_theta as usize).flat_map(move |column| {
                    let cosine = axes.cos_theta.cosine(axes.texels.parameter(column, size.cos_theta as usize));
                    recipe
                        .truth(alpha, cosine)
                        .into_iter()
                        .take(recipe.channels().len())
                        .map(|x| recipe.precision.round(x))
                })
            })
            .collect();
        let of = |format: &LutPrecision| {
            let rounded: Vec<f32> = lut.texels.iter().map(|x| format.round(f64::from(*x))).collect();
            (*format, self.error(&rounded))
        };
        LutReport {
            places: self.truth.len(),
            stored: self.error(&lut.texels),
            sampled: self.error(&sampled),
            formats: LutPrecision::ALL.iter().map(of).collect(),
        }
    }
}
