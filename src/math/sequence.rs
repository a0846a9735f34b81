//! Low-discrepancy point sets and their maps to hemispheres.

use std::f64::consts::PI;

use glam::DVec3;

use super::sin_cos;

/// 1 / golden ratio: the most irrational step on a circle.
const GOLDEN_STEP: f64 = 0.618_033_988_749_894_9;

/// Point `i` of the golden lattice of `n` points in the unit square, shifted cyclically by `shift`.
///
/// `u = ((i + 1/2) / n + shift_0 mod 1, i / golden ratio + shift_1 mod 1)`: stratified exactly in its first number.
/// Domain: `i < n`, shifts in [0, 1).
#[must_use]
pub fn lattice2(i: usize, n: usize, shift: [f64; 2]) -> [f64; 2] {
    [fract((i as f64 + 0.5) / n as f64 + shift[0]), fract(i as f64 * GOLDEN_STEP + shift[1])]
}

/// Steps of the additive recurrence in four dimensions: `g^-k` for the positive root g of `g^5 = g + 1`
/// [Roberts 2018, the R sequence].
const RECURRENCE4_STEPS: [f64; 4] =
    [0.856_674_883_854_502_9, 0.733_891_856_627_126_2, 0.628_706_721_037_808_6, 0.538_597_257_223_61];

/// Point `i` of an endless sequence that fills the unit hypercube evenly from its first points on, shifted cyclically.
///
/// Domain: shifts in [0, 1).
#[must_use]
pub fn recurrence4(i: usize, shift: [f64; 4]) -> [f64; 4] {
    std::array::from_fn(|k| fract((i as f64 + 0.5) * RECURRENCE4_STEPS[k] + shift[k]))
}

/// A direction with density `cos(theta) / pi` from a point of the unit square.
#[must_use]
pub fn cosine_hemisphere(u: [f64; 2]) -> DVec3 {
    let radius = u[0].sqrt();
    let (sin, cos) = sin_cos(2.0 * PI * u[1]);
    DVec3::new(radius * cos, radius * sin, (1.0 - u[0]).max(0.0).sqrt())
}

/// Direction `i` of `n` spread evenly over the upper hemisphere on a Fibonacci spiral turned by `shift` turns.
///
/// Each stands for itself and its opposite: what is measured along an axis does not depend on its sign.
#[must_use]
pub fn fibonacci_hemisphere(i: usize, n: usize, shift: f64) -> DVec3 {
    let z = (i as f64 + 0.5) / n as f64;
    let radius = (1.0 - z * z).sqrt();
    let (sin, cos) = sin_cos(2.0 * PI * fract(i as f64 * GOLDEN_STEP + shift));
    DVec3::new(radius * cos, radius * sin, z)
}

/// The part of a non-negative number behind the point.
fn fract(x: f64) -> f64 {
    x - x.floor()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every elementary interval of a good set of 144 points holds its share, give or take one.
    #[test]
    fn the_lattice_is_even_in_strips_and_in_squares() {
        let n = 144;
        let points: Vec<[f64; 2]> = (0..n).map(|i| lattice2(i, n, [0.3, 0.9])).collect();
        let inside = |low: [f64; 2], size: [f64; 2]| {
            points.iter().filter(|p| (0..2).all(|k| p[k] >= low[k] && p[k] < low[k] + size[k])).count()
        };
        for i in 0..12 {
            let start = f64::from(i) / 12.0;
            assert!((11..=13).contains(&inside([start, 0.0], [1.0 / 12.0, 1.0])), "column {i}");
            assert!((11..=13).contains(&inside([0.0, start], [1.0, 1.0 / 12.0])), "row {i}");
        }
        for (i, j) in (0..4).flat_map(|i| (0..4).map(move |j| (f64::from(i) / 4.0, f64::from(j) / 4.0))) {
            assert!((7..=11).contains(&inside([i, j], [0.25, 0.25])), "square {i} {j}");
        }
    }

    /// Four dimensions: each half of each axis, and each quadrant of each pair of axes, holds its share.
    #[test]
    fn the_recurrence_fills_its_hypercube_evenly() {
        let n = 256;
        let points: Vec<[f64; 4]> = (0..n).map(|i| recurrence4(i, [0.1, 0.2, 0.3, 0.4])).collect();
        for (a, b) in [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)] {
            for (low_a, low_b) in [(0.0, 0.0), (0.0, 0.5), (0.5, 0.0), (0.5, 0.5)] {
                let inside = |x: f64, low: f64| x >= low && x < low + 0.5;
                let count = points.iter().filter(|p| inside(p[a], low_a) && inside(p[b], low_b)).count();
                assert!((54..=74).contains(&count), "axes {a} {b}, quadrant {low_a} {low_b}: {count}");
            }
        }
    }

    /// `E[z] = 2/3` and `E[x^2] = E[y^2] = 1/4` for the density `cos / pi`.
    #[test]
    fn cosine_samples_have_the_moments_of_the_cosine() {
        let n = 4096;
        let points: Vec<DVec3> = (0..n).map(|i| cosine_hemisphere(lattice2(i, n, [0.0; 2]))).collect();
        let mean = |f: fn(&DVec3) -> f64| points.iter().map(f).sum::<f64>() / n as f64;
        assert!(points.iter().all(|p| (p.length() - 1.0).abs() < 1e-12));
        for (moment, expected) in [
            (mean(|p| p.x), 0.0),
            (mean(|p| p.y), 0.0),
            (mean(|p| p.z), 2.0 / 3.0),
            (mean(|p| p.x * p.x), 0.25),
            (mean(|p| p.y * p.y), 0.25),
            (mean(|p| p.x * p.y), 0.0),
        ] {
            assert!((moment - expected).abs() < 1e-3, "{moment} {expected}");
        }
    }

    /// Of directions spread evenly over the hemisphere, the mean of `d d^T` is a third of the identity.
    #[test]
    fn directions_weigh_all_axes_alike() {
        let n = 256;
        let directions: Vec<DVec3> = (0..n).map(|i| fibonacci_hemisphere(i, n, 0.1)).collect();
        for (a, b) in [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)] {
            let moment = directions.iter().map(|d| d[a] * d[b]).sum::<f64>() / n as f64;
            let expected = if a == b { 1.0 / 3.0 } else { 0.0 };
            assert!((moment - expected).abs() < 5e-3, "{a} {b}: {moment}");
        }
    }
}
