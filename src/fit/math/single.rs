//! Angles in f32 by plain arithmetic, as in the shaders. Every processor computes the same bits.
//!
//! Graphics drivers can have errors of thousands of ulps in `atan2`, and of 2^-11 in `sin`. The shaders contain these
//! polynomials instead, and this is their CPU copy. Coefficients: Cephes, `atanf`, `sinf` and `cosf`.

use std::f32::consts::{FRAC_PI_2, FRAC_PI_4, PI, TAU};

/// tan(pi / 8). Above this value, the polynomial is evaluated for the difference from pi/4.
const TAN_EIGHTH: f32 = 0.414_213_56;
/// Replaces the length of the zero vector, so that its angle is zero.
const TINY: f32 = 1e-37;

/// The angle of `(x, y)` from +x, in [0, pi]. Error below 4e-7. Domain: `y >= 0`; zero for the zero vector.
#[must_use]
pub fn atan2_upper(y: f32, x: f32) -> f32 {
    let (low, high) = (y.min(x.abs()), y.max(x.abs()));
    let is_far = low > TAN_EIGHTH * high;
    let (top, bottom) = if is_far { (low - high, low + high) } else { (low, high) };
    let t = top / bottom.max(TINY);
    let z = t * t;
    let near = (((0.080_537_44 * z - 0.138_776_85) * z + 0.199_777_1) * z - 0.333_329_5) * z * t + t;
    let eighth = if is_far { near + FRAC_PI_4 } else { near };
    let quarter = if y > x.abs() { FRAC_PI_2 - eighth } else { eighth };
    if x < 0.0 { PI - quarter } else { quarter }
}

/// The angle from +x of a vector in the first quadrant. Error below 4e-7. Twin of `ltc_quadrant`. Domain: vectors other
/// than zero.
#[must_use]
pub fn quadrant(y: f32, x: f32) -> f32 {
    let t = (y - x) / (y + x);
    let z = t * t;
    let tail = ((0.006_811_8 * z - 0.033_604_2) * z + 0.079_623_7) * z - 0.132_333_4;
    FRAC_PI_4 + t * (((tail * z + 0.198_078_2) * z - 0.333_173_7) * z + 0.999_996_1)
}

/// Sine and cosine of `turns` whole turns. Error below 2e-7. Domain: |turns| up to a few thousand.
#[must_use]
pub fn sin_cos_turns(turns: f32) -> (f32, f32) {
    let quarter = (4.0 * turns + 0.5).floor();
    let x = (turns - 0.25 * quarter) * TAU;
    let z = x * x;
    let sin = ((-1.951_529_6e-4 * z + 8.332_161e-3) * z - 0.166_666_55) * z * x + x;
    let cos = ((2.443_315_7e-5 * z - 1.388_731_6e-3) * z + 4.166_664_6e-2) * z * z - 0.5 * z + 1.0;
    match quarter as i32 & 3 {
        0 => (sin, cos),
        1 => (cos, -sin),
        2 => (-sin, -cos),
        _ => (-cos, sin),
    }
}

/// The natural logarithm. Near 1 the relative error is below 3e-7. Elsewhere the absolute error is below 3e-7 times the
/// magnitude of the logarithm. Domain: `x > 0`, not subnormal.
///
/// `x = m 2^e` with `m` in [sqrt(1/2), sqrt 2): `ln x = e ln 2 + 2 artanh((m - 1) / (m + 1))`, by the series of artanh.
#[must_use]
pub(super) fn ln(x: f32) -> f32 {
    // Subtracts the bits of sqrt(1/2), so the exponent bits become e.
    let bits = x.to_bits().wrapping_sub(0x3f35_04f3);
    let exponent = bits.cast_signed() >> 23;
    let m = f32::from_bits((bits & 0x007f_ffff).wrapping_add(0x3f35_04f3));
    let s = (m - 1.0) / (m + 1.0);
    let z = s * s;
    let series = (((0.222_222_22 * z + 0.285_714_3) * z + 0.4) * z + 0.666_666_7) * z * s + 2.0 * s;
    exponent as f32 * std::f32::consts::LN_2 + series
}

/// e to the power `x`. Shaders use the built-in `exp`, which is within `3 + 2 |x|` ulps.
#[must_use]
pub(super) fn exp(x: f32) -> f32 {
    libm::expf(x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_match_the_library() {
        for i in 0..=20_000_u32 {
            let angle = f64::from(i) / 20_000.0 * std::f64::consts::PI;
            let (y, x) = (angle.sin().max(0.0) as f32, angle.cos() as f32);
            let wanted = f64::from(y).atan2(f64::from(x));
            assert!((f64::from(atan2_upper(y * 3.0, x * 3.0)) - wanted).abs() < 4e-7, "{angle}");
        }
        assert_eq!(atan2_upper(0.0, 0.0), 0.0);
        assert_eq!(atan2_upper(0.0, -1.0), PI);
    }

    #[test]
    fn logarithms_match_the_library() {
        for i in -40_000..40_000_i32 {
            let x = (f64::from(i) / 1000.0).exp() as f32;
            let wanted = f64::from(x).ln();
            assert!((f64::from(ln(x)) - wanted).abs() < 3e-7 * wanted.abs().max(1e-30), "{x}: {} {wanted}", ln(x));
        }
        assert_eq!(ln(1.0), 0.0);
    }

    #[test]
    fn turns_match_the_library() {
        for i in -20_000..20_000_i32 {
            let turns = i as f32 / 8192.0;
            let (sin, cos) = (f64::from(turns) * std::f64::consts::TAU).sin_cos();
            let found = sin_cos_turns(turns);
            assert!((f64::from(found.0) - sin).abs() < 2e-7 && (f64::from(found.1) - cos).abs() < 2e-7, "{turns}");
        }
    }
}
