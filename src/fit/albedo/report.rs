//! The error of a lookup table after linear filtering.

use rayon::prelude::*;
use serde::Serialize;

use super::{
    axes::{Axis, Parameter},
    recipe::{LutKind, LutPrecision, LutRecipe},
    rows::Lut,
    solve::Places,
};
use crate::brdf::BrdfKind;

/// The number of places between the ends of an axis: of isotropic GGX, of other models, of glass, and of anisotropic GGX.
/// Prime numbers, so the places are at many positions between texels.
const PLACES: [usize; 4] = [223, 67, 29, 13];

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
    places: Places,
    /// The number of places on the last axis that has more than one.
    columns: usize,
    values: Vec<[f64; 3]>,
}

impl MeasuredLut {
    /// Computes the values over the whole domain on the current rayon pool.
    #[must_use]
    pub fn new(recipe: &LutRecipe) -> Self {
        let count = match (recipe.table, recipe.brdf) {
            (LutKind::AnisotropicDfg, _) => PLACES[3],
            (LutKind::Transmission, _) => PLACES[2],
            (_, BrdfKind::Ggx) => PLACES[0],
            _ => PLACES[1],
        };
        let even = |(parameter, texels): (Parameter, usize)| {
            // Fine tables have more places than texels.
            parameter.even(if recipe.table.axes().len() == 2 { count.max(texels * 5 / 4) } else { count })
        };
        Self::at(recipe, &recipe.grid().into_iter().map(even).collect::<Vec<_>>())
    }

    /// Computes the values of the slice that pictures show, and the place of the slice: smoothness downwards and the view
    /// to the right. Other axes have a parameter in the middle.
    #[must_use]
    pub fn slice(recipe: &LutRecipe) -> Self {
        let axes = recipe.grid().into_iter().zip(recipe.table.axes());
        let parameters = axes.map(|((parameter, _), name)| match *name {
            "ior" => vec![parameter.of(1.5)],
            "ratio" | "phi" => vec![0.5],
            _ => parameter.even(if recipe.brdf == BrdfKind::Ggx { PLACES[0] } else { PLACES[1] }),
        });
        Self::at(recipe, &parameters.collect::<Vec<_>>())
    }

    fn at(recipe: &LutRecipe, parameters: &[Vec<f64>]) -> Self {
        let first = parameters[0].par_iter();
        let values = first.flat_map_iter(|x| {
            let mut row = parameters.to_vec();
            row[0] = vec![*x];
            recipe.values(&row).collect::<Vec<_>>()
        });
        Self {
            recipe: *recipe,
            places: Places::new(&Axis::all(recipe.grid(), recipe.texels(), parameters)),
            columns: parameters.iter().rev().map(Vec::len).find(|n| *n > 1).unwrap_or(1),
            values: values.collect(),
        }
    }

    /// The absolute errors of a channel at all places. Domain: texels of the recipe's resolution.
    fn errors(&self, texels: &[f32], channel: usize) -> Vec<f64> {
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

    /// The values and errors of one channel, and the number of places in a row. Rows start with smooth surfaces.
    #[must_use]
    pub fn map(&self, lut: &Lut, channel: usize) -> LutMap {
        LutMap {
            columns: self.columns,
            values: self.values.iter().map(|values| values[channel]).collect(),
            errors: self.errors(&lut.texels, channel),
        }
    }

    /// The report of a table.
    #[must_use]
    pub fn report(&self, lut: &Lut) -> LutReport {
        let recipe = &self.recipe;
        let texels = |(_, n): (Parameter, usize)| (0..n).map(|i| recipe.texels().parameter(i, n)).collect();
        let exact = Self::at(recipe, &recipe.grid().into_iter().map(texels).collect::<Vec<_>>());
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
