//! Numbers as colours.

use crate::picture::{colour, signed_colour};

/// The share of the numbers at each end that is outside the scale. Otherwise one outlier would use up the colours.
const BEYOND: f64 = 0.01;
/// Colours of values below and above the scale. The scale itself does not contain them.
const BELOW: [u8; 3] = [0, 220, 230];
const ABOVE: [u8; 3] = [60, 220, 90];

/// The colours of numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scale {
    low: f32,
    high: f32,
    /// The scale is symmetric about zero, which has the neutral colour.
    is_signed: bool,
}

impl Scale {
    /// A scale that covers all numbers except the few least and greatest. It is signed if `may_be_signed` is true or it
    /// covers numbers below zero. Domain: at least one number.
    #[must_use]
    pub fn of(numbers: &[f32], may_be_signed: bool) -> Self {
        let mut sorted = numbers.to_vec();
        sorted.sort_by(f32::total_cmp);
        let beyond = (sorted.len() as f64 * BEYOND) as usize;
        let (low, high) = (sorted[beyond], sorted[sorted.len() - 1 - beyond]);
        if !may_be_signed && low >= 0.0 {
            return Self { low, high, is_signed: false };
        }
        let most = low.abs().max(high.abs());
        Self { low: -most, high: most, is_signed: true }
    }

    /// The least and the greatest number on the scale.
    #[must_use]
    pub fn ends(&self) -> [f32; 2] {
        [self.low, self.high]
    }

    /// The colour of a number.
    #[must_use]
    pub fn colour(&self, value: f32) -> [u8; 3] {
        let span = self.high - self.low;
        match value {
            _ if value < self.low => BELOW,
            _ if value > self.high => ABOVE,
            _ if span > 0.0 => self.colours()((value - self.low) / span),
            _ if self.is_signed => signed_colour(0.0),
            _ => colour(0.0),
        }
    }

    /// The colours of the scale, from 0 at its lower end to 1 at its upper end.
    #[must_use]
    pub fn colours(&self) -> fn(f32) -> [u8; 3] {
        if self.is_signed { |part| signed_colour(2.0 * part - 1.0) } else { colour }
    }

    /// The label under the middle of the colour bar.
    #[must_use]
    pub fn middle(&self) -> Vec<&'static str> {
        if self.is_signed { vec!["0"] } else { Vec::new() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zero_has_one_colour_on_every_signed_scale() {
        let grey = signed_colour(0.0);
        let lopsided = Scale::of(&[-0.5, 0.0, 0.1, 3.0], false);
        assert_eq!(lopsided, Scale { low: -3.0, high: 3.0, is_signed: true });
        for scale in [lopsided, Scale::of(&[0.0, 2.0], true), Scale::of(&[0.0; 4], true)] {
            assert_eq!(scale.colour(0.0), grey, "{scale:?}");
        }
        assert_eq!([lopsided.colour(-3.1), lopsided.colour(3.1)], [BELOW, ABOVE]);
        assert_ne!(lopsided.colour(-0.5), lopsided.colour(0.5));
        assert_eq!(Scale::of(&[2.0; 3], false).colour(2.0), colour(0.0));
    }
}
