//! The LTC by a formula as a model of light.

use super::FormulaLobe;
use crate::{
    NormalsRule,
    rules::{Formula, LitPoint, ModelOfLight},
};
use ltcforge_fit::math::{Scalar, Triple};

/// The model as an item of [`crate::LightModel`].
pub(crate) struct FormulaModel;

impl ModelOfLight for FormulaModel {
    fn formula(&self) -> Option<&dyn Formula> {
        Some(self)
    }
}

impl Formula for FormulaModel {
    fn cost(&self) -> u32 {
        7
    }

    fn lobe(&self, alpha: [f64; 2], wo: Triple<f64>, fresnel: [f64; 2]) -> Option<FormulaLobe<f64>> {
        Some(FormulaLobe::new(alpha, wo, fresnel))
    }

    fn reflected(&self, lit: &LitPoint<'_, f64>, _: NormalsRule) -> [f64; 2] {
        reflected(lit)
    }

    fn reflected_f32(&self, lit: &LitPoint<'_, f32>, _: NormalsRule) -> [f32; 2] {
        reflected(lit)
    }
}

fn reflected<T: Scalar>(lit: &LitPoint<'_, T>) -> [T; 2] {
    let lobe = FormulaLobe::new(lit.alpha, lit.wo, [T::ONE; 2]);
    let covered = lobe.space.polygon(lit.vertices, lit.sides);
    lobe.parts.map(|part| part * covered)
}
