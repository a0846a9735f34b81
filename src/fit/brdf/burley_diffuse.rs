//! Burley's diffuse reflection.

use std::f64::consts::PI;

use glam::DVec3;

use super::{
    hemisphere::Hemisphere,
    scattering::{Brdf, BrdfRules, BrdfSample, PredictionFactors},
};
use crate::math::SquarePoint;

/// The diffuse part of Disney's BRDF [Burley 2012, section 5.3] with a base colour of one:
///
/// ```text
/// f = (1 + (F - 1) (1 - cos i)^5) (1 + (F - 1) (1 - cos o)^5) / pi,    F = 1/2 + 2 r cos^2 d
/// ```
///
/// where `d` is the angle between the light direction and the half vector. The BRDF is reciprocal but does not conserve
/// energy: rough surfaces at grazing views reflect up to 1.6 times the incident light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BurleyDiffuse {
    /// Perceptual roughness `r`, the square root of a table's alpha, in [0, 1].
    pub roughness: f64,
}

/// Burley's diffuse reflection as an item of [`super::BrdfKind`].
pub(super) struct BurleyDiffuseRules;

impl BrdfRules for BurleyDiffuseRules {
    fn surface(&self, [alpha_x, alpha_y]: [f64; 2]) -> Box<dyn Brdf> {
        Box::new(BurleyDiffuse { roughness: alpha_x.max(alpha_y).sqrt() })
    }

    fn is_isotropic(&self) -> bool {
        true
    }

    fn follows_reflection(&self) -> bool {
        false
    }

    fn prediction_factors(&self) -> PredictionFactors {
        PredictionFactors { sample: 1.0, error: 0.12 }
    }
}

/// The lobe of a rough surface is up to a few times brighter near the horizon than a cosine lobe.
const SAMPLER: Hemisphere = Hemisphere { uniform: 0.25 };

impl Brdf for BurleyDiffuse {
    fn eval_cos(&self, wo: DVec3, wi: DVec3) -> f64 {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return 0.0;
        }
        // cos^2 d = (1 + wo . wi) / 2.
        let retro = 0.5 + self.roughness * (1.0 + wo.dot(wi)).max(0.0) - 1.0;
        let factor = |cosine: f64| {
            let m = (1.0 - cosine).max(0.0);
            1.0 + retro * (m * m * m * m * m)
        };
        factor(wo.z) * factor(wi.z) * wi.z / PI
    }

    fn sample(&self, wo: DVec3, u: [f64; 2]) -> BrdfSample {
        let wi = SAMPLER.sample(&SquarePoint::new(u));
        BrdfSample::of(self, wo, wi)
    }

    fn pdf(&self, _: DVec3, wi: DVec3) -> f64 {
        SAMPLER.pdf(wi)
    }
}
