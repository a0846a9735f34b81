//! A first-order approximation of a lobe, known before the fit. Layout `reflected` stores fitted lobes relative to it.

use glam::{DMat3, DVec3};

use crate::{
    axes::PerAxis,
    brdf::{Ggx, LobeTerms},
};

/// A lobe to first order: the reflection at the central visible normal, and the change of the reflected direction as
/// the normal tilts.
///
/// Stretch the surface to a hemisphere. Normals visible from `wo_std = (ax x, ay y, z) / |..|` then lie around the
/// normal halfway between `wo_std` and +z [after Dupuy and Benyoub 2023]. On the original surface this normal is `wm`.
/// It reflects light from `r = 2 d wm - wo`, where `d = wo.wm`. A normal that tilts along a tangent `t` moves the
/// reflected direction along
///
/// ```text
/// J t = 2 ((wo.t') wm + d t'),    t' = t - (wm.t) wm
/// ```
///
/// Normals tilt by about `ax`, so the lobe is near the LTC of `K = [ax J x, ax J y, r]`. For a sharp lobe away from the
/// horizon the LTC is `K diag(1, ay/ax, 1)`. For other lobes the matrix between `K` and the LTC is a smooth function of
/// roughness and view. Both columns have the factor `ax`. With `ay` in the second column, the sideways curvature of a
/// needle-shaped lobe would be stored in units of its vanishing width.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reflection {
    /// `K`.
    pub matrix: DMat3,
    /// `(G2/G1)^2` of `r`, close to the amplitude of a sharp lobe. One factor is the masking at the lobe's centre.
    /// Masking of the lobe's tails removes about as much light again.
    pub amplitude: f64,
    /// `1 - d`. Its fifth power is Schlick's weight for `r`.
    pub grazing: f64,
}

impl Reflection {
    /// The reflection of a surface seen from `wo`. Domain: `ggx.alpha_x > 0`, `wo` of unit length above the horizon.
    /// The determinant of `K` is positive.
    #[must_use]
    pub fn of(ggx: &Ggx, wo: DVec3) -> Self {
        let Ggx { alpha_x, alpha_y } = *ggx;
        let halfway = DVec3::new(alpha_x * wo.x, alpha_y * wo.y, wo.z).normalize() + DVec3::Z;
        let wm = DVec3::new(alpha_x * halfway.x, alpha_y * halfway.y, halfway.z).normalize();
        let d = wo.dot(wm);
        let reflected = 2.0 * d * wm - wo;
        let column = |tangent: DVec3| {
            let tilt = tangent - wm.dot(tangent) * wm;
            2.0 * alpha_x * (wo.dot(tilt) * wm + d * tilt)
        };
        let g2_over_g1 = ggx.g2_over_g1(wo, reflected);
        Self {
            matrix: DMat3::from_cols(column(DVec3::X), column(DVec3::Y), reflected),
            amplitude: g2_over_g1 * g2_over_g1,
            grazing: 1.0 - d,
        }
    }

    /// The reflection of a GGX surface at a point of a table. Lobes of every scattering model are stored relative to
    /// it.
    #[must_use]
    pub fn at(place: &PerAxis<f64>) -> Self {
        let [alpha_x, alpha_y] = place.roughness();
        Self::of(&Ggx { alpha_x, alpha_y }, place.view())
    }

    /// Amplitude and Fresnel term of a lobe from the stored numbers `a` and `s`: `A = a (G2/G1)^2`,
    /// `F = A (s + 1 - d)^5`.
    #[must_use]
    pub(crate) fn terms(&self, stored: LobeTerms) -> LobeTerms {
        let amplitude = stored.amplitude * self.amplitude;
        let grazing = (stored.fresnel + self.grazing).max(0.0);
        let grazing2 = grazing * grazing;
        LobeTerms { amplitude, fresnel: amplitude * (grazing2 * grazing2 * grazing) }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use proptest::prelude::*;

    use super::*;
    use crate::math::sin_cos;

    fn view(theta: f64, phi: f64) -> DVec3 {
        let ((st, ct), (sp, cp)) = (sin_cos(theta), sin_cos(phi));
        DVec3::new(st * cp, st * sp, ct)
    }

    proptest! {
        /// Compares the columns with central differences of the reflected direction.
        #[test]
        fn columns_are_derivatives_of_the_reflection(
            alpha_x in 0.01..1.0, ratio in 0.0..1.0, theta in 0.0..1.55, phi in 0.0..FRAC_PI_2,
        ) {
            let (ggx, wo) = (Ggx { alpha_x, alpha_y: alpha_x * ratio }, view(theta, phi));
            let k = Reflection::of(&ggx, wo).matrix;
            let wm = (wo + k.z_axis).normalize();
            let reflect = |normal: DVec3| 2.0 * wo.dot(normal) * normal - wo;
            for (column, tangent) in [(k.x_axis, DVec3::X), (k.y_axis, DVec3::Y)] {
                let tilt = tangent - wm.dot(tangent) * wm;
                let moved = |by: f64| reflect((wm + by * tilt).normalize());
                let difference = (moved(1e-5) - moved(-1e-5)) / 2e-5;
                prop_assert!((difference * alpha_x - column).length() < 1e-8, "{} {}", difference, column);
            }
        }

        #[test]
        fn it_is_upright_down_to_the_horizon(
            alpha_x in prop_oneof![Just(1e-4), 1e-4..1.0], ratio in prop_oneof![Just(0.0), Just(1.0), 0.0..1.0],
            up in prop_oneof![Just(1e-4), 1e-4..FRAC_PI_2], phi in prop_oneof![Just(0.0), Just(FRAC_PI_2), 0.0..FRAC_PI_2],
        ) {
            let ggx = Ggx { alpha_x, alpha_y: (alpha_x * ratio).max(1e-5) };
            let reflection = Reflection::of(&ggx, view(FRAC_PI_2 - up, phi));
            prop_assert!(reflection.matrix.determinant() > 0.0, "{:?}", reflection);
            prop_assert!((reflection.matrix.z_axis.length() - 1.0).abs() < 1e-12);
            prop_assert!((0.0..=1.0).contains(&reflection.grazing) && (0.0..=1.0).contains(&reflection.amplitude));
        }
    }

    /// The limit of a mirror is `M = [2 ax (v_z x + v_x z), 2 ay (v_z y + v_y z), r]`.
    #[test]
    fn a_sharp_lobe_s_matrix_is_that_of_the_limit() {
        let (ggx, wo) = (Ggx { alpha_x: 1e-6, alpha_y: 1e-6 }, view(0.9, 0.6));
        let k = Reflection::of(&ggx, wo).matrix;
        let limit = DMat3::from_cols(
            2e-6 * (wo.z * DVec3::X + wo.x * DVec3::Z),
            2e-6 * (wo.z * DVec3::Y + wo.y * DVec3::Z),
            DVec3::new(-wo.x, -wo.y, wo.z),
        );
        assert!((k.x_axis - limit.x_axis).length() < 1e-11 && (k.y_axis - limit.y_axis).length() < 1e-11);
        assert!((k.z_axis - limit.z_axis).length() < 1e-5);
    }
}
