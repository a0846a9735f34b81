//! Functions whose results do not depend on the platform.

use std::f64::consts::{FRAC_PI_2, PI};

/// Angles that count as quarter turns, with their exact sine and cosine.
const QUARTER_TURNS: [(f64, f64, f64); 5] =
    [(0.0, 0.0, 1.0), (FRAC_PI_2, 1.0, 0.0), (PI, 0.0, -1.0), (3.0 * FRAC_PI_2, -1.0, 0.0), (2.0 * PI, 0.0, 1.0)];

/// Sine and cosine of an angle in radians.
///
/// The f64 nearest to pi/2 counts as pi/2: its cosine is exactly zero, not 6e-17. The other quarter turns up to a full
/// turn are exact too. The zeros that symmetry requires in a matrix are then exact.
#[must_use]
pub fn sin_cos(angle: f64) -> (f64, f64) {
    for (quarter, sin, cos) in QUARTER_TURNS {
        if angle.abs() == quarter {
            return (if angle < 0.0 { -sin } else { sin }, cos);
        }
    }
    (libm::sin(angle), libm::cos(angle))
}

/// Sine of an angle in radians, exact at quarter turns.
#[must_use]
pub fn sin(angle: f64) -> f64 {
    sin_cos(angle).0
}

/// Cosine of an angle in radians, exact at quarter turns.
#[must_use]
pub fn cos(angle: f64) -> f64 {
    sin_cos(angle).1
}

/// Natural logarithm. Domain: x > 0.
#[must_use]
pub fn ln(x: f64) -> f64 {
    libm::log(x)
}

/// e to the power `x`.
#[must_use]
pub fn exp(x: f64) -> f64 {
    libm::exp(x)
}

/// The cube root of `x`.
#[must_use]
pub fn cbrt(x: f64) -> f64 {
    libm::cbrt(x)
}

/// Complementary error function, `1 - erf(x)`.
#[must_use]
pub fn erfc(x: f64) -> f64 {
    libm::erfc(x)
}

/// `x` to the power `y`. Domain: `x >= 0`.
#[must_use]
pub fn pow(x: f64, y: f64) -> f64 {
    libm::pow(x, y)
}

/// Angle of the point `(x, y)` from the x axis, in (-pi, pi].
#[must_use]
pub fn atan2(y: f64, x: f64) -> f64 {
    libm::atan2(y, x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quarter_turns_are_exact() {
        assert_eq!(sin_cos(FRAC_PI_2), (1.0, 0.0));
        assert_eq!(sin_cos(-FRAC_PI_2), (-1.0, 0.0));
        assert_eq!(sin_cos(PI), (0.0, -1.0));
        assert_eq!(sin_cos(2.0 * PI), (0.0, 1.0));
    }

    /// Compares bits, without a tolerance. If `libm` changes a last bit, tables change.
    #[test]
    fn bits_are_pinned() {
        assert_eq!(sin(1.0).to_bits(), 0x3fea_ed54_8f09_0cee);
        assert_eq!(cos(1.0).to_bits(), 0x3fe1_4a28_0fb5_068c);
        assert_eq!(ln(10.0).to_bits(), 0x4002_6bb1_bbb5_5516);
        assert_eq!(pow(0.5, 1.6).to_bits(), 0x3fd5_1cb4_53b9_536c);
        assert_eq!(exp(1.5).to_bits(), 0x4011_ed3f_e64f_c541);
        assert_eq!(erfc(0.7).to_bits(), 0x3fd4_9ee7_bdd1_d374);
        assert_eq!(atan2(1.0, 2.0).to_bits(), 0x3fdd_ac67_0561_bb4f);
    }
}
