//! The trait of models of light, and their common parts: surface checks and reflected light.

use std::f64::consts::FRAC_PI_2;

use glam::DVec3;

use super::{AreaLight, LightError, ltc::FormulaLobe, normals::NormalsRule};
use ltcforge_fit::{
    Configuration, LEAST_ALPHA, LobeModel, Sides,
    brdf::{edge_of_parts, f82_light},
    math::{Triple, direction},
};

/// A model of light: a formula, tables of a lobe model, or both.
pub(crate) trait ModelOfLight: Sync {
    /// The formula for the light of GGX; `None` for a model that only works with a table.
    fn formula(&self) -> Option<&dyn Formula> {
        None
    }

    /// The lobe model of its tables; `None` for a model without tables.
    fn lobe(&self) -> Option<LobeModel> {
        None
    }

    /// The cost of a pixel with a table, in samples of the preview's reference.
    fn table_cost(&self) -> u32 {
        0
    }
}

/// The light of GGX in closed form.
pub(crate) trait Formula: Sync {
    /// The choices of option `--rule`, the default first; empty for a formula without the option.
    fn choices(&self) -> &'static [NormalsRule] {
        &[]
    }

    /// The cost of a pixel, in samples of the preview's reference.
    fn cost(&self) -> u32;

    /// The LTC for this reflectance at normal and at grazing incidence; `None` if the model is not an LTC. An LTC is
    /// integrated exactly over every shape.
    fn lobe(&self, _alpha: [f64; 2], _wo: Triple<f64>, _fresnel: [f64; 2]) -> Option<FormulaLobe<f64>> {
        None
    }

    /// The reflected light of a polygon of radiance one, for a Fresnel factor of one and weighted by Schlick's
    /// `(1 - wo . h)^5`.
    fn reflected(&self, lit: &LitPoint<'_, f64>, rule: NormalsRule) -> [f64; 2];

    /// The reflected light weighted by F82's edge weight. By default, the edge weight is evaluated at the angle of
    /// incidence that follows from Schlick's part.
    fn edge(&self, lit: &LitPoint<'_, f64>, rule: NormalsRule) -> f64 {
        edge_of_parts(self.reflected(lit, rule))
    }

    /// The reflected light in f32, as in a shader.
    fn reflected_f32(&self, lit: &LitPoint<'_, f32>, rule: NormalsRule) -> [f32; 2];
}

/// A surface, a view of it, and the vertices of a light relative to the shaded point, in its tangent frame.
#[derive(Debug, Clone, Copy)]
pub struct LitPoint<'a, T> {
    /// Roughness along x and y.
    pub alpha: [T; 2],
    /// The view direction, of unit length.
    pub wo: Triple<T>,
    /// The vertices of a convex polygon.
    pub vertices: &'a [Triple<T>],
    /// The lit sides.
    pub sides: Sides,
}

/// The light that GGX reflects towards the viewer, from a light of radiance one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReflectedLight {
    /// The light for a Fresnel factor of one, in [0, 1].
    pub energy: f64,
    /// The light weighted by Schlick's `(1 - wo . h)^5`, in [0, 1].
    pub fresnel: f64,
}

impl ReflectedLight {
    /// No light.
    pub const NONE: Self = Self { energy: 0.0, fresnel: 0.0 };

    /// The reflected light with Schlick's Fresnel factor, `f0` at normal and `f90` at grazing incidence:
    /// `f0 (energy - fresnel) + f90 fresnel`.
    #[must_use]
    pub fn schlick(&self, f0: f64, f90: f64) -> f64 {
        f0 * (self.energy - self.fresnel) + f90 * self.fresnel
    }

    /// The light that a metal with the F82 factor reflects, see [`f82_light`]. `edge` is the light weighted by
    /// [`edge_weight`](ltcforge_fit::brdf::edge_weight). At 82 degrees the factor is `tint` times Schlick's factor.
    #[must_use]
    pub fn metal(&self, edge: f64, [f0, f90]: [f64; 2], tint: f64) -> f64 {
        f82_light(self.schlick(f0, f90), edge, [f0, f90], tint)
    }
}

/// Checks a surface and view. Returns the roughnesses along x and y, raised to [`LEAST_ALPHA`], and the view direction.
pub(super) fn surface_and_view(at: &Configuration) -> Result<([f64; 2], DVec3), LightError> {
    for (what, value) in [("alpha_x", at.alpha_x), ("alpha_y", at.alpha_y)] {
        if !(0.0..=1.0).contains(&value) {
            return Err(LightError::Domain { what, value, allowed: "roughness must be from 0 to 1" });
        }
    }
    if !(0.0..FRAC_PI_2).contains(&at.theta) {
        let allowed = "a polar angle must be at least 0 and below pi/2";
        return Err(LightError::Domain { what: "theta", value: at.theta, allowed });
    }
    if !at.phi.is_finite() {
        return Err(LightError::Domain { what: "phi", value: at.phi, allowed: "an azimuth must be finite" });
    }
    Ok(([at.alpha_x.max(LEAST_ALPHA), at.alpha_y.max(LEAST_ALPHA)], direction(at.theta, at.phi)))
}

/// Checks a surface, a view and a light, and evaluates `of` for them.
pub(super) fn lit(
    at: &Configuration,
    light: AreaLight<'_>,
    of: impl FnOnce(&LitPoint<'_, f64>) -> [f64; 2],
) -> Result<ReflectedLight, LightError> {
    let (alpha, wo) = surface_and_view(at)?;
    let (vertices, sides) = light.polygon()?;
    let [energy, fresnel] = of(&LitPoint { alpha, wo: wo.to_array(), vertices: &vertices, sides });
    Ok(ReflectedLight { energy, fresnel })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn schlicks_factor_goes_from_f0_to_f90() {
        let parts = ReflectedLight { energy: 0.5, fresnel: 0.125 };
        assert_eq!(parts.schlick(1.0, 1.0), 0.5);
        assert_eq!(parts.schlick(0.0, 1.0), 0.125);
        assert_eq!(parts.schlick(1.0, 0.0), 0.375);
    }

    #[test]
    fn configurations_without_reflection_are_refused() {
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
