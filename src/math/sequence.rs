//! Low-discrepancy point sets and their maps to hemispheres.

use std::f64::consts::PI;

use glam::DVec3;

use super::sin_cos;

/// 1 / golden ratio: the most irrational step on a circle.
const GOLDEN_STEP: f64 = 0.618_033_988_749_894_9;
/// Steps of the R2 sequence: powers of the inverse plastic number [Roberts 2018].
const R2_STEPS: [f64; 2] = [0.754_877_666_246_692_7, 0.569_840_290_998_053_2];

/// Point `i` of the golden lattice of `n` points in the unit square, shifted cyclically by `shift`.
///
/// `u = ((i + 1/2) / n + shift_0 mod 1, i / golden ratio + shift_1 mod 1)`: stratified exactly in its first number.
/// Domain: `i < n`, shifts in [0, 1).
#[must_use]
pub fn lattice2(i: usize, n: usize, shift: [f64; 2]) -> [f64; 2] {
    [fract((i as f64 + 0.5) / n as f64 + shift[0]), fract(i as f64 * GOLDEN_STEP + shift[1])]
}

/// Point `i` of the R2 sequence [Roberts 2018], shifted cyclically by `shift`.
#[must_use]
pub fn r2(i: usize, shift: [f64; 2]) -> [f64; 2] {
    let k = i as f64 + 1.0;
    [fract(k * R2_STEPS[0] + shift[0]), fract(k * R2_STEPS[1] + shift[1])]
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
