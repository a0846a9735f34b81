//! The rows of a lookup table, which are its shards, and their assembly.

use std::ops::{ControlFlow, Range};

use rayon::prelude::*;

use super::{
    axes::{Axis, FEWEST, count},
    quadrature::RULES,
    recipe::{LEAST_COSINE, LutKind, LutPrecision, LutRecipe},
    solve::{Places, solve},
};
use crate::{brdf::BrdfKind, expectation::Expectation, math::cbrt, run::Progress, shard::ShardBytesError};

/// A recipe and the places at which its values are computed.
#[derive(Debug, Clone)]
pub struct LutPlan {
    recipe: LutRecipe,
    axes: Vec<Axis>,
}

impl LutRecipe {
    /// The predicted time, mean error and size of the table. Errors were measured with the default axes, from 16 x 16
    /// to 128 x 128 texels, and for similar numbers of texels on more axes.
    #[must_use]
    pub fn expectation(&self) -> Expectation {
        let texels = self.entries() as f64;
        let (least_error, width) = match self.precision {
            LutPrecision::F32 => (0.0, 4),
            LutPrecision::F16 => (5e-5, 2),
            LutPrecision::Unorm16 => (1e-5, 2),
            LutPrecision::Rgba8 => (7e-4, 1),
        };
        let error = match self.table {
            LutKind::Transmission => 0.16 / cbrt(texels * texels),
            LutKind::AnisotropicDfg => 0.16 / texels.sqrt(),
            _ => 0.16 / texels,
        };
        let bytes = width * self.entries() * self.channels().len() as u64;
        let seconds = self.cost().0 * count(&LutPlan::new(self).axes) as f64;
        Expectation { seconds, error: error.max(least_error), bytes }
    }
}

/// A lookup table.
#[derive(Debug, Clone, PartialEq)]
pub struct Lut {
    /// The texels in the order of the axes, the last axis fastest, with all channels of each.
    pub texels: Vec<f32>,
    /// The average of the albedo over the hemisphere for each roughness, in tables of kind `albedo`. Always f32, because
    /// a smooth surface loses less energy than the step of halves below one.
    pub average: Option<Vec<f32>>,
}

impl LutPlan {
    /// The plan of a recipe. Each texel has several places on each axis.
    #[must_use]
    pub fn new(recipe: &LutRecipe) -> Self {
        let most = recipe.resolution.texels().iter().max().map_or(1, |texels| *texels as usize);
        let per_texel = match (recipe.table.axes().len(), recipe.brdf) {
            (2, BrdfKind::Ggx) => FEWEST * (128 / most).clamp(1, 4),
            // These values take longer.
            (2, _) => (128 / most).clamp(1, 8),
            _ => FEWEST,
        };
        Self { recipe: *recipe, axes: recipe.grid(|axis| axis.fit_places(per_texel)) }
    }

    /// The recipe of the plan.
    #[must_use]
    pub fn recipe(&self) -> &LutRecipe {
        &self.recipe
    }

    /// The number of shards, one for each texel on the first axis.
    #[must_use]
    pub fn shards(&self) -> u32 {
        self.recipe.resolution.texels()[0]
    }

    /// The places on the first axis that belong to a shard.
    fn rows(&self, shard: u32) -> Range<usize> {
        let start = |shard: u32| shard as usize * self.axes[0].places.len() / self.shards() as usize;
        start(shard)..start(shard + 1)
    }

    /// The values at the places of a shard, all channels of each place. `None` if `on_progress` stops it.
    pub fn fit_shard(&self, shard: u32, on_progress: &mut dyn FnMut(u64) -> ControlFlow<()>) -> Option<Vec<f64>> {
        let (channels, others) = (self.recipe.channels().len(), count(&self.axes[1..]));
        let mut values = Vec::with_capacity(self.numbers(shard));
        for row in self.rows(shard) {
            let places = row * others..(row + 1) * others;
            values.extend(places.flat_map(|i| self.recipe.values_at(&self.axes, i).into_iter().take(channels)));
            on_progress(0).is_continue().then_some(())?;
        }
        on_progress(self.recipe.entries() / u64::from(self.shards())).is_continue().then_some(values)
    }

    /// The numbers of a shard.
    fn numbers(&self, shard: u32) -> usize {
        self.rows(shard).len() * count(&self.axes[1..]) * self.recipe.channels().len()
    }

    /// Decodes the result of a shard, which is little-endian f64.
    ///
    /// # Errors
    /// If the number of bytes does not match the shard.
    pub fn shard_from_bytes(&self, shard: u32, bytes: &[u8]) -> Result<Vec<f64>, ShardBytesError> {
        let expected = self.numbers(shard) * size_of::<f64>();
        if bytes.len() != expected {
            return Err(ShardBytesError { expected, actual: bytes.len() });
        }
        let (words, _) = bytes.as_chunks::<8>();
        Ok(words.iter().map(|word| f64::from_le_bytes(*word)).collect())
    }

    /// Solves for the texels. `values` are the results of all shards in order.
    #[must_use]
    pub fn assemble(&self, values: &[f64]) -> Lut {
        let recipe = &self.recipe;
        let channels = recipe.channels().len();
        let places = Places::new(&self.axes);
        // A surface that reflects more than all light has no lost energy to return.
        let is_bounded = recipe.table == LutKind::Albedo || recipe.precision.steps().is_some();
        let truth = |channel: usize| -> Vec<f64> { values.iter().skip(channel).step_by(channels).copied().collect() };
        let solved: Vec<Vec<f64>> =
            (0..channels).into_par_iter().map(|channel| solve(&places, &truth(channel), is_bounded)).collect();
        let texels = (0..solved[0].len()).flat_map(|texel| solved.iter().map(move |channel| channel[texel]));
        let texels: Vec<f32> = texels.map(|x| recipe.precision.round(x)).collect();
        let average = (recipe.table == LutKind::Albedo).then(|| {
            let rows = texels.chunks(texels.len() / recipe.resolution.texels()[0] as usize);
            rows.map(|row| average(&self.axes[1], row) as f32).collect()
        });
        Lut { texels, average }
    }
}

/// The average of a row over the hemisphere, `2 int E(mu) mu dmu`, where the linear filter reads `E`. With this average
/// a compensated surface returns all energy.
fn average(cosines: &Axis, row: &[f32]) -> f64 {
    let steps = 16 * row.len();
    let part = |step: usize| {
        let [from, to] = [step, step + 1].map(|i| cosines.value(i as f64 / steps as f64).max(LEAST_COSINE));
        let [part] = RULES[4].integrate(from.min(to), from.max(to), |cosine| {
            let (below, next) = cosines.filter(cosines.parameter(cosine));
            [2.0 * cosine * (f64::from(row[below]) * (1.0 - next) + f64::from(row[below + 1]) * next)]
        });
        part
    };
    (0..steps).map(part).sum()
}

/// Computes a whole table on the current rayon pool. Returns `None` if `progress` stops it.
#[must_use]
pub fn fit_lut(plan: &LutPlan, progress: &Progress) -> Option<Lut> {
    let of_shard = plan.recipe.entries() / u64::from(plan.shards());
    let row = |shard| plan.fit_shard(shard, &mut |_| progress(u64::from(shard) * of_shard));
    let rows: Option<Vec<Vec<f64>>> = (0..plan.shards()).into_par_iter().with_max_len(1).map(row).collect();
    Some(plan.assemble(&rows?.concat()))
}
