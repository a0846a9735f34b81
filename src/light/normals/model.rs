//! The closed form as a model of light.

use super::{NormalsRule, reflected, region};
use crate::{
    AreaLight, LightError, ReflectedLight,
    rules::{Formula, LitPoint, ModelOfLight, lit},
};
use ltcforge_fit::Configuration;

/// The model as an item of [`crate::LightModel`].
pub(crate) struct NormalsModel;

impl ModelOfLight for NormalsModel {
    fn formula(&self) -> Option<&dyn Formula> {
        Some(self)
    }
}

impl Formula for NormalsModel {
    fn choices(&self) -> &'static [NormalsRule] {
        NormalsRule::ALL
    }

    fn cost(&self) -> u32 {
        10
    }

    fn reflected(&self, lit: &LitPoint<'_, f64>, rule: NormalsRule) -> [f64; 2] {
        reflected(lit.alpha, lit.wo, lit.vertices, lit.sides, rule)
    }

    fn edge(&self, lit: &LitPoint<'_, f64>, rule: NormalsRule) -> f64 {
        region(lit.alpha, lit.wo, lit.vertices, lit.sides, rule).map_or(0.0, |region| region.edge(&rule.network()))
    }

    fn reflected_f32(&self, lit: &LitPoint<'_, f32>, rule: NormalsRule) -> [f32; 2] {
        reflected(lit.alpha, lit.wo, lit.vertices, lit.sides, rule)
    }
}

/// The light that a surface reflects, computed by the closed form in the space of normals in f64. Shapes are replaced
/// by the polygons of [`ShapedLight::outline`](crate::ShapedLight::outline).
///
/// # Errors
/// [`LightError::Domain`] for a roughness outside [0, 1] or a view direction on or below the horizon, and the errors of
/// the outline.
pub fn by_normals<'a>(
    at: &Configuration,
    light: impl Into<AreaLight<'a>>,
    rule: NormalsRule,
) -> Result<ReflectedLight, LightError> {
    lit(at, light.into(), |lit| NormalsModel.reflected(lit, rule))
}
