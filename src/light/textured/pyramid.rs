//! The prefilter: an image blurred by the kernel of rough surfaces, at all widths.

use super::{
    LightImage,
    filters::{beside, enlarged, halved, size_of, widened},
    rows::{Row, made},
};
use ltcforge_fit::math::ln;
use std::borrow::Cow;

/// How much of a level is its own blur, from the one below the last on; what follows is as the third. The rest comes from
/// the level above, which gives the kernel its long tail. Near the last level the light ends before the tail does. Found by
/// `ltcforge-studies prefilter`.
pub const OWN_PARTS: [f64; 3] = [0.85, 0.75, 0.65];

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
    /// `[1 2 1] / 4`; from the last level on, each takes a part of that, 0.65 for most, and the rest from the level above. Weights that fall
    /// outside of the image are left out, and the others divided by their sum. Sums are in f64, levels rounded to f32.
    ///
    /// Runs on the current rayon pool; its size changes nothing.
    #[must_use]
    pub fn new(image: &LightImage) -> Self {
        Self::with_own_parts(image, OWN_PARTS)
    }

    /// The same with other parts than [`OWN_PARTS`].
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
