//! Low-discrepancy point sets and their maps to hemispheres.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

use glam::DVec3;

use super::sin_cos;

/// 1 / golden ratio. Multiples of this step cover a circle most evenly.
const GOLDEN_STEP: f64 = 0.618_033_988_749_894_9;

/// A lattice of points that covers the unit square evenly. It also covers the torus evenly, with opposite sides joined.
///
/// Point `i` of `n` is `((i + 1/2) / n + shift_0 mod 1, ((g i mod n) + 1/2) / n + shift_1 mod 1)`. Both numbers are
/// stratified exactly. The generator `g` has no common factor with `n` and is near `n` divided by the golden ratio. Of
/// all such numbers, it is the one whose continued fraction of `g / n` has the smallest sum of quotients, which bounds
/// the discrepancy [Niederreiter 1992, theorem 5.17]. If `n` is a Fibonacci number, `g` is the Fibonacci number before
/// it, and the lattice is the Fibonacci lattice.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lattice {
    count: usize,
    generator: usize,
    shift: [f64; 2],
}

impl Lattice {
    /// Candidates for the generator on each side of `n` divided by the golden ratio.
    const SEARCH: usize = 32;

    /// `count` points, shifted cyclically. Domain: `1 <= count < 2^32`, shifts in [0, 1).
    #[must_use]
    pub fn new(count: usize, shift: [f64; 2]) -> Self {
        let golden = (count as f64 * GOLDEN_STEP) as usize;
        let candidates = golden.saturating_sub(Self::SEARCH).max(1)..=(golden + Self::SEARCH).min(count.max(1));
        let quality = |g: &usize| quotient_sum(*g, count).map_or((usize::MAX, 0), |sum| (sum, g.abs_diff(golden)));
        Self { count, generator: candidates.min_by_key(quality).unwrap_or(1), shift }
    }

    /// Number of points.
    #[must_use]
    #[expect(clippy::len_without_is_empty, reason = "a lattice is never empty")]
    pub fn len(self) -> usize {
        self.count
    }

    /// The points, ordered by their first coordinate before the shift.
    pub fn points(self) -> impl Iterator<Item = [f64; 2]> {
        let at = move |i: usize, shift: f64| fract((i as f64 + 0.5) / self.count as f64 + shift);
        (0..self.count).map(move |i| [at(i, self.shift[0]), at(i * self.generator % self.count, self.shift[1])])
    }
}

/// The sum of the quotients of the continued fraction of `g / n`; `None` if the two have a common factor.
fn quotient_sum(g: usize, n: usize) -> Option<usize> {
    let (mut larger, mut smaller, mut sum) = (n, g, 0);
    while smaller > 0 {
        sum += larger / smaller;
        (larger, smaller) = (smaller, larger % smaller);
    }
    (larger == 1).then_some(sum)
}

/// Steps of the additive recurrence in four dimensions: `g^-k` for the positive root g of `g^5 = g + 1`
/// [Roberts 2018, the R sequence].
const RECURRENCE4_STEPS: [f64; 4] =
    [0.856_674_883_854_502_9, 0.733_891_856_627_126_2, 0.628_706_721_037_808_6, 0.538_597_257_223_61];

/// Point `i` of an infinite sequence, shifted cyclically. Its first points already cover the unit hypercube evenly.
///
/// Domain: shifts in [0, 1).
#[must_use]
pub fn recurrence4(i: usize, shift: [f64; 4]) -> [f64; 4] {
    std::array::from_fn(|k| fract((i as f64 + 0.5) * RECURRENCE4_STEPS[k] + shift[k]))
}

/// A point of the unit square with the sine and cosine of its first coordinate, taken as a fraction of a turn. Samplers
/// use sine and cosine for every lobe.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SquarePoint {
    /// The point, both coordinates in [0, 1).
    pub u: [f64; 2],
    /// `sin(2 pi u_0)`.
    pub sin: f64,
    /// `cos(2 pi u_0)`.
    pub cos: f64,
}

impl SquarePoint {
    /// The point `u`.
    #[must_use]
    pub fn new(u: [f64; 2]) -> Self {
        let (sin, cos) = sin_cos(2.0 * PI * u[0]);
        Self { u, sin, cos }
    }
}

/// A direction with density `cos(theta) / pi` from a point of the unit square.
#[must_use]
pub fn cosine_hemisphere(u: [f64; 2]) -> DVec3 {
    let radius = u[0].sqrt();
    let (sin, cos) = sin_cos(2.0 * PI * u[1]);
    DVec3::new(radius * cos, radius * sin, (1.0 - u[0]).max(0.0).sqrt())
}

/// A direction with density `cos(theta) / pi` from a point of the unit square, by the concentric map from the square to
/// the disk below the hemisphere [Shirley and Chiu 1997].
#[must_use]
pub fn concentric_cosine([u, v]: [f64; 2]) -> DVec3 {
    let (a, b) = (2.0 * u - 1.0, 2.0 * v - 1.0);
    let (radius, azimuth) = if a * a > b * b {
        (a, FRAC_PI_4 * (b / a))
    } else if b == 0.0 {
        (0.0, 0.0)
    } else {
        (b, FRAC_PI_2 - FRAC_PI_4 * (a / b))
    };
    let (sin, cos) = sin_cos(azimuth);
    DVec3::new(radius * cos, radius * sin, (1.0 - radius * radius).max(0.0).sqrt())
}

/// Direction `i` of `n` on a Fibonacci spiral that covers the upper hemisphere evenly, turned by `shift` turns.
///
/// Each direction represents its opposite too, because a distance along an axis does not depend on the sign of the
/// axis.
#[must_use]
pub fn fibonacci_hemisphere(i: usize, n: usize, shift: f64) -> DVec3 {
    let z = (i as f64 + 0.5) / n as f64;
    let radius = (1.0 - z * z).sqrt();
    let (sin, cos) = sin_cos(2.0 * PI * fract(i as f64 * GOLDEN_STEP + shift));
    DVec3::new(radius * cos, radius * sin, z)
}

/// The fractional part of a non-negative number.
fn fract(x: f64) -> f64 {
    x - x.floor()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each strip and each square contains about its share of the 144 points.
    #[test]
    fn the_lattice_is_even_in_strips_and_in_squares() {
        let n = 144;
        let points: Vec<[f64; 2]> = Lattice::new(n, [0.3, 0.9]).points().collect();
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

    #[test]
    fn the_lattice_of_a_fibonacci_number_is_fibonacci_s() {
        for (n, before) in [(144, 89), (610, 377), (2584, 1597)] {
            assert_eq!(Lattice::new(n, [0.0; 2]).generator, before);
        }
    }

    #[test]
    fn both_numbers_are_stratified_for_every_count() {
        for n in (1..200).chain([512, 1000, 1024, 65_536]) {
            for k in 0..2 {
                let mut strata: Vec<usize> =
                    Lattice::new(n, [0.0; 2]).points().map(|point| (point[k] * n as f64) as usize).collect();
                strata.sort_unstable();
                assert!(strata.into_iter().eq(0..n), "{n}");
            }
        }
    }

    /// In four dimensions, each half of each axis and each quadrant of each pair of axes contains its share.
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
        let points: Vec<DVec3> = Lattice::new(n, [0.0; 2]).points().map(cosine_hemisphere).collect();
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

    /// The mean of `d d^T` over evenly spaced directions of the hemisphere is a third of the identity.
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
