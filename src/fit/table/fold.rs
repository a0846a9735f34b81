//! Maps any configuration to the domain of a table, and maps its matrix back.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::DMat3;

use crate::axes::{LEAST_ALPHA, PerAxis};

/// A surface's roughness and a view direction, in the surface's tangent frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Configuration {
    /// GGX roughness along x, in [0, 1].
    pub alpha_x: f64,
    /// GGX roughness along y, in [0, 1].
    pub alpha_y: f64,
    /// Polar angle of the view direction, in [0, pi/2].
    pub theta: f64,
    /// Azimuth of the view direction, any finite angle.
    pub phi: f64,
}

impl Configuration {
    /// The equivalent configuration on a table's axes, by symmetry: phi is in the first quadrant.
    #[must_use]
    pub fn folded(&self) -> PerAxis<f64> {
        let Folded { alpha, ratio, phi, .. } = Folded::of(self);
        PerAxis { alpha, ratio, theta: self.theta, phi }
    }
}

/// A configuration with `alpha_x >= alpha_y` and phi in the first quadrant, and the steps that lead back to the
/// original configuration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Folded {
    pub(super) alpha: f64,
    /// Smaller divided by larger roughness; one for a perfect mirror.
    pub(super) ratio: f64,
    pub(super) phi: f64,
    mirror_x: bool,
    mirror_y: bool,
    swap: bool,
}

impl Folded {
    /// Folds a configuration [KT et al. 2022, equations 13 and 15].
    pub(super) fn of(c: &Configuration) -> Self {
        // Whole turns are removed first. The remainder of a tiny negative angle rounds to a whole turn, which folds to
        // zero.
        let turned = c.phi.rem_euclid(2.0 * PI);
        let (phi, mirror_x, mirror_y) = if turned <= FRAC_PI_2 {
            (turned, false, false)
        } else if turned <= PI {
            (PI - turned, true, false)
        } else if turned <= 3.0 * FRAC_PI_2 {
            (turned - PI, true, true)
        } else {
            (2.0 * PI - turned, false, true)
        };
        let [alpha_x, alpha_y] = [c.alpha_x, c.alpha_y].map(|alpha| alpha.max(LEAST_ALPHA));
        let swap = alpha_y > alpha_x;
        let (alpha, smaller) = if swap { (alpha_y, alpha_x) } else { (alpha_x, alpha_y) };
        let ratio = smaller / alpha;
        let phi = if swap { FRAC_PI_2 - phi } else { phi };
        Self { alpha, ratio, phi: phi.clamp(0.0, FRAC_PI_2), mirror_x, mirror_y, swap }
    }

    /// Converts the matrix of the folded configuration to the matrix of the original configuration.
    ///
    /// Each mirror or swap `F` is applied on both sides, `F M F`. The factor on the right does not change the
    /// distribution. It preserves the sign of the determinant, and therefore the winding of light polygons.
    pub(super) fn unfold(&self, mut m: DMat3) -> DMat3 {
        if self.swap {
            (m.x_axis, m.y_axis) = (m.y_axis, m.x_axis);
            for column in [&mut m.x_axis, &mut m.y_axis, &mut m.z_axis] {
                (column.x, column.y) = (column.y, column.x);
            }
        }
        if self.mirror_x {
            (m.x_axis.y, m.x_axis.z) = (-m.x_axis.y, -m.x_axis.z);
            (m.y_axis.x, m.z_axis.x) = (-m.y_axis.x, -m.z_axis.x);
        }
        if self.mirror_y {
            (m.y_axis.x, m.y_axis.z) = (-m.y_axis.x, -m.y_axis.z);
            (m.x_axis.y, m.z_axis.y) = (-m.x_axis.y, -m.z_axis.y);
        }
        m
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use proptest::prelude::*;

    use super::*;
    use crate::brdf::{Brdf, Ggx};

    fn view(theta: f64, phi: f64) -> DVec3 {
        DVec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos())
    }

    /// Any phi within a few turns, including the folds and their neighbours.
    fn any_phi() -> impl Strategy<Value = f64> {
        let fold = (-9_i32..=9, -3_i64..=3).prop_map(|(quarter, ulps)| {
            let angle = f64::from(quarter) * FRAC_PI_2;
            f64::from_bits(angle.to_bits().saturating_add_signed(ulps))
        });
        prop_oneof![-20.0..20.0, fold.prop_filter("finite", |angle| angle.is_finite())]
    }

    proptest! {
        /// The lobe of the folded configuration, mapped by `F`, is the lobe of the original configuration.
        #[test]
        fn unfolding_maps_the_folded_lobe_onto_the_lobe(
            alpha_x in 0.05..1.0, alpha_y in 0.05..1.0, theta in 0.0..1.5, phi in any_phi(), wi_theta in 0.0..1.5, wi_phi in 0.0..6.0,
        ) {
            let c = Configuration { alpha_x, alpha_y, theta, phi };
            let folded = Folded::of(&c);
            prop_assert!((0.0..=FRAC_PI_2).contains(&folded.phi) && (0.0..=1.0).contains(&folded.ratio));
            // Unfolding applies the map F to a matrix's last column.
            let f = |w: DVec3| folded.unfold(DMat3::from_cols(DVec3::ZERO, DVec3::ZERO, w)).z_axis;
            let (wo, wi) = (view(theta, folded.phi), view(wi_theta, wi_phi));
            prop_assert!((f(wo) - view(theta, phi)).length() < 1e-12);
            let small = Ggx { alpha_x: folded.alpha, alpha_y: folded.alpha * folded.ratio }.eval_cos(wo, wi);
            let whole = Ggx { alpha_x, alpha_y }.eval_cos(view(theta, phi), f(wi));
            prop_assert!((small - whole).abs() <= 1e-9 * (1.0 + whole), "{} {}", small, whole);
        }

        #[test]
        fn unfolding_keeps_the_determinant(phi in any_phi(), swap in any::<bool>(), m in prop::array::uniform9(-1.0..1.0)) {
            let (alpha_x, alpha_y) = if swap { (0.1, 0.2) } else { (0.2, 0.1) };
            let folded = Folded::of(&Configuration { alpha_x, alpha_y, theta: 0.5, phi });
            let m = DMat3::from_cols_array(&m);
            prop_assert!((folded.unfold(m).determinant() - m.determinant()).abs() < 1e-12);
        }
    }
}
