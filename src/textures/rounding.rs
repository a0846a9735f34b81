//! Rounding to the number format of a file.

use half::f16;
use serde::Serialize;

use super::{
    halves::{Displacement, neighbours},
    texture::Texture,
};
use ltcforge_fit::Precision;

/// Numbers rounded to a precision. Each f32 is exactly the stored number.
#[derive(Debug, Clone, PartialEq)]
pub struct Rounded {
    /// The number format.
    pub precision: Precision,
    /// The numbers.
    pub numbers: Vec<f32>,
    /// The rounding error.
    pub error: RoundingError,
}

/// The difference between rounded and original numbers. All fields are zero for 32 bits.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct RoundingError {
    /// The largest |rounded - x| / |x| for numbers of at least 2^-14 = 6.1e-5, where halves have 11 bits. It is at most
    /// 2^-11 = 4.9e-4, or 2^-10 for numbers that were rounded together, unless numbers were clamped.
    pub relative: f64,
    /// The largest |rounded - x| for smaller numbers. The step of halves is 2^-24 = 6.0e-8 there.
    pub absolute_of_small: f64,
    /// The number of values above 65504, the largest half. They were clamped to it.
    pub clamped: u64,
    /// The number of nonzero values that would round to zero. They became the smallest half with the same sign.
    pub raised: u64,
    /// The displacement of the table's lobes. Only for textures of a table in 16 bits.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub displacement: Option<Displacement>,
}

impl RoundingError {
    /// Adds the rounding error of a number.
    fn add(&mut self, x: f32, rounded: f32) {
        let (exact, apart) = (f64::from(x).abs(), (f64::from(rounded) - f64::from(x)).abs());
        if x.abs() >= f16::MIN_POSITIVE.to_f32_const() {
            self.relative = self.relative.max(apart / exact);
        } else {
            self.absolute_of_small = self.absolute_of_small.max(apart);
        }
    }

    /// The combined error of two sets of numbers.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        Self {
            relative: self.relative.max(other.relative),
            absolute_of_small: self.absolute_of_small.max(other.absolute_of_small),
            clamped: self.clamped + other.clamped,
            raised: self.raised + other.raised,
            // All textures of one table have the same displacement.
            displacement: match (self.displacement, other.displacement) {
                (Some(one), Some(other)) => {
                    Some(Displacement { mean: one.mean.max(other.mean), max: one.max.max(other.max) })
                }
                (one, other) => one.or(other),
            },
        }
    }
}

/// Rounds finite numbers to the nearest number of a precision, with ties to even. For halves, numbers above the largest
/// half become the largest half, and only zero becomes zero. Therefore small divisors and determinants of a table stay
/// positive.
#[must_use]
pub fn round(numbers: &[f32], precision: Precision) -> Rounded {
    let mut error = RoundingError::default();
    let rounded = match precision {
        Precision::F32 => numbers.to_vec(),
        Precision::F16 => numbers.iter().map(|x| round_to_half(*x, &mut error)).collect(),
    };
    Rounded { precision, numbers: rounded, error }
}

/// Rounds the numbers of a texture. For halves, it uses the halves that were rounded together. If such a half is not a
/// neighbour of its number, the nearest half replaces it.
#[must_use]
pub(super) fn round_texture(texture: &Texture, precision: Precision) -> Rounded {
    let chosen = texture.halves.as_ref().filter(|_| precision == Precision::F16);
    let Some(chosen) = chosen else { return round(&texture.texels, precision) };
    let mut error = RoundingError { displacement: Some(chosen.displacement), ..RoundingError::default() };
    let pairs = texture.texels.iter().zip(&chosen.numbers);
    let numbers = pairs.map(|(x, half)| take_half(*x, *half, &mut error)).collect();
    Rounded { precision, numbers, error }
}

/// The half that was selected for a number. If it is not a neighbour of the number, the nearest half.
fn take_half(x: f32, half: f32, error: &mut RoundingError) -> f32 {
    if neighbours(x).1 != Some(half) {
        return round_to_half(x, error);
    }
    error.add(x, half);
    half
}

fn round_to_half(x: f32, error: &mut RoundingError) -> f32 {
    let nearest = f16::from_f32_const(x);
    let rounded = if nearest.is_infinite() {
        error.clamped += 1;
        f16::MAX.to_f32_const().copysign(x)
    } else if x != 0.0 && nearest.to_f32_const() == 0.0 {
        error.raised += 1;
        f16::MIN_POSITIVE_SUBNORMAL.to_f32_const().copysign(x)
    } else {
        nearest.to_f32_const()
    };
    error.add(x, rounded);
    rounded
}

impl Rounded {
    /// Returns `single` for 32 bits and `half` for 16 bits.
    pub(super) fn either<T>(&self, single: T, half: T) -> T {
        if self.precision == Precision::F32 { single } else { half }
    }

    /// The size of a number in bytes.
    #[must_use]
    pub fn number_bytes(&self) -> usize {
        self.either(4, 2)
    }

    /// The numbers as little-endian bytes, as in files and graphics APIs.
    #[must_use]
    pub fn little_endian(&self) -> Vec<u8> {
        match self.precision {
            Precision::F32 => self.numbers.iter().flat_map(|x| x.to_le_bytes()).collect(),
            Precision::F16 => self.half_bits().flat_map(u16::to_le_bytes).collect(),
        }
    }

    /// The bits of each number as a half. Exact for 16-bit precision.
    pub fn half_bits(&self) -> impl Iterator<Item = u16> {
        self.numbers.iter().map(|x| f16::from_f32_const(*x).to_bits())
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn rounded(x: f32) -> (f32, RoundingError) {
        let Rounded { numbers, error, .. } = round(&[x], Precision::F16);
        (numbers[0], error)
    }

    #[test]
    fn nothing_overflows_or_vanishes() {
        let smallest = 2.0_f32.powi(-24);
        for (x, expected) in [
            (1e9, 65504.0),
            (-70000.0, -65504.0),
            (65519.0, 65504.0),
            (65520.0, 65504.0),
            (1e-30, smallest),
            (-1e-9, -smallest),
            (f32::MIN_POSITIVE / 4.0, smallest),
            (0.0, 0.0),
            (1.0, 1.0),
            (2049.0, 2048.0),
            (2051.0, 2052.0),
        ] {
            assert_eq!(rounded(x).0, expected, "{x}");
        }
        let error = round(&[1e9, 1e-30, 1.0], Precision::F16).error;
        assert_eq!([error.clamped, error.raised], [1, 1]);
        assert!(error.relative > 0.99, "the error must include a clamped number: {error:?}");
        assert_eq!(round(&[1e9, 1e-30], Precision::F32).error, RoundingError::default());
    }

    proptest! {
        #[test]
        fn the_error_is_that_of_eleven_bits(x in prop::num::f32::NORMAL | prop::num::f32::SUBNORMAL) {
            let (half, error) = rounded(x);
            prop_assert!(half.is_finite() && half != 0.0 && half.signum() == x.signum());
            prop_assert_eq!(f16::from_f32_const(half).to_f32_const(), half, "not a half");
            if x.abs() < 65504.0 {
                prop_assert!(error.relative <= 2.0_f64.powi(-11), "{:?}", error);
                prop_assert!(error.absolute_of_small <= 2.0_f64.powi(-24), "{:?}", error);
            }
        }

        #[test]
        fn in_range_the_nearest_half_is_used(x in -60000.0_f32..60000.0) {
            let (half, _) = rounded(x);
            for neighbour in [half.next_up(), half.next_down()] {
                // The bits of both neighbouring halves differ by one.
                let bits = f16::from_f32_const(half).to_bits();
                for bits in [bits.wrapping_add(1), bits.wrapping_sub(1)] {
                    let other = f16::from_bits(bits).to_f32_const();
                    prop_assert!(other.is_nan() || (other - x).abs() >= (half - x).abs() || half == neighbour);
                }
            }
        }
    }
}
