//! Energy-preserving Oren-Nayar.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::DVec3;

use super::{
    hemisphere::Hemisphere,
    scattering::{Bends, Brdf, BrdfRules, BrdfSample, PredictionFactors},
};
use crate::math::{SquarePoint, atan2};

/// The EON model of Portsmouth, Kutz and Hill 2024 with an albedo of one. It is Fujii's Oren-Nayar model, plus further
/// bounces that add the light which Fujii's model loses.
///
/// ```text
/// f = A (1 + r s / t) / pi + (1 - E(o)) (1 - E(i)) / (pi (1 - E')),    A = 1 / (1 + c r),   c = 1/2 - 2 / (3 pi)
/// s = wo . wi - cos o cos i,    t = max(cos o, cos i) where s > 0, else 1
/// E(o) = A (1 + r G(o) / pi),   1 - E(o) = A r (c - G(o) / pi)
/// G(o) = sin o (o - sin o cos o) + 2/3 (tan o (1 - sin^3 o) - sin o)
/// E' = A (1 + d r),   d = 2/3 - 28 / (15 pi),   1 - E' = A r (c - d)
/// ```
///
/// It is reciprocal and reflects all light: `E = 1` for every view.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OrenNayar {
    /// The model's roughness `r`, the square root of a table's alpha, in [0, 1]. Zero is Lambertian reflection.
    pub roughness: f64,
}

/// Energy-preserving Oren-Nayar as an item of [`super::BrdfKind`].
pub(super) struct OrenNayarRules;

impl BrdfRules for OrenNayarRules {
    fn surface(&self, [alpha_x, alpha_y]: [f64; 2]) -> Box<dyn Brdf> {
        Box::new(OrenNayar { roughness: alpha_x.max(alpha_y).sqrt() })
    }

    fn is_isotropic(&self) -> bool {
        true
    }

    fn follows_reflection(&self) -> bool {
        false
    }

    fn prediction_factors(&self) -> PredictionFactors {
        PredictionFactors { sample: 1.0, error: 0.18 }
    }
}

/// For a grazing view of a rough surface, `f cos(theta_i)` is nearly constant until the light is lower than the view.
const SAMPLER: Hemisphere = Hemisphere { uniform: 0.5 };
/// `c`: the largest loss of a single bounce, for `r = 1` and divided by `A`.
const LOST: f64 = 0.5 - 2.0 / (3.0 * PI);
/// `c - d`: the mean loss of a single bounce, for `r = 1` and divided by `A`.
const LOST_ON_AVERAGE: f64 = LOST - (2.0 / 3.0 - 28.0 / (15.0 * PI));

/// `c - G / pi`: the loss of a single bounce from a direction, for `r = 1` and divided by `A`. In [0, c]; zero at the
/// horizon. `tan (1 - sin^3)` is written as `sin cos (1 + sin + sin^2) / (1 + sin)`, which has no pole at the horizon.
fn lost(w: DVec3) -> f64 {
    let (cos, sin) = (w.z, (w.x * w.x + w.y * w.y).sqrt());
    let tangent = sin * cos * (1.0 + sin + sin * sin) / (1.0 + sin);
    let g = sin * (atan2(sin, cos) - sin * cos) + (tangent - sin) * (2.0 / 3.0);
    (LOST - g / PI).max(0.0)
}

impl Brdf for OrenNayar {
    fn eval_cos(&self, wo: DVec3, wi: DVec3) -> f64 {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return 0.0;
        }
        let r = self.roughness;
        // Equals wo . wi - cos o cos i, without cancellation.
        let s = wo.x * wi.x + wo.y * wi.y;
        let s_over_t = if s > 0.0 { s / wo.z.max(wi.z) } else { s };
        let single = 1.0 + r * s_over_t;
        let multiple = r * lost(wo) * lost(wi) / LOST_ON_AVERAGE;
        (single + multiple) * wi.z / (PI * (1.0 + LOST * r))
    }

    /// `s` changes its sign at a right angle to the view's azimuth. `t` is the larger cosine.
    fn bends(&self, wo: DVec3) -> Bends {
        Bends { theta_i: vec![atan2((wo.x * wo.x + wo.y * wo.y).sqrt(), wo.z)], phi: vec![FRAC_PI_2] }
    }

    fn sample(&self, wo: DVec3, u: [f64; 2]) -> BrdfSample {
        let wi = SAMPLER.sample(&SquarePoint::new(u));
        BrdfSample::of(self, wo, wi)
    }

    fn pdf(&self, _: DVec3, wi: DVec3) -> f64 {
        SAMPLER.pdf(wi)
    }
}
