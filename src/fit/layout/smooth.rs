//! Converts an entry of any layout to nine numbers that vary smoothly over a table. Any nine numbers give a valid lobe.
//!
//! Let `S` be the matrix between a lobe and its [`Reflection`], as layout `reflected` stores it. Let `R` be the
//! smallest rotation from +z to the third column of `S`, `(x, y, z)`, of unit length. `S` has the same distribution as
//!
//! ```text
//! S = R | a b 0 |        | a b |   | p |
//!       | b d 0 |,       | b d | = | l q |  times its transpose
//!       | f g 1 |
//! ```
//!
//! Numbers 1 to 3 are `p`, `l` and `q`. Numbers 4 and 5 are `x / (1 + z)` and `y / (1 + z)`, the stereographic
//! projection of the third column. Numbers 6 and 7 are `h f - x a - y b` and `h g - x b - y d` with `h = max(z, 0.05)`.
//! These are the last row of `S`, unless the third column is nearly horizontal. Numbers 8 and 9 are the two terms as
//! layout `reflected` stores them.
//!
//! For layouts that store the lobe itself, the last row is divided by `alpha / (alpha + 0.002)`. Between two views, a
//! lookup in such a layout blends matrices of lobes that are many widths apart. The effect of the last row grows with
//! this distance, so sharper surfaces need a finer last row. A decoder needs only products, quotients and square roots.
//! The determinant is `p^2 q^2` and stays positive for all numbers.
//!
//! A small change of any number moves the lobe by about the same fraction of its width, everywhere in the table. One
//! rounding step therefore suits all entries.

use glam::{DMat3, DVec3};

use super::{Layout, precision::Precision, reflection::Reflection, rules::LobeNumbers, spacing::within_limits};
use crate::{
    axes::PerAxis,
    brdf::{LobeTerms, Mirrors},
    lobe::ltc::turned,
    math::rotation_from_z,
};

/// The number of smooth numbers of an entry.
pub(crate) const SMOOTH_NUMBERS: usize = 9;
/// The smallest `p` and `q`, which keeps determinants positive. No fitted lobe is narrower than the square of this
/// value times the width of its reflection.
const LEAST_ROOT: f64 = 0.004;
/// The smallest value of `h`, the divisor of the last row.
const LEAST_HEIGHT: f64 = 0.05;
/// The roughness at which the factor of the last row is one half, in layouts that store the lobe itself. For smoother
/// surfaces it falls towards zero.
const SHARP: f64 = 0.002;

impl Layout {
    /// The factor of the last row of a lobe at roughness `alpha`.
    fn row_scale(self, alpha: f64) -> f64 {
        if self.is_relative() { 1.0 } else { alpha / (alpha + SHARP) }
    }

    /// The smooth numbers of an entry that this layout stores at a node. They are not finite if the stored matrix is
    /// singular or the amplitude is zero.
    pub(crate) fn to_smooth(self, node: &PerAxis<f64>, stored: &LobeNumbers) -> [f64; SMOOTH_NUMBERS] {
        let place = within_limits(*node);
        let LobeNumbers { matrix, terms } = if self.is_relative() {
            *stored
        } else {
            let lobe = self.rules().restore(&place, stored);
            Self::Reflected.rules().store(&place, &lobe, Mirrors::of(place.view()), Precision::F32)
        };
        let matrix = matrix * (1.0 / matrix.z_axis.length());
        let DVec3 { x, y, z } = matrix.z_axis;
        let local = turned(rotation_from_z(matrix.z_axis).transpose() * matrix);
        let (a, b, d) = (local.x_axis.x, local.y_axis.x, local.y_axis.y);
        let (f, g) = (local.x_axis.z, local.y_axis.z);
        let p = a.sqrt();
        let l = b / p;
        let height = z.max(LEAST_HEIGHT);
        let scale = self.row_scale(place.alpha);
        [
            p,
            l,
            (d - l * l).max(0.0).sqrt(),
            x / (1.0 + z),
            y / (1.0 + z),
            (height * f - x * a - y * b) / scale,
            (height * g - x * b - y * d) / scale,
            terms.amplitude,
            terms.fresnel,
        ]
    }

    /// The numbers that this layout stores at a node: the inverse of [`Self::to_smooth`]. Up to rounding, finite
    /// numbers give a matrix with a positive determinant and with the zeros of the node's symmetries.
    pub(crate) fn of_smooth(self, node: &PerAxis<f64>, numbers: &[f64; SMOOTH_NUMBERS]) -> LobeNumbers {
        let place = within_limits(*node);
        let mirrors = Mirrors::of(place.view());
        let [p, mut l, q, mut across, mut along, mut row_x, mut row_y, amplitude, fresnel] = *numbers;
        if mirrors.x {
            (l, across, row_x) = (0.0, 0.0, 0.0);
        }
        if mirrors.y {
            (l, along, row_y) = (0.0, 0.0, 0.0);
        }
        let scale = self.row_scale(place.alpha);
        let [row_x, row_y] = [row_x, row_y].map(|x| scale * x);
        let [across, along] = [across, along].map(|x: f64| x.clamp(-1.0, 1.0));
        let (p, q) = (p.max(LEAST_ROOT), q.max(LEAST_ROOT));
        let (a, b, d) = (p * p, p * l, l * l + q * q);
        let square = across * across + along * along;
        let (x, y, z) = (2.0 * across / (1.0 + square), 2.0 * along / (1.0 + square), (1.0 - square) / (1.0 + square));
        let height = z.max(LEAST_HEIGHT);
        let (f, g) = ((row_x + x * a + y * b) / height, (row_y + x * b + y * d) / height);
        let local = DMat3::from_cols(DVec3::new(a, b, f), DVec3::new(b, d, g), DVec3::Z);
        let reflected = LobeNumbers {
            matrix: turned(rotation_from_z(DVec3::new(x, y, z)) * local),
            terms: LobeTerms { amplitude: amplitude.max(0.0), fresnel },
        };
        if self.is_relative() {
            return reflected;
        }
        let reflection = Reflection::at(&place);
        let lobe =
            LobeNumbers { matrix: reflection.matrix * reflected.matrix, terms: reflection.terms(reflected.terms) };
        let stored = self.rules().store(&place, &lobe, mirrors, Precision::F32);
        LobeNumbers { matrix: stored.matrix * (1.0 / self.rules().norm(&stored.matrix)), ..stored }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use proptest::prelude::*;

    use super::*;

    fn places() -> impl Strategy<Value = PerAxis<f64>> {
        let phi = prop_oneof![Just(0.0), Just(FRAC_PI_2), 0.0..FRAC_PI_2];
        (prop_oneof![Just(0.0), 1e-3..1.0], 0.01..1.0, prop_oneof![Just(0.0), Just(FRAC_PI_2), 0.0..1.5], phi)
            .prop_map(|(alpha, ratio, theta, phi)| PerAxis { alpha, ratio, theta, phi })
    }

    proptest! {
        /// Converts smooth numbers to stored numbers and back.
        #[test]
        fn numbers_round_trip(
            mut place in places(), layout in prop::sample::select(Layout::ALL),
            numbers in (0.3..2.0, -0.5..0.5, 0.3..2.0, -0.3..0.3, -0.3..0.3, -0.4..0.4, -0.4..0.4, 0.2..1.0, 0.0..0.2),
        ) {
            let (p, l, q, across, along, row_x, row_y, amplitude, fresnel) = numbers;
            let mut numbers = [p, l, q, across, along, row_x, row_y, amplitude, fresnel];
            if layout != Layout::Reflected {
                // The other layouts clamp their numbers near the horizon and the smallest roughness.
                (place.alpha, place.theta) = (place.alpha.max(0.01), place.theta.min(1.2));
            }
            if layout.only_ranges().is_some() {
                (place.ratio, place.phi) = (1.0, 0.0);
                // These layouts can store only matrices with a positive diagonal, as the matrices of lobes have.
                numbers[5] *= 0.1 * place.alpha;
            }
            let mirrors = Mirrors::of(within_limits(place).view());
            let zero: &[usize] = match (mirrors.x, mirrors.y) {
                (true, true) => &[1, 3, 4, 5, 6],
                (true, false) => &[1, 3, 5],
                (false, true) => &[1, 4, 6],
                (false, false) => &[],
            };
            for i in zero {
                numbers[*i] = 0.0;
            }
            let stored = layout.of_smooth(&place, &numbers);
            prop_assert!(stored.matrix.determinant() > 0.0);
            let again = layout.to_smooth(&place, &stored);
            for (i, (one, other)) in numbers.iter().zip(&again).enumerate() {
                prop_assert!((one - other).abs() < 1e-5 * (1.0 + one.abs()), "{layout} {i}: {one} {other}");
            }
        }

        #[test]
        fn any_numbers_make_a_lobe(
            place in places(), numbers in prop::array::uniform9(-3.0..3.0),
        ) {
            let stored = Layout::Reflected.of_smooth(&place, &numbers);
            prop_assert!(stored.matrix.is_finite() && stored.matrix.determinant() > 0.0, "{stored:?}");
        }
    }
}
