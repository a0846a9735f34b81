//! Compares the passes that prefilter a picture on the GPU with the pyramid on the CPU.

use super::report_skipped;
use crate::preview::gpu::{
    GpuFailure,
    tests::prefilter::{Passes, run},
};
use ltcforge_light::textured::{LightImage, LightPyramid};

/// Largest difference, relative to the picture's largest number. An f32 sum has at most as many texels as a side.
const SAME: f32 = 2e-6;

#[test]
fn the_passes_compute_the_pyramid_of_the_cpu() {
    for [width, height] in [[64, 64], [63, 41], [3, 50], [1, 7], [2, 1], [1, 1]] {
        let number = |i: usize| (i.wrapping_mul(2_654_435_761) % 1000) as f32 / 100.0;
        let texels = (0..width * height).map(|i| [number(3 * i), number(3 * i + 1), number(3 * i + 2)]).collect();
        let image = LightImage::new(width, height, texels).expect("an image");
        let pyramid = LightPyramid::new(&image);
        for passes in [Passes::Compute, Passes::Fragment] {
            let levels = match run(&image, passes) {
                Ok(levels) => levels,
                Err(GpuFailure::Absent(reason)) => return report_skipped(&reason),
                Err(error) => panic!("{error}"),
            };
            assert_eq!(levels.len(), pyramid.levels().len());
            for (i, (found, level)) in levels.iter().zip(pyramid.levels()).enumerate() {
                assert_eq!(found.len(), level.texels().len());
                for (found, wanted) in found.iter().zip(level.texels()) {
                    let is_near = (0..3).all(|c| (found[c] - wanted[c]).abs() < 10.0 * SAME);
                    assert!(is_near, "{width} x {height}, {passes:?}, level {i}: {found:?}, not {wanted:?}");
                }
            }
        }
    }
}
