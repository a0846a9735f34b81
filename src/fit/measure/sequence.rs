//! The sample points of the report. They are digital nets, which the fit does not use.

use std::f64::consts::PI;

use glam::DVec3;

use crate::math::sin_cos;

/// `2^log2_count` points that cover the unit square evenly: the net of Larcher and Pillichshammer [Kollig and Keller
/// 2002, section 2.3].
///
/// The first coordinate of point `i` of `n = 2^m` is `i / n`. In the second coordinate, bit `k` of `i` flips the binary
/// digits `2^-1` to `2^-(k + 1)`. On a grid of boxes of size `2^-a` by `2^-(m - a)`, each box contains exactly one
/// point. The digits of `scramble` are flipped in all points, which preserves this property. Each point is at the
/// centre of its cell of the `n` by `n` grid.
///
/// Domain: `1 <= log2_count <= 31`.
pub(super) fn net(log2_count: u32, scramble: [u32; 2]) -> impl Iterator<Item = [f64; 2]> {
    let count = 1_u32 << log2_count;
    let place = move |digits: u32| (f64::from(digits) + 0.5) / f64::from(count);
    (0..count).map(move |i| {
        // `flipped` has the digits 2^-1 to 2^-(k + 1) set, as an integer divided by n.
        let (mut second, mut flipped, mut rest) = (0, count >> 1, i);
        while rest > 0 {
            if rest & 1 == 1 {
                second ^= flipped;
            }
            rest >>= 1;
            flipped |= flipped >> 1;
        }
        [place((i ^ scramble[0]) & (count - 1)), place((second ^ scramble[1]) & (count - 1))]
    })
}

/// A direction of the upper hemisphere with uniform density from a point of the unit square. The first coordinate is
/// its height (Archimedes), the second its azimuth.
pub(super) fn uniform([u, v]: [f64; 2]) -> DVec3 {
    let (sin, cos) = sin_cos(2.0 * PI * v);
    let radius = (1.0 - u * u).sqrt();
    DVec3::new(radius * cos, radius * sin, u)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::concentric_cosine;

    #[test]
    fn every_elementary_box_of_the_net_holds_one_point() {
        let m = 8;
        for scramble in [[0, 0], [0x9e37_79b9, 0x1234_5678]] {
            let points: Vec<[f64; 2]> = net(m, scramble).collect();
            assert_eq!(points.len(), 1 << m);
            for a in 0..=m {
                let (columns, rows) = (1_usize << a, 1_usize << (m - a));
                let mut counts = vec![0; 1 << m];
                for [u, v] in &points {
                    counts[(u * columns as f64) as usize * rows + (v * rows as f64) as usize] += 1;
                }
                assert!(counts.iter().all(|count| *count == 1), "{columns} x {rows}: {counts:?}");
            }
        }
    }

    /// Compares the means of heights and of squared heights with closed forms: 2/3 and 1/2 for the cosine, 1/2 and 1/3
    /// for uniform directions. No direction in the plane is preferred.
    #[test]
    fn both_maps_have_the_moments_of_their_densities() {
        for (map, first, second) in
            [(concentric_cosine as fn([f64; 2]) -> DVec3, 2.0 / 3.0, 1.0 / 2.0), (uniform, 1.0 / 2.0, 1.0 / 3.0)]
        {
            let directions: Vec<DVec3> = net(12, [7, 11]).map(map).collect();
            let mean = |f: fn(&DVec3) -> f64| directions.iter().map(f).sum::<f64>() / directions.len() as f64;
            assert!(directions.iter().all(|w| (w.length() - 1.0).abs() < 1e-12 && w.z >= 0.0));
            assert!((mean(|w| w.z) - first).abs() < 1e-3 && (mean(|w| w.z * w.z) - second).abs() < 1e-3);
            let planar = 0.5 * (1.0 - second);
            assert!((mean(|w| w.x * w.x) - planar).abs() < 1e-3 && (mean(|w| w.y * w.y) - planar).abs() < 1e-3);
            assert!(mean(|w| w.x).abs() < 1e-3 && mean(|w| w.y).abs() < 1e-3 && mean(|w| w.x * w.y).abs() < 1e-3);
        }
    }
}
