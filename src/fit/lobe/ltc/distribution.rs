//! The distribution that a matrix makes from a clamped cosine.

use std::f64::consts::PI;

use glam::{DMat3, DVec3};

use crate::math::cosine_hemisphere;

/// A Linearly Transformed Cosine: directions `M c / |M c|` for `c` with density `max(c.z, 0) / pi` [Heitz et al. 2016].
///
/// For every rotation `R` about z and every flip of x or y, `M R` has the same distribution as `M`. The same is true of
/// `s M` for every `s > 0`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ltc {
    matrix: DMat3,
    inverse: DMat3,
    /// `|det M^-1|`.
    inverse_determinant: f64,
}

impl Ltc {
    /// The distribution of `matrix`; `None` if it is singular or not finite.
    #[must_use]
    pub fn new(matrix: DMat3) -> Option<Self> {
        let determinant = matrix.determinant();
        let inverse = matrix.inverse();
        let regular = determinant != 0.0 && determinant.is_finite() && inverse.is_finite();
        regular.then(|| Self { matrix, inverse, inverse_determinant: 1.0 / determinant.abs() })
    }

    /// The matrix.
    #[must_use]
    pub fn matrix(&self) -> DMat3 {
        self.matrix
    }

    /// The inverse of the matrix.
    #[must_use]
    pub fn inverse(&self) -> DMat3 {
        self.inverse
    }

    /// Density at the unit vector `wi`, per steradian: `D(M^-1 wi / |M^-1 wi|) |det M^-1| / |M^-1 wi|^3` with the
    /// clamped cosine `D(c) = max(c.z, 0) / pi` [KT et al. 2022, equation 7].
    #[must_use]
    pub fn pdf(&self, wi: DVec3) -> f64 {
        let c = self.inverse * wi;
        let length2 = c.length_squared();
        c.z.max(0.0) / PI * self.inverse_determinant / (length2 * length2)
    }

    /// Maps a point of the unit square to a direction [KT et al. 2022, Algorithm 2].
    #[must_use]
    pub fn sample(&self, u: [f64; 2]) -> DVec3 {
        (self.matrix * cosine_hemisphere(u)).normalize()
    }

    /// The point of the unit square that [`Ltc::sample`] maps to `wi`; `None` if the density is zero.
    #[must_use]
    pub fn invert(&self, wi: DVec3) -> Option<[f64; 2]> {
        let c = (self.inverse * wi).normalize();
        let turn = libm::atan2(c.y, c.x) / (2.0 * PI);
        (c.z > 0.0).then_some([c.x * c.x + c.y * c.y, if turn < 0.0 { turn + 1.0 } else { turn }])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Lattice;

    fn skewed() -> DMat3 {
        DMat3::from_cols(DVec3::new(0.5, 0.1, 0.2), DVec3::new(-0.1, 0.3, 0.1), DVec3::new(-0.6, 0.2, 0.8))
    }

    #[test]
    fn the_identity_is_the_clamped_cosine() {
        let ltc = Ltc::new(DMat3::IDENTITY).expect("regular");
        assert!((ltc.pdf(DVec3::Z) - 1.0 / PI).abs() < 1e-15);
        assert_eq!(ltc.pdf(-DVec3::Z), 0.0);
    }

    #[test]
    fn sample_and_invert_round_trip_where_the_density_is_positive() {
        let ltc = Ltc::new(skewed()).expect("regular");
        for u in Lattice::new(100, [0.0, 0.2]).points() {
            let wi = ltc.sample(u);
            assert!(ltc.pdf(wi) > 0.0);
            let back = ltc.invert(wi).expect("above the horizon of cosine space");
            assert!((back[0] - u[0]).abs() < 1e-12 && (back[1] - u[1]).abs() < 1e-12, "{u:?} {back:?}");
        }
        assert_eq!(ltc.invert(-ltc.sample([0.3, 0.3])), None);
    }

    /// The mean of `g(w) / pdf(w)` over samples is the integral of g. Here it is the solid angle of a cap.
    #[test]
    fn pdf_is_the_density_of_the_samples() {
        let ltc = Ltc::new(skewed()).expect("regular");
        let axis = ltc.sample([0.2, 0.6]);
        let n = 1 << 16;
        let cap: f64 = Lattice::new(n, [0.0; 2])
            .points()
            .map(|u| ltc.sample(u))
            .filter(|w| w.dot(axis) > 0.95)
            .map(|w| 1.0 / (ltc.pdf(w) * n as f64))
            .sum();
        assert!((cap / (2.0 * PI * 0.05) - 1.0).abs() < 5e-3, "{cap}");
    }

    #[test]
    fn rotation_about_z_flip_and_scale_change_nothing() {
        let m = skewed();
        let turn = DMat3::from_rotation_z(0.7);
        let flip = DMat3::from_diagonal(DVec3::new(1.0, -1.0, 1.0));
        let ltc = Ltc::new(m).expect("regular");
        for other in [m * turn, m * flip, m * 3.0] {
            let other = Ltc::new(other).expect("regular");
            for u in Lattice::new(20, [0.0; 2]).points() {
                let w = ltc.sample(u);
                assert!((ltc.pdf(w) / other.pdf(w) - 1.0).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn a_singular_matrix_makes_no_distribution() {
        assert_eq!(Ltc::new(DMat3::from_diagonal(DVec3::new(1.0, 0.0, 1.0))), None);
        assert_eq!(Ltc::new(DMat3::from_diagonal(DVec3::new(1.0, f64::NAN, 1.0))), None);
    }
}
