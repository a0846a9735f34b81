//! One lobe for a material, blended from the two lobes of an entry.

use glam::DMat3;

use super::LookedUp;
use crate::{
    brdf::LobeTerms,
    math::{from_row_major, row_major},
};

/// The weight of the second lobe in a material's blend. It is the fraction of the material's light that comes from
/// Schlick's fifth power:
///
/// ```text
/// w = (F90 - F0) fresnel / (F0 amplitude + (F90 - F0) fresnel)
/// ```
///
/// In \[0, 1\]. It is 0 for a material whose F90 is not above F0, and for a material without reflection. Domain: F0 and
/// F90 in \[0, 1\], finite terms.
#[must_use]
pub fn blend_weight(terms: LobeTerms, f0: f64, f90: f64) -> f64 {
    let LobeTerms { amplitude, fresnel } = terms;
    let weighed = (f90 - f0).max(0.0) * fresnel.max(0.0);
    let reflected = f0 * amplitude + weighed;
    if reflected > 0.0 { weighed / reflected } else { 0.0 }
}

/// The matrix of the blended lobe, `(1 - w) M + w M_2`. Both matrices must come from a lookup.
#[must_use]
pub fn blended(first: &DMat3, second: &DMat3, weight: f64) -> DMat3 {
    *first * (1.0 - weight) + *second * weight
}

impl LookedUp {
    /// The same numbers with the matrix of a material's lobe, for this F0 and F90 = 1. If there are two lobes and
    /// terms, the matrix is the blend of both lobes. Otherwise the matrix does not change. Domain: F0 in \[0, 1\].
    #[must_use]
    pub fn blended_for(&self, f0: f64) -> Self {
        let Some((second, (amplitude, fresnel))) = self.second.zip(self.amplitude.zip(self.fresnel)) else {
            return *self;
        };
        let weight = blend_weight(LobeTerms { amplitude, fresnel }, f0, 1.0);
        let matrix = row_major(&blended(&from_row_major(&self.matrix), &from_row_major(&second), weight));
        Self { matrix, ..*self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_weight_is_the_fifth_power_s_part_of_the_light() {
        let terms = LobeTerms { amplitude: 0.9, fresnel: 0.1 };
        assert_eq!(blend_weight(terms, 1.0, 1.0), 0.0);
        assert_eq!(blend_weight(terms, 0.0, 1.0), 1.0);
        assert!((blend_weight(terms, 0.04, 1.0) - 0.096 / (0.036 + 0.096)).abs() < 1e-15);
        for (f0, f90) in [(0.5, 0.2), (0.0, 0.0)] {
            assert_eq!(blend_weight(terms, f0, f90), 0.0);
        }
        assert_eq!(blend_weight(LobeTerms { amplitude: 1.0, fresnel: 0.0 }, 0.0, 1.0), 0.0);
    }

    #[test]
    fn a_blend_goes_from_the_first_to_the_second() {
        let (first, second) = (DMat3::IDENTITY, DMat3::from_diagonal(glam::DVec3::new(0.5, 0.25, 1.0)));
        assert_eq!(blended(&first, &second, 0.0), first);
        assert_eq!(blended(&first, &second, 1.0), second);
        assert_eq!(blended(&first, &second, 0.5).y_axis.y, 0.625);
    }
}
