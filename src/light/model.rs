//! The models of reflection, and their common answer.

use std::f64::consts::FRAC_PI_2;

use glam::DVec3;

use super::{
    AreaLight, LightError,
    gaussians::{self, Gaussian, Warp},
    normals::{WeightRule, reflected},
};
use ltcforge_fit::{Configuration, LEAST_ALPHA, math::direction, named_list};

named_list! {
    /// How the light that a surface reflects is found.
    pub enum LightModel {
        /// The closed form in the space of normals, without a table.
        Normals = "normals",
        /// A table of LTCs.
        Ltc = "ltc",
        /// A spherical Gaussian, without a table.
        Sg = "sg",
        /// An anisotropic spherical Gaussian, without a table.
        Asg = "asg",
    }
}

impl LightModel {
    /// The Gaussian that a model lights by; `None` for the others.
    #[must_use]
    pub fn gaussian(self) -> Option<Gaussian> {
        match self {
            Self::Sg => Some(Gaussian::Sg),
            Self::Asg => Some(Gaussian::Asg),
            Self::Normals | Self::Ltc => None,
        }
    }
}

impl From<Gaussian> for LightModel {
    fn from(gaussian: Gaussian) -> Self {
        match gaussian {
            Gaussian::Sg => Self::Sg,
            Gaussian::Asg => Self::Asg,
        }
    }
}

/// What GGX reflects of a light of radiance one towards the viewer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reflected {
    /// For a Fresnel factor of one: in [0, 1].
    pub energy: f64,
    /// The same weighed by Schlick's `(1 - wo . h)^5`: in [0, 1].
    pub fresnel: f64,
}

impl Reflected {
    /// Nothing.
    pub const NONE: Self = Self { energy: 0.0, fresnel: 0.0 };

    /// What is reflected by Schlick's Fresnel factor, `f0` face on and `f90` at grazing incidence:
    /// `f0 (energy - fresnel) + f90 fresnel`.
    #[must_use]
    pub fn schlick(&self, f0: f64, f90: f64) -> f64 {
        f0 * (self.energy - self.fresnel) + f90 * self.fresnel
    }
}

/// A surface's roughnesses along x and y, raised to [`LEAST_ALPHA`], and the direction from which it is seen.
pub(super) fn surface_and_view(at: &Configuration) -> Result<([f64; 2], DVec3), LightError> {
    for (what, value) in [("alpha_x", at.alpha_x), ("alpha_y", at.alpha_y)] {
        if !(0.0..=1.0).contains(&value) {
            return Err(LightError::Domain { what, value, allowed: "roughness is a number from 0 to 1" });
        }
    }
    if !(0.0..FRAC_PI_2).contains(&at.theta) {
        let allowed = "a polar angle is a number from 0 to below pi/2";
        return Err(LightError::Domain { what: "theta", value: at.theta, allowed });
    }
    if !at.phi.is_finite() {
        return Err(LightError::Domain { what: "phi", value: at.phi, allowed: "an azimuth is a finite number" });
    }
    Ok(([at.alpha_x.max(LEAST_ALPHA), at.alpha_y.max(LEAST_ALPHA)], direction(at.theta, at.phi)))
}

/// What a surface reflects of a light by the closed form in the space of normals, in f64. Shapes are lit as the
/// polygons that [`ShapedLight::outline`](super::ShapedLight::outline) tells.
///
/// # Errors
/// [`LightError::Domain`] for a roughness outside [0, 1] or a view direction on or below the horizon, and those of the outline.
pub fn by_normals<'a>(
    at: &Configuration,
    light: impl Into<AreaLight<'a>>,
    rule: WeightRule,
) -> Result<Reflected, LightError> {
    let (alpha, wo) = surface_and_view(at)?;
    let (vertices, sides) = light.into().polygon()?;
    let [energy, fresnel] = reflected(alpha, wo.to_array(), &vertices, sides, rule);
    Ok(Reflected { energy, fresnel })
}

/// What a surface reflects of a light by a Gaussian, in f64. Shapes are lit as by [`by_normals`].
///
/// # Errors
/// As [`by_normals`].
pub fn by_gaussian<'a>(
    at: &Configuration,
    light: impl Into<AreaLight<'a>>,
    gaussian: Gaussian,
) -> Result<Reflected, LightError> {
    by_warp(at, light, gaussian, Warp::Visible)
}

/// As [`by_gaussian`], by the Gaussian of a warp.
pub(super) fn by_warp<'a>(
    at: &Configuration,
    light: impl Into<AreaLight<'a>>,
    gaussian: Gaussian,
    warp: Warp,
) -> Result<Reflected, LightError> {
    let (alpha, wo) = surface_and_view(at)?;
    let (vertices, sides) = light.into().polygon()?;
    let [energy, fresnel] = gaussians::reflected_around(warp, gaussian, (alpha, wo.to_array()), &vertices, sides);
    Ok(Reflected { energy, fresnel })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn schlicks_factor_goes_from_f0_to_f90() {
        let parts = Reflected { energy: 0.5, fresnel: 0.125 };
        assert_eq!(parts.schlick(1.0, 1.0), 0.5);
        assert_eq!(parts.schlick(0.0, 1.0), 0.125);
        assert_eq!(parts.schlick(1.0, 0.0), 0.375);
    }

    #[test]
    fn what_has_no_reflection_is_refused() {
        let good = Configuration { alpha_x: 0.3, alpha_y: 0.3, theta: 0.8, phi: 0.0 };
        assert!(surface_and_view(&good).is_ok());
        let (alpha, _) = surface_and_view(&Configuration { alpha_x: 0.0, ..good }).expect("a mirror");
        assert_eq!(alpha, [LEAST_ALPHA, 0.3]);
        let wrong = [
            ("alpha_x", Configuration { alpha_x: 1.5, ..good }),
            ("alpha_y", Configuration { alpha_y: f64::NAN, ..good }),
            ("theta", Configuration { theta: FRAC_PI_2, ..good }),
            ("theta", Configuration { theta: f64::NAN, ..good }),
            ("phi", Configuration { phi: f64::INFINITY, ..good }),
        ];
        for (name, at) in wrong {
            let refused = surface_and_view(&at);
            assert!(matches!(refused, Err(LightError::Domain { what, .. }) if what == name), "{at:?}: {refused:?}");
        }
    }
}
