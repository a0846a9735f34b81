//! The curve from the numbers in a file to linear numbers.

use std::fmt;

use ltcforge_fit::{math::pow, named_list};

named_list! {
    /// The relation between the numbers of an image file and light.
    pub enum TransferFunction {
        /// Numbers are proportional to light.
        Linear = "linear",
        /// Numbers follow the sRGB curve.
        Srgb = "srgb",
    }
}

/// The curve that decodes the numbers of an image.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Curve {
    /// Numbers are used unchanged.
    Linear,
    /// The sRGB curve [IEC 61966-2-1].
    Srgb,
    /// A power, from the file's gamma.
    Power(f64),
}

impl From<TransferFunction> for Curve {
    fn from(transfer: TransferFunction) -> Self {
        match transfer {
            TransferFunction::Linear => Self::Linear,
            TransferFunction::Srgb => Self::Srgb,
        }
    }
}

impl fmt::Display for Curve {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Linear => f.write_str("linear"),
            Self::Srgb => f.write_str("srgb"),
            Self::Power(power) => write!(f, "power {power:.3}"),
        }
    }
}

impl Curve {
    /// The linear number. Above 1, sRGB continues with the same formula. Domain: numbers of at least zero for `Power`.
    pub(super) fn linear(self, x: f64) -> f64 {
        match self {
            Self::Linear => x,
            Self::Srgb if x <= 0.040_45 => x / 12.92,
            Self::Srgb => pow((x + 0.055) / 1.055, 2.4),
            Self::Power(power) => pow(x, power),
        }
    }

    /// The linear numbers for all integers up to `largest`, which becomes 1.
    pub(super) fn table(self, largest: u16) -> Vec<f32> {
        (0..=largest).map(|x| self.linear(f64::from(x) / f64::from(largest)) as f32).collect()
    }
}
