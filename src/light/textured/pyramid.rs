//! The prefilter: an image blurred by the kernel of rough surfaces, at all widths.

use super::{
    LightImage,
    filters::{Filter, Taps, beside, enlarged, halved, size_of, widened},
};
use ltcforge_fit::math::ln;
use rayon::prelude::*;
use std::borrow::Cow;

/// How much of a level is its own blur; the rest comes from the level above, which gives the kernel its long tail.
const OWN_PART: f64 = 0.65;

/// The width sigma of level 0, in texels.
const SIGMA_OF_BASE: f64 = 2.0;

/// An image, prefiltered. Level l holds close to
///
/// `T(p) = sum K(p - q) image(q) / sum K(p - q)`, `K(d) = (1 + |d|^2 / sigma^2)^-2.5`, `sigma = 2^(l + 1)` texels,
///
/// the sums over the image alone, so that there is no border and a light of one colour keeps it. Texels are square on the
/// light. Level l has `max(1, size >> l)` texels a side, the last one a single texel, the mean of the image. All of it is
/// linear in the texels.
#[derive(Debug, Clone, PartialEq)]
pub struct LightPyramid {
    levels: Vec<LightImage>,
}

impl LightPyramid {
    /// Prefilters an image. From the image, each level is halved by a tent, `[1 3 3 1] / 8`, and widened by
    /// `[1 2 1] / 4`; from the last level on, each takes 0.65 of that and 0.35 of the level above. Weights that fall
    /// outside of the image are left out, and the others divided by their sum. Sums are in f64, levels rounded to f32.
    ///
    /// Runs on the current rayon pool; its size changes nothing.
    #[must_use]
    pub fn new(image: &LightImage) -> Self {
        let (width, height) = (image.width(), image.height());
        let top = width.max(height).ilog2() as usize;
        let sizes = |level| [size_of(width, level), size_of(height, level)];
        let mut chain = vec![Cow::Borrowed(image)];
        for level in 1..top {
            let [columns, rows] = [0, 1].map(|axis| halved(sizes(level - 1)[axis], sizes(level)[axis]));
            let next =
                made(columns.len(), rows.len(), |y, row| Row::new(&chain[level - 1], &rows[y]).add(&columns, 1.0, row));
            chain.push(Cow::Owned(next));
        }
        let mut levels = vec![LightImage::of_texels(1, vec![image.mean().map(|mean| mean as f32)])];
        for (level, own) in chain.iter().enumerate().take(top).rev() {
            let above = &levels[levels.len() - 1];
            let [columns, rows] = [width, height].map(|size| widened(size_of(size, level), beside(size, level)));
            let [up_columns, up_rows] =
                [0, 1].map(|axis| enlarged([above.width(), above.height()][axis], sizes(level)[axis]));
            levels.push(made(columns.len(), rows.len(), |y, row| {
                Row::new(own, &rows[y]).add(&columns, OWN_PART, row);
                Row::new(above, &up_rows[y]).add(&up_columns, 1.0 - OWN_PART, row);
            }));
        }
        levels.reverse();
        Self { levels }
    }

    /// The levels, the finest first.
    #[must_use]
    pub fn levels(&self) -> &[LightImage] {
        &self.levels
    }

    /// The level whose kernel has this sigma, `log2(sigma / 2)`. Domain: `sigma` above zero, in texels of the image.
    #[must_use]
    pub fn level_of(sigma: f64) -> f64 {
        ln(sigma / SIGMA_OF_BASE) / std::f64::consts::LN_2
    }

    /// The prefiltered image at a point, linearly between texels and between levels, as a GPU does it with a sampler that
    /// clamps. `u` runs from 0 at the left edge to 1 at the right, `v` from the top to the bottom; what lies outside and
    /// levels that there are not are those nearest.
    #[must_use]
    pub fn fetch(&self, uv: [f64; 2], level: f64) -> [f64; 3] {
        let last = self.levels.len() - 1;
        // In this order a level that is not a number is the finest.
        let level = level.max(0.0).min(last as f64);
        let fine = level as usize;
        let (near, far) = (self.levels[fine].bilinear(uv), self.levels[(fine + 1).min(last)].bilinear(uv));
        [0, 1, 2].map(|c| near[c] + (far[c] - near[c]) * (level - fine as f64))
    }
}

/// The image of a size whose rows `add` adds to zeros, each by itself.
fn made(width: usize, height: usize, add: impl Fn(usize, &mut [[f64; 3]]) + Sync) -> LightImage {
    let mut texels = vec![[0_f32; 3]; width * height];
    texels.par_chunks_mut(width).enumerate().for_each_init(
        || vec![[0_f64; 3]; width],
        |sums, (y, row)| {
            sums.fill([0.0; 3]);
            add(y, sums);
            for (texel, sum) in row.iter_mut().zip(sums) {
                *texel = sum.map(|sum| sum as f32);
            }
        },
    );
    LightImage::of_texels(width, texels)
}

/// A row of an image that was filtered down its columns.
struct Row(Vec<[f64; 3]>);

impl Row {
    fn new(image: &LightImage, taps: &Taps) -> Self {
        let mut sums = vec![[0.0; 3]; image.width()];
        for (y, weight) in (taps.first..).zip(&taps.weights) {
            for (sum, texel) in sums.as_flattened_mut().iter_mut().zip(image.row(y).as_flattened()) {
                *sum += weight * f64::from(*texel);
            }
        }
        Self(sums)
    }

    /// Adds the row, filtered by `columns`, `by` times.
    fn add(&self, columns: &Filter, by: f64, to: &mut [[f64; 3]]) {
        for (sum, taps) in to.iter_mut().zip(columns) {
            for (texel, weight) in self.0[taps.first..].iter().zip(&taps.weights) {
                for (sum, texel) in sum.iter_mut().zip(texel) {
                    *sum += by * weight * texel;
                }
            }
        }
    }
}
