//! Finds `OWN_PARTS` of `src/light/textured/pyramid.rs`: the part of each level in the pyramid of a picture that does
//! not come from the next coarser level. Prints the table of docs/textured.md.
//!
//! The truth sums the kernel over a grid of 3 x 3 points per texel. It shares no code with the pyramid.

use std::fmt::Write as _;

use ltcforge::light::textured::{LightImage, LightPyramid, OWN_PARTS, kernel_sum};
use rand_core::{Rng, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use rayon::prelude::*;

/// Sizes of pictures: even, odd and long.
const SIZES: [[usize; 2]; 5] = [[64, 64], [63, 63], [96, 40], [37, 53], [65, 127]];
/// The number of points for each size.
pub const POINTS: usize = 400;
/// Seeds for the points of the search, and for the held-out points.
const SEEDS: [u64; 2] = [1, 2];
/// The parts to try.
const TRIED: [[f64; 5]; 3] = [[0.75, 0.8, 0.85, 0.9, 0.95], [0.65, 0.7, 0.75, 0.8, 0.85], [0.55, 0.6, 0.65, 0.7, 0.75]];

/// A picture, with the sum of the kernel at random points.
struct Case {
    image: LightImage,
    /// Position, sigma and sum.
    points: Vec<([f64; 2], f64, [f64; 3])>,
}

/// Mean and largest error for each channel.
type Errors = [[f64; 2]; 3];

fn uniform(rng: &mut Xoshiro256PlusPlus) -> f64 {
    (rng.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
}

/// A picture with a disk of radiance 4, a checkerboard of 6 x 6 squares and a ramp.
fn picture(size: [usize; 2]) -> LightImage {
    let texel = |[x, y]: [usize; 2]| {
        let (u, v) = ((x as f64 + 0.5) / size[0] as f64, (y as f64 + 0.5) / size[1] as f64);
        let (dx, dy) = (u - 0.37, v - 0.6);
        let disk = if dx * dx + dy * dy < 0.01 { 4.0 } else { 0.0 };
        let checker = f32::from(u8::from(((u * 6.0) as i32 + (v * 6.0) as i32) % 2 == 1));
        [disk, checker, u as f32]
    };
    let places = (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| [x, y]));
    LightImage::new(size[0], size[1], places.map(texel).collect()).expect("texels that are finite")
}

/// Random points in the pictures. Sigma is from 2 texels to the sigma of the last level, evenly distributed in its
/// logarithm.
fn cases(points: usize, seed: u64) -> Vec<Case> {
    let case = |size: &[usize; 2]| {
        let (image, mut rng) = (picture(*size), Xoshiro256PlusPlus::seed_from_u64(seed));
        let last = f64::from(size[0].max(size[1]).ilog2());
        let places: Vec<_> = (0..points)
            .map(|_| ([uniform(&mut rng), uniform(&mut rng)], 2.0 * (last * uniform(&mut rng)).exp2()))
            .collect();
        let points = places.into_par_iter().map(|(uv, sigma)| (uv, sigma, kernel_sum(&image, uv, sigma))).collect();
        Case { image, points }
    };
    SIZES.iter().map(case).collect()
}

fn errors(case: &Case, parts: [f64; 3]) -> Errors {
    let pyramid = LightPyramid::with_own_parts(&case.image, parts);
    let mut errors = Errors::default();
    for (uv, sigma, sum) in &case.points {
        let fetched = pyramid.fetch(*uv, LightPyramid::level_of(*sigma));
        for (error, (a, b)) in errors.iter_mut().zip(sum.iter().zip(fetched)) {
            let apart = (a - b).abs();
            *error = [error[0] + apart / case.points.len() as f64, error[1].max(apart)];
        }
    }
    errors
}

/// The mean error over all points and channels of all cases.
fn mean(cases: &[Case], parts: [f64; 3]) -> f64 {
    let all = cases.iter().flat_map(|case| errors(case, parts)).map(|[mean, _]| mean);
    all.sum::<f64>() / (3 * cases.len()) as f64
}

/// The errors of the best parts, of the current parts and of 0.65 for all, and the table for held-out points.
#[must_use]
pub fn text(points: usize) -> String {
    let [training, held_out] = SEEDS.map(|seed| cases(points, seed));
    let [first, second, rest] = TRIED;
    let tried: Vec<[f64; 3]> =
        first.iter().flat_map(|a| second.iter().flat_map(move |b| rest.map(|c| [*a, *b, c]))).collect();
    let found: Vec<(f64, [f64; 3])> = tried.par_iter().map(|parts| (mean(&training, *parts), *parts)).collect();
    let best = found.iter().min_by(|a, b| a.0.total_cmp(&b.0)).map_or(OWN_PARTS, |(_, parts)| *parts);
    let mut out = String::new();
    for (name, parts) in [("best", best), ("OWN_PARTS", OWN_PARTS), ("one for all", [0.65; 3])] {
        let [here, there] = [&training, &held_out].map(|cases| mean(cases, parts));
        // Writing to a String cannot fail.
        let _ = writeln!(out, "{name} {parts:?}: mean error {here:.5}, at other points {there:.5}");
    }
    let _ = writeln!(out, "\n| size | disk | checkerboard, 6 x 6 | ramp |\n|---|---|---|---|");
    for case in &held_out {
        let cells = errors(case, OWN_PARTS).map(|[mean, largest]| format!("{mean:.4}, {largest:.3}"));
        let _ = writeln!(out, "| {} x {} | {} |", case.image.width(), case.image.height(), cells.join(" | "));
    }
    out
}
