//! Sheen by the Charlie distribution, with the visibility of Neubelt and Pettineo.

use glam::DVec3;

use super::{
    charlie::Fibres,
    scattering::{Brdf, BrdfRules, BrdfSample, PredictionFactors},
};
use crate::math::SquarePoint;

/// The sheen of game engines and of glTF, with a Fresnel factor of one: `f = D / (4 (cos o + cos i - cos o cos i))`. It
/// combines Charlie's distribution with the smooth visibility term of Neubelt and Pettineo 2013. It is reciprocal but
/// does not conserve energy at grazing angles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CharlieNeubelt {
    fibres: Fibres,
}

/// Charlie with the visibility of Neubelt and Pettineo as an item of [`super::BrdfKind`].
pub(super) struct CharlieNeubeltRules;

impl BrdfRules for CharlieNeubeltRules {
    fn surface(&self, [alpha_x, alpha_y]: [f64; 2]) -> Box<dyn Brdf> {
        Box::new(CharlieNeubelt::new(alpha_x.max(alpha_y)))
    }

    fn is_isotropic(&self) -> bool {
        true
    }

    fn follows_reflection(&self) -> bool {
        false
    }

    fn prediction_factors(&self) -> PredictionFactors {
        PredictionFactors { sample: 3.0, error: 0.8 }
    }
}

impl CharlieNeubelt {
    /// The sheen of a surface with roughness `alpha` in [0, 1], the square of glTF's sheen roughness. Values below
    /// 0.0049 are raised to 0.0049.
    #[must_use]
    pub fn new(alpha: f64) -> Self {
        Self { fibres: Fibres::new(alpha) }
    }
}

impl Brdf for CharlieNeubelt {
    fn eval_cos(&self, wo: DVec3, wi: DVec3) -> f64 {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return 0.0;
        }
        self.fibres.distribution(wo, wi) * wi.z / (4.0 * (wo.z + wi.z - wo.z * wi.z))
    }

    fn sample(&self, wo: DVec3, u: [f64; 2]) -> BrdfSample {
        BrdfSample::of(self, wo, self.fibres.sample(wo, &SquarePoint::new(u)))
    }

    fn pdf(&self, wo: DVec3, wi: DVec3) -> f64 {
        self.fibres.pdf(wo, wi)
    }
}
