//! A distribution over the hemisphere, seen from above.

use glam::DVec3;
use ltcforge::view::picture::{Picture, colour};
use rayon::prelude::*;

/// The colour outside the hemisphere.
const BESIDE: [u8; 3] = [48, 48, 48];
/// Samples along a pixel's side. The pixel's colour is their mean, because lobes can be thinner than a pixel.
const PLACES: u32 = 4;
/// The exponent for displayed densities. It makes the tails of a peak visible.
const POWER: f64 = 0.5;

/// A picture of the density for every direction above the surface, with x to the right and y upwards. The colour bar
/// ends at `peak`.
pub(super) fn hemisphere(side: u32, peak: f64, density: impl Fn(DVec3) -> f64 + Sync) -> Picture {
    let rgb = (0..side * side).into_par_iter().map(|index| {
        let (column, row) = (index % side, index / side);
        let mut sum = 0.0;
        let mut above = 0_u32;
        for place in 0..PLACES * PLACES {
            let at = |pixel: u32, part: u32| {
                2.0 * (f64::from(pixel) + (f64::from(part) + 0.5) / f64::from(PLACES)) / f64::from(side) - 1.0
            };
            let (x, y) = (at(column, place % PLACES), -at(row, place / PLACES));
            let height = 1.0 - x * x - y * y;
            if height > 0.0 {
                above += 1;
                sum += density(DVec3::new(x, y, height.sqrt()));
            }
        }
        if 2 * above < PLACES * PLACES {
            return BESIDE;
        }
        colour((sum / f64::from(above) / peak).powf(POWER) as f32)
    });
    Picture { width: side, height: side, rgb: rgb.collect() }
}

/// The largest density in the picture of [`hemisphere`].
pub(super) fn peak(side: u32, density: impl Fn(DVec3) -> f64 + Sync) -> f64 {
    let count = side * PLACES;
    let at = |i: u32| 2.0 * (f64::from(i) + 0.5) / f64::from(count) - 1.0;
    let row = |row: u32| {
        let directions = (0..count).filter_map(|column| {
            let (x, y) = (at(column), -at(row));
            let height = 1.0 - x * x - y * y;
            (height > 0.0).then(|| DVec3::new(x, y, height.sqrt()))
        });
        directions.map(&density).fold(0.0, f64::max)
    };
    (0..count).into_par_iter().map(row).reduce(|| 0.0, f64::max)
}
