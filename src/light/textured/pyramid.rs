//! The prefilter: an image blurred with the kernel of rough surfaces, at all widths.

use super::{
    LightImage,
    filters::{beside, enlarged, halved, size_of, widened},
    rows::{Row, made},
};
use ltcforge_fit::math::ln;
use std::borrow::Cow;

/// The part of a level that comes from its own blur. The first number is for the level before the last, the second for
/// the level before that, and the third for all finer levels. The rest comes from the next coarser level, which gives
/// the kernel its long tail. Near the last level, the light ends before the tail does, so the parts are larger.
/// `ltcforge-studies prefilter` finds the numbers.
pub const OWN_PARTS: [f64; 3] = [0.85, 0.75, 0.65];

/// The width sigma of level 0, in texels.
const SIGMA_OF_BASE: f64 = 2.0;

/// A prefiltered image. Level l approximates
///
/// `T(p) = sum K(p - q) image(q) / sum K(p - q)`, `K(d) = (1 + |d|^2 / sigma^2)^-2.5`, `sigma = 2^(l + 1)` texels.
///
/// The sums are over the image only, so there is no border, and a light of one colour keeps its colour. Texels are
/// square on the light. Level l has `max(1, size >> l)` texels per side. The last level is a single texel, the mean of
/// the image. Everything is linear in the texels.
#[derive(Debug, Clone, PartialEq)]
pub struct LightPyramid {
    levels: Vec<LightImage>,
}

impl LightPyramid {
    /// Prefilters an image. From the finest to the coarsest level, each level is halved with a tent, `[1 3 3 1] / 8`,
    /// and widened with `[1 2 1] / 4`. Then, from the coarsest to the finest level, each level becomes a blend: a part
    /// of its own result, mostly 0.65, and the rest from the next coarser level. Weights outside of the image are left
    /// out, and the other weights are divided by their sum. Sums are in f64, levels are rounded to f32.
    ///
    /// Runs on the current rayon pool. The size of the pool does not change the result.
    #[must_use]
    pub fn new(image: &LightImage) -> Self {
        Self::with_own_parts(image, OWN_PARTS)
    }

    /// Like [`Self::new`], with `parts` instead of [`OWN_PARTS`].
    #[must_use]
    pub fn with_own_parts(image: &LightImage, parts: [f64; 3]) -> Self {
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
            let part = parts[(levels.len() - 1).min(parts.len() - 1)];
            levels.push(made(columns.len(), rows.len(), |y, row| {
                Row::new(own, &rows[y]).add(&columns, part, row);
                Row::new(above, &up_rows[y]).add(&up_columns, 1.0 - part, row);
            }));
        }
        levels.reverse();
        Self { levels }
    }

    /// The levels, from the finest to the coarsest.
    #[must_use]
    pub fn levels(&self) -> &[LightImage] {
        &self.levels
    }

    /// The level whose kernel has this sigma, `log2(sigma / 2)`. Domain: a positive `sigma`, in texels of the image.
    #[must_use]
    pub fn level_of(sigma: f64) -> f64 {
        ln(sigma / SIGMA_OF_BASE) / std::f64::consts::LN_2
    }

    /// The prefiltered image at a point. Interpolates linearly between texels and between levels, like a GPU with a
    /// clamping sampler. `u` goes from 0 at the left edge to 1 at the right, `v` from the top to the bottom. Points and
    /// levels outside are clamped.
    #[must_use]
    pub fn fetch(&self, uv: [f64; 2], level: f64) -> [f64; 3] {
        let last = self.levels.len() - 1;
        // This order maps NaN to the finest level.
        let level = level.max(0.0).min(last as f64);
        let fine = level as usize;
        let (near, far) = (self.levels[fine].bilinear(uv), self.levels[(fine + 1).min(last)].bilinear(uv));
        [0, 1, 2].map(|c| near[c] + (far[c] - near[c]) * (level - fine as f64))
    }
}
