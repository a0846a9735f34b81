//! The error of a lookup table after linear filtering.

use std::fmt;

use rayon::prelude::*;
use serde::Serialize;

use super::{
    axes::{Axis, count},
    recipe::{LutPrecision, LutRecipe},
    rows::Lut,
    solve::Places,
};
use crate::brdf::BrdfKind;

/// The number of places between the ends of an axis of a picture: for GGX, and for models whose values take longer.
const SLICE: [usize; 2] = [223, 67];

/// Absolute errors over the domain: alpha from .002 (kind `albedo`: 1e-4), cosine from .01, evenly in the parameters of the axes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct LutError {
    /// The mean of all channels.
    pub mean: f64,
    /// The 95th percentile.
    pub p95: f64,
    /// The largest error.
    pub max: f64,
}

impl fmt::Display for LutError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "mean {:.5}, p95 {:.5}, max {:.5}", self.mean, self.p95, self.max)
    }
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
    /// The error of the stored texels, rounded to each number format.
    pub formats: Vec<(LutPrecision, LutError)>,
}

/// A recipe's values at the places of a report.
#[derive(Debug)]
pub struct MeasuredLut {
    recipe: LutRecipe,
    places: Places,
    values: Vec<[f64; 3]>,
}

impl MeasuredLut {
    /// Computes the values over the whole domain on the current rayon pool.
    #[must_use]
    pub fn new(recipe: &LutRecipe) -> Self {
        let (_, count) = recipe.cost();
        // Fine tables have more places than texels.
        let is_flat = recipe.table.axes().len() == 2;
        Self::at(recipe, |axis| axis.even(if is_flat { count.max(axis.texels * 5 / 4) } else { count }))
    }

    /// Computes the values of the slice that pictures show: a square, with smoothness downwards and the view to the right.
    /// Other axes have a parameter in the middle.
    #[must_use]
    pub fn slice(recipe: &LutRecipe) -> Self {
        let count = if recipe.brdf == BrdfKind::Ggx { SLICE[0] } else { SLICE[1] };
        Self::at(recipe, |axis| match axis.name {
            "ior" => vec![axis.parameter(1.5)],
            "ratio" | "phi" => vec![0.5],
            _ => axis.even(count),
        })
    }

    /// Computes the values at places that `places` chooses on each axis.
    pub(super) fn at(recipe: &LutRecipe, places: impl Fn(&Axis) -> Vec<f64>) -> Self {
        let axes = recipe.grid(places);
        let values = (0..count(&axes)).into_par_iter().map(|place| recipe.values_at(&axes, place)).collect();
        Self { recipe: *recipe, places: Places::new(&axes), values }
    }

    /// The values of a channel at all places.
    #[must_use]
    pub fn values(&self, channel: usize) -> Vec<f64> {
        self.values.iter().map(|values| values[channel]).collect()
    }

    /// The absolute errors of a channel at all places. Domain: texels of the recipe's resolution.
    #[must_use]
    pub fn errors(&self, texels: &[f32], channel: usize) -> Vec<f64> {
        let channels = self.recipe.channels().len();
        let texels: Vec<f64> = texels.iter().skip(channel).step_by(channels).map(|x| f64::from(*x)).collect();
        let found = self.places.filtered(&texels).zip(&self.values);
        found.map(|(found, values)| (found - values[channel]).abs()).collect()
    }

    /// The error of texels in the order of the axes, with all channels of each. Domain: texels of the recipe's
    /// resolution.
    #[must_use]
    pub fn error(&self, texels: &[f32]) -> LutError {
        let channels = 0..self.recipe.channels().len();
        let mut errors: Vec<f64> = channels.flat_map(|channel| self.errors(texels, channel)).collect();
        errors.sort_by(f64::total_cmp);
        let count = errors.len();
        LutError {
            mean: errors.iter().sum::<f64>() / count as f64,
            p95: errors[count * 95 / 100],
            max: errors[count - 1],
        }
    }

    /// The report of a table.
    #[must_use]
    pub fn report(&self, lut: &Lut) -> LutReport {
        let recipe = &self.recipe;
        let exact = Self::at(recipe, Axis::texel_centres);
        let numbers = |values: &[f64; 3]| values.map(|x| recipe.precision.round(x)).into_iter();
        let sampled = exact.values.iter().flat_map(|values| numbers(values).take(recipe.channels().len()));
        let of = |format: &LutPrecision| {
            let rounded: Vec<f32> = lut.texels.iter().map(|x| format.round(f64::from(*x))).collect();
            (*format, self.error(&rounded))
        };
        LutReport {
            places: self.values.len(),
            stored: self.error(&lut.texels),
            sampled: self.error(&sampled.collect::<Vec<_>>()),
            formats: LutPrecision::ALL.iter().map(of).collect(),
        }
    }
}
