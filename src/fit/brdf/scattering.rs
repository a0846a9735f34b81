//! The interface of a scattering model.

use glam::{DMat3, DVec3};

use crate::math::SquarePoint;

/// A light direction drawn for a view direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BrdfSample {
    /// Light direction, unit length. Below the horizon where `weight` is zero.
    pub wi: DVec3,
    /// `f(wo, wi) cos(theta_i) / pdf`, for a Fresnel factor of one. In [0, 1] where visible normals are drawn, else
    /// finite and not negative.
    pub weight: f64,
    /// Cosine between view direction and microfacet normal, which is halfway between view and light.
    pub cos_theta_d: f64,
}

impl BrdfSample {
    /// The sample of a direction that a model has drawn by its density. Domain: not a direction of density zero.
    pub(super) fn of(brdf: &dyn Brdf, wo: DVec3, wi: DVec3) -> Self {
        let weight = brdf.eval_cos(wo, wi) / brdf.pdf(wo, wi);
        Self { wi, weight, cos_theta_d: cos_theta_d(wo, wi) }
    }
}

/// Cosine between the view direction and the normal halfway to the light: `sqrt((1 + wo . wi) / 2)`.
#[must_use]
pub fn cos_theta_d(wo: DVec3, wi: DVec3) -> f64 {
    (0.5 * (1.0 + wo.dot(wi)).max(0.0)).sqrt()
}

/// Where a model bends as a function of the light's direction, for one view. Quadratures end their intervals there.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Bends {
    /// Polar angles of the light, radians in (0, pi/2).
    pub theta_i: Vec<f64>,
    /// Azimuths of the light from the view's on either side, radians in \[0, pi\].
    pub phi: Vec<f64>,
}

/// A scattering model with its surface's tangent frame: normal +z, and x and y along the axes of anisotropy.
///
/// Directions point away from the surface and have unit length; the Fresnel factor is one.
pub trait Brdf: Sync {
    /// `f(wo, wi) cos(theta_i)`, per steradian; zero when either direction is below the horizon.
    fn eval_cos(&self, wo: DVec3, wi: DVec3) -> f64;

    /// The light that the normals around `wm` reflect, per steradian of normals: `4 (wo . wm) f(wo, wi) cos(theta_i)`
    /// for the `wi` that `wm` reflects. A model of microfacets may know `wm` better than half the way between two
    /// directions tells.
    fn eval_normal(&self, wo: DVec3, wm: DVec3) -> f64 {
        let cosine = wo.dot(wm);
        if cosine <= 0.0 {
            return 0.0;
        }
        4.0 * cosine * self.eval_cos(wo, 2.0 * cosine * wm - wo)
    }

    /// Where [`Brdf::eval_cos`] bends as a function of `wi`, as far as quadratures gain from knowing it; nowhere unless
    /// a model says so.
    fn bends(&self, _wo: DVec3) -> Bends {
        Bends::default()
    }

    /// Draws a light direction for `wo` from a point of the unit square. Domain: `wo.z > 0`.
    fn sample(&self, wo: DVec3, u: [f64; 2]) -> BrdfSample;

    /// Draws a light direction for `wo` from each of `points` and hands it on, in their order: [`Brdf::sample`] of all
    /// of them. A model may do here once what it does there for each.
    fn sample_all(&self, wo: DVec3, points: &[SquarePoint], drawn: &mut Vec<BrdfSample>) {
        drawn.extend(points.iter().map(|point| self.sample(wo, point.u)));
    }

    /// Amplitude and Fresnel term of the lobe for `wo`: means over the reflections drawn from `points`, one at least.
    fn terms(&self, wo: DVec3, points: &[SquarePoint]) -> LobeTerms {
        let mut drawn = Vec::with_capacity(points.len());
        self.sample_all(wo, points, &mut drawn);
        let sum = drawn.iter().map(LobeTerms::of).fold([0.0; 2], |sum, part| [sum[0] + part[0], sum[1] + part[1]]);
        let [amplitude, fresnel] = sum.map(|sum| sum / points.len() as f64);
        LobeTerms { amplitude, fresnel }
    }

    /// The matrix of the lobe for `wo`, where the model is a linearly transformed cosine itself: there is nothing to fit
    /// then.
    fn ltc(&self, _wo: DVec3) -> Option<DMat3> {
        None
    }

    /// Density with which [`Brdf::sample`] draws `wi`, per steradian.
    fn pdf(&self, wo: DVec3, wi: DVec3) -> f64;
}

/// The terms of a lobe's reflectance: `reflectance = F0 (amplitude - fresnel) + F90 fresnel` [Hill and Heitz 2016].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LobeTerms {
    /// Directional albedo for a Fresnel factor of one; for GGX `E[G2/G1]` over visible normals.
    pub amplitude: f64,
    /// The same albedo, weighted by Schlick's fifth power; for GGX `E[G2/G1 (1 - wo.wm)^5]` over visible normals.
    pub fresnel: f64,
}

impl LobeTerms {
    /// The part of one reflection in a mean: its weight, and that times Schlick's fifth power.
    #[must_use]
    fn of(sample: &BrdfSample) -> [f64; 2] {
        let grazing = (1.0 - sample.cos_theta_d).max(0.0);
        let grazing2 = grazing * grazing;
        [sample.weight, sample.weight * (grazing2 * grazing2 * grazing)]
    }
}

/// Factors from predictions for GGX to those for another scattering model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PredictionFactors {
    /// The time that a sample with its value and density takes.
    pub(crate) sample: f64,
    /// The mean error of a table.
    pub(crate) error: f64,
}

/// A scattering model as an item of [`super::BrdfKind`].
pub(crate) trait BrdfRules: Sync {
    /// The surface of these roughnesses along x and y, both in (0, 1].
    fn surface(&self, roughness: [f64; 2]) -> Box<dyn Brdf>;

    /// Whether a surface is the same in all azimuths. Its roughness is then the larger of the two, and tables have a
    /// ratio of one only.
    fn is_isotropic(&self) -> bool {
        false
    }

    /// Whether lobes lie around GGX's reflection, as layouts need that store lobes relative to it. Diffuse reflection
    /// and sheen do not.
    fn follows_reflection(&self) -> bool {
        true
    }

    /// Whether its lobes are LTCs, whose matrices [`Brdf::ltc`] has.
    fn is_ltc(&self) -> bool {
        false
    }

    /// Whether its numbers are in a file that a recipe names.
    fn needs_file(&self) -> bool {
        false
    }

    /// The factors from a prediction for GGX to one for this model.
    fn prediction_factors(&self) -> PredictionFactors {
        PredictionFactors { sample: 1.0, error: 1.0 }
    }
}
