//! The number types of light integrals: f64 for the library, f32 as in the shaders.
//!
//! A light integral is written once for both types. The f64 version belongs to the library, and the f32 version is the
//! shader's CPU twin.

use std::{
    fmt::Debug,
    ops::{Add, Div, Mul, Neg, Sub},
};

use super::{atan2, atan2_upper, exp, ln, single};

/// The number type of a light integral.
pub trait Scalar:
    Copy
    + Debug
    + PartialOrd
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// Zero.
    const ZERO: Self;
    /// One.
    const ONE: Self;
    /// 2 pi, a full turn in radians.
    const TAU: Self;
    /// The smallest length at which a vector has a direction.
    const SHORTEST: Self;
    /// Two directions are equal up to rounding if their squared distance is below this.
    const SAME2: Self;
    /// The number of Newton steps from three digits to the precision of the type.
    const NEWTON_STEPS: u32;
    /// The rounding error of numbers near one after a few operations.
    const UNCERTAINTY: Self;
    /// The nearest value of this type.
    #[must_use]
    fn of(x: f64) -> Self;
    /// The square root.
    #[must_use]
    fn sqrt(self) -> Self;
    /// The natural logarithm. Domain: `self > 0`, not subnormal.
    #[must_use]
    fn ln(self) -> Self;
    /// e to the power of the number; zero for very negative numbers.
    #[must_use]
    fn exp(self) -> Self;
    /// The angle of `(x, y)` from +x, in [0, pi]. Domain: `y >= 0`.
    #[must_use]
    fn atan2_upper(y: Self, x: Self) -> Self;

    /// The angle of `(x, y)` from +x, in [-pi, pi].
    #[must_use]
    fn atan2(y: Self, x: Self) -> Self {
        let upper = Self::atan2_upper(y.abs(), x);
        if y < Self::ZERO { -upper } else { upper }
    }
    /// The absolute value.
    #[must_use]
    fn abs(self) -> Self {
        if self < Self::ZERO { -self } else { self }
    }
    /// The larger of two numbers; `other` if `self` is NaN.
    #[must_use]
    fn max(self, other: Self) -> Self {
        if self > other { self } else { other }
    }
    /// The smaller of two numbers; `other` if `self` is NaN.
    #[must_use]
    fn min(self, other: Self) -> Self {
        if self < other { self } else { other }
    }
}

impl Scalar for f64 {
    const ZERO: Self = 0.0;
    const ONE: Self = 1.0;
    const TAU: Self = std::f64::consts::TAU;
    const SHORTEST: Self = 1e-150;
    const SAME2: Self = 1e-30;
    const NEWTON_STEPS: u32 = 3;
    const UNCERTAINTY: Self = 1e-13;
    fn of(x: f64) -> Self {
        x
    }
    fn sqrt(self) -> Self {
        self.sqrt()
    }
    fn ln(self) -> Self {
        ln(self)
    }
    fn exp(self) -> Self {
        exp(self)
    }
    fn atan2_upper(y: Self, x: Self) -> Self {
        atan2(y, x)
    }
}

impl Scalar for f32 {
    const ZERO: Self = 0.0;
    const ONE: Self = 1.0;
    const TAU: Self = std::f32::consts::TAU;
    const SHORTEST: Self = 1e-18;
    const SAME2: Self = 1e-14;
    const NEWTON_STEPS: u32 = 1;
    const UNCERTAINTY: Self = 1e-6;
    fn of(x: f64) -> Self {
        x as Self
    }
    fn sqrt(self) -> Self {
        self.sqrt()
    }
    fn ln(self) -> Self {
        single::ln(self)
    }
    fn exp(self) -> Self {
        single::exp(self)
    }
    fn atan2_upper(y: Self, x: Self) -> Self {
        atan2_upper(y, x)
    }
}
