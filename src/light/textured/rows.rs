//! Makes images row by row, and filters them along both axes.

use super::{
    LightImage,
    filters::{Filter, Taps},
};
use rayon::prelude::*;

/// Makes an image of a given size. `add` receives each row as zeros and adds the texels.
pub(super) fn made(width: usize, height: usize, add: impl Fn(usize, &mut [[f64; 3]]) + Sync) -> LightImage {
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

/// A row of an image after the filter down its columns.
pub(super) struct Row(Vec<[f64; 3]>);

impl Row {
    pub(super) fn new(image: &LightImage, taps: &Taps) -> Self {
        let mut sums = vec![[0.0; 3]; image.width()];
        for (y, weight) in (taps.first..).zip(&taps.weights) {
            for (sum, texel) in sums.as_flattened_mut().iter_mut().zip(image.row(y).as_flattened()) {
                *sum += weight * f64::from(*texel);
            }
        }
        Self(sums)
    }

    /// Adds the row, filtered along the row by `columns` and multiplied by `by`.
    pub(super) fn add(&self, columns: &Filter, by: f64, to: &mut [[f64; 3]]) {
        for (sum, taps) in to.iter_mut().zip(columns) {
            for (texel, weight) in self.0[taps.first..].iter().zip(&taps.weights) {
                for (sum, texel) in sum.iter_mut().zip(texel) {
                    *sum += by * weight * texel;
                }
            }
        }
    }
}
