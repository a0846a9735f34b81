//! Compares the prefilter with sums of its kernel, and tests its exact properties.

use super::{
    ImageError, LightImage, LightPyramid,
    filters::{Filter, Taps, beside, enlarged, halved, size_of, widened},
    kernel_sum,
};
use rand_core::{Rng, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

/// Even, odd, long, prime and single sizes.
const SIZES: [[usize; 2]; 8] = [[64, 64], [96, 40], [63, 63], [37, 53], [65, 31], [3, 50], [1, 7], [1, 1]];

fn uniform(rng: &mut Xoshiro256PlusPlus) -> f64 {
    (rng.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
}

fn made([width, height]: [usize; 2], texel: impl FnMut([usize; 2]) -> [f32; 3]) -> LightImage {
    let places = (0..height).flat_map(|y| (0..width).map(move |x| [x, y]));
    LightImage::new(width, height, places.map(texel).collect()).expect("an image")
}

fn noise(size: [usize; 2], seed: u64) -> LightImage {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
    made(size, |_| [0; 3].map(|_| uniform(&mut rng) as f32))
}

/// A disk, a checkerboard of six fields and a ramp, one in each channel.
fn patterns(size: [usize; 2]) -> LightImage {
    made(size, |place| {
        let [u, v] = [0, 1].map(|axis| (place[axis] as f64 + 0.5) / size[axis] as f64);
        let disk = 4.0 * f32::from((u - 0.37).hypot(v - 0.6) < 0.1);
        let checker = f32::from(((u * 6.0) as i32 + (v * 6.0) as i32) % 2 == 1);
        [disk, checker, u as f32]
    })
}

/// The mean and the largest difference from [`kernel_sum`] at random points and levels, for each channel of
/// [`patterns`].
fn errors(size: [usize; 2]) -> [[f64; 2]; 3] {
    const POINTS: usize = 150;
    let image = patterns(size);
    let pyramid = LightPyramid::new(&image);
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(44);
    let mut errors = [[0.0_f64; 2]; 3];
    for _ in 0..POINTS {
        let uv = [0; 2].map(|_| uniform(&mut rng));
        let sigma = 2.0 * f64::from(1 << (pyramid.levels().len() - 1)) * uniform(&mut rng).max(0.02);
        let sigma = sigma.max(2.0);
        let (sum, fetched) = (kernel_sum(&image, uv, sigma), pyramid.fetch(uv, LightPyramid::level_of(sigma)));
        for (error, (a, b)) in errors.iter_mut().zip(sum.into_iter().zip(fetched)) {
            *error = [error[0] + (a - b).abs() / POINTS as f64, error[1].max((a - b).abs())];
        }
    }
    errors
}

#[test]
fn fetches_are_close_to_sums_of_the_kernel_at_even_and_odd_sizes() {
    for size in [[64, 64], [63, 63], [96, 40], [37, 53], [65, 127]] {
        let errors = errors(size);
        println!("{size:?} {errors:.4?}");
        for [mean, largest] in errors {
            assert!(mean < 0.03 && largest < 0.12, "{size:?}: {errors:?}");
        }
    }
}

#[test]
fn a_light_of_one_colour_keeps_it() {
    for size in SIZES {
        let colour = [0.1, 0.7, 12_345.678];
        for level in LightPyramid::new(&made(size, |_| colour)).levels() {
            assert!(level.texels().iter().all(|texel| *texel == colour), "{size:?}");
        }
    }
}

#[test]
fn levels_halve_down_to_the_mean() {
    for size in SIZES {
        let image = noise(size, 1);
        let pyramid = LightPyramid::new(&image);
        for (i, level) in pyramid.levels().iter().enumerate() {
            assert_eq!([level.width(), level.height()], size.map(|size| (size >> i).max(1)));
        }
        let top = pyramid.levels().last().expect("a level");
        assert_eq!(top.texels(), [image.mean().map(|mean| mean as f32)]);
    }
}

#[test]
fn it_is_linear_in_texels() {
    for size in SIZES {
        let (a, b) = (noise(size, 2), noise(size, 3));
        let both = made(size, |[x, y]| [0, 1, 2].map(|c| 0.25 * a.row(y)[x][c] + 3.0 * b.row(y)[x][c]));
        let [a, b, both] = [a, b, both].map(|image| LightPyramid::new(&image));
        for ((a, b), both) in a.levels().iter().zip(b.levels()).zip(both.levels()) {
            let parts = a.texels().as_flattened().iter().zip(b.texels().as_flattened());
            for ((a, b), both) in parts.zip(both.texels().as_flattened()) {
                assert!((0.25 * a + 3.0 * b - both).abs() < 2e-6, "{size:?}");
            }
        }
    }
}

#[test]
fn nothing_moves() {
    for size in SIZES {
        // The prefilter of a mirrored picture is the mirrored prefilter.
        let (image, last) = (noise(size, 4), size.map(|size| size - 1));
        let mirrored = LightPyramid::new(&made(size, |[x, y]| image.row(last[1] - y)[last[0] - x]));
        for (level, mirrored) in LightPyramid::new(&image).levels().iter().zip(mirrored.levels()) {
            for (a, b) in level.texels().iter().zip(mirrored.texels().iter().rev()) {
                assert!((0..3).all(|c| (a[c] - b[c]).abs() < 1e-6), "{size:?}: {a:?} {b:?}");
            }
        }
    }
}

#[test]
fn a_dot_away_from_the_border_stays_where_it_is() {
    // The centroid of a dot in a level, in texels of the image, if the kernel is far from the border.
    for size in [[512, 512], [511, 509], [383, 421]] {
        let dot = [size[0] * 4 / 9, size[1] * 5 / 9];
        for axis in [0, 1] {
            let mut row = vec![0.0; size[axis]];
            row[dot[axis]] = 1.0;
            for level in 1..5 {
                let (from, to) = (size_of(size[axis], level - 1), size_of(size[axis], level));
                row = applied(&halved(from, to), &row);
                let wide = applied(&widened(to, beside(size[axis], level)), &row);
                let length = size[axis] as f64 / to as f64;
                let [mass, place] = moments(&wide, length);
                assert!((mass * length - 1.0).abs() < 0.02, "{size:?}, level {level}: {mass}");
                let off = place - (dot[axis] as f64 + 0.5);
                assert!(off.abs() < 0.02 * length, "{size:?}, level {level}: {off}");
            }
        }
    }
}

fn applied(filter: &Filter, row: &[f64]) -> Vec<f64> {
    let texel = |taps: &Taps| row[taps.first..].iter().zip(&taps.weights).map(|(x, w)| x * w).sum();
    filter.iter().map(texel).collect()
}

/// The sum of a row, and the centroid of its texels of the given length.
fn moments(row: &[f64], length: f64) -> [f64; 2] {
    let mass: f64 = row.iter().sum();
    let place: f64 = row.iter().enumerate().map(|(i, x)| x * (i as f64 + 0.5) * length).sum();
    [mass, place / mass]
}

#[test]
fn even_sizes_have_the_weights_of_a_binomial() {
    let weights = |filter: &Filter, i: usize| filter[i].weights.iter().map(|weight| weight * 8.0).collect::<Vec<_>>();
    assert_eq!(weights(&halved(8, 4), 1), [1.0, 3.0, 3.0, 1.0]);
    assert_eq!(weights(&halved(8, 4), 0), [3.0, 3.0, 1.0].map(|weight| weight * 8.0 / 7.0));
    assert_eq!(weights(&enlarged(4, 8), 3), [6.0, 2.0]);
    for level in 0..6 {
        assert!((beside(64, level) - 0.25).abs() < 1e-12);
    }
}

#[test]
fn fetches_are_between_texels_and_levels_and_clamped() {
    let image = made([2, 1], |[x, _]| [x as f32, 3.0, 2.0 * x as f32]);
    assert_eq!(image.bilinear([0.5, 0.5]), [0.5, 3.0, 1.0]);
    assert_eq!(image.bilinear([0.25, -7.0]), [0.0, 3.0, 0.0]);
    assert_eq!(image.bilinear([f64::INFINITY, f64::NAN]), [1.0, 3.0, 2.0]);
    let pyramid = LightPyramid::new(&noise([16, 8], 5));
    let at = |level| pyramid.fetch([0.3, 0.8], level);
    let half = [0, 1, 2].map(|c| 0.5 * (at(1.0)[c] + at(2.0)[c]));
    assert!((0..3).all(|c| (at(1.5)[c] - half[c]).abs() < 1e-12));
    assert_ne!(at(1.0), at(2.0));
    assert_eq!([at(-3.0), at(f64::NAN), at(99.0)], [at(0.0), at(0.0), at(4.0)]);
    assert!((LightPyramid::level_of(16.0) - 3.0).abs() < 1e-12);
}

#[test]
fn invalid_images_are_reported() {
    let mut texels = vec![[1.0; 3]; 6];
    for (width, height) in [(0, 0), (4, 2), (usize::MAX, usize::MAX), (0, 6)] {
        let error = LightImage::new(width, height, texels.clone()).expect_err("a wrong size");
        assert!(matches!(error, ImageError::Count { found: 6, .. }), "{error}");
    }
    texels[4] = [1.0, f32::NAN, -1.0];
    texels[5][0] = f32::INFINITY;
    assert_eq!(
        LightImage::new(3, 2, texels).expect_err("invalid numbers").to_string(),
        "the texel at x 1, y 1 has green NaN; 3 of the image's numbers are negative or not finite"
    );
}

#[test]
fn texels_become_square_and_keep_their_mean() {
    let image = noise([30, 20], 6);
    for (light, size) in [
        ([3.0, 2.0], [30, 20]),
        ([1.5, 2.0], [30, 40]),
        ([3.0, 1.0], [60, 20]),
        ([1e9, 1.0], [8192, 1]),
        ([1.0, 1e9], [1, 8192]),
    ] {
        assert_eq!(image.square_size(light), size, "{light:?}");
        let square = image.resampled(size);
        assert_eq!([square.width(), square.height()], size);
        assert!((0..3).all(|c| (square.mean()[c] - image.mean()[c]).abs() < 1e-6), "{light:?}");
    }
    assert_eq!(image.resampled([30, 20]), image);
    let large = made([4096, 1], |_| [0.0; 3]).square_size([1.0, 1.0]);
    assert_eq!(large, [4096, 4096]);
    // A texel cut in half by an edge counts half in each.
    let three = made([3, 1], |[x, _]| [x as f32 * 3.0, 0.0, 1.0]).resampled([2, 1]);
    assert_eq!(three.texels(), [[1.0, 0.0, 1.0], [5.0, 0.0, 1.0]]);
}
