//! The interface of a scattering model.

use glam::{DMat3, DVec3};

use crate::math::SquarePoint;

/// A light direction drawn for a view direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BrdfSample {
    /// Light direction, unit length. It can be below the horizon; `weight` is then zero.
    pub wi: DVec3,
    /// `f(wo, wi) cos(theta_i) / pdf`, for a Fresnel factor of one. In [0, 1] for models that sample visible normals,
    /// else finite and not negative.
    pub weight: f64,
    /// Cosine of the angle between view direction and microfacet normal, which is the half vector.
    pub cos_theta_d: f64,
}

impl BrdfSample {
    /// The sample for a direction that a model has drawn. Domain: a direction whose density is not zero.
    pub(super) fn of(brdf: &dyn Brdf, wo: DVec3, wi: DVec3) -> Self {
        let weight = brdf.eval_cos(wo, wi) / brdf.pdf(wo, wi);
        Self { wi, weight, cos_theta_d: cos_theta_d(wo, wi) }
    }
}

/// Cosine of the angle between the view direction and the half vector: `sqrt((1 + wo . wi) / 2)`.
#[must_use]
pub fn cos_theta_d(wo: DVec3, wi: DVec3) -> f64 {
    (0.5 * (1.0 + wo.dot(wi)).max(0.0)).sqrt()
}

/// The light directions at which a model has kinks, for one view. Quadratures split their intervals at the kinks.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Bends {
    /// Polar angles of the light, radians in (0, pi/2).
    pub theta_i: Vec<f64>,
    /// Azimuths of the light relative to the view, on either side, radians in \[0, pi\].
    pub phi: Vec<f64>,
}

/// A scattering model in the tangent frame of its surface: normal +z, and x and y along the axes of anisotropy.
///
/// Directions point away from the surface and have unit length. The Fresnel factor is one.
pub trait Brdf: Sync {
    /// `f(wo, wi) cos(theta_i)`, per steradian; zero if either direction is below the horizon.
    fn eval_cos(&self, wo: DVec3, wi: DVec3) -> f64;

    /// The light reflected by the normals around `wm`, per steradian of normals: `4 (wo . wm) f(wo, wi) cos(theta_i)`,
    /// where `wi` is the reflection of `wo` at `wm`. A microfacet model can evaluate `wm` more exactly than the half
    /// vector of two directions allows.
    fn eval_normal(&self, wo: DVec3, wm: DVec3) -> f64 {
        let cosine = wo.dot(wm);
        if cosine <= 0.0 {
            return 0.0;
        }
        4.0 * cosine * self.eval_cos(wo, 2.0 * cosine * wm - wo)
    }

    /// The kinks of [`Brdf::eval_cos`] as a function of `wi`, if quadratures need to know them. The default is no
    /// kinks.
    fn bends(&self, _wo: DVec3) -> Bends {
        Bends::default()
    }

    /// Draws a light direction for `wo` from a point of the unit square. Domain: `wo.z > 0`.
    fn sample(&self, wo: DVec3, u: [f64; 2]) -> BrdfSample;

    /// Draws a light direction for `wo` from each of `points`, like [`Brdf::sample`], and appends the samples to
    /// `drawn` in the same order. An implementation can share work between the samples.
    fn sample_all(&self, wo: DVec3, points: &[SquarePoint], drawn: &mut Vec<BrdfSample>) {
        drawn.extend(points.iter().map(|point| self.sample(wo, point.u)));
    }

    /// Amplitude and Fresnel term of the lobe for `wo`: means over the reflections drawn from `points`, which must not
    /// be empty.
    fn terms(&self, wo: DVec3, points: &[SquarePoint]) -> LobeTerms {
        let mut drawn = Vec::with_capacity(points.len());
        self.sample_all(wo, points, &mut drawn);
        let sum = drawn.iter().map(LobeTerms::of).fold([0.0; 2], |sum, part| [sum[0] + part[0], sum[1] + part[1]]);
        let [amplitude, fresnel] = sum.map(|sum| sum / points.len() as f64);
        LobeTerms { amplitude, fresnel }
    }

    /// The matrix of the lobe for `wo`, if the lobe is a linearly transformed cosine. No fit is then needed.
    fn ltc(&self, _wo: DVec3) -> Option<DMat3> {
        None
    }

    /// The density with which [`Brdf::sample`] draws `wi`, per steradian.
    fn pdf(&self, wo: DVec3, wi: DVec3) -> f64;
}

/// The terms of a lobe's reflectance, `F0 (amplitude - fresnel) + F90 fresnel` [Hill and Heitz 2016].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LobeTerms {
    /// Directional albedo for a Fresnel factor of one; for GGX `E[G2/G1]` over visible normals.
    pub amplitude: f64,
    /// Directional albedo weighted by Schlick's fifth power; for GGX `E[G2/G1 (1 - wo.wm)^5]` over visible normals.
    pub fresnel: f64,
}

impl LobeTerms {
    /// The contribution of one reflection to the mean: its weight, and its weight times Schlick's fifth power.
    #[must_use]
    fn of(sample: &BrdfSample) -> [f64; 2] {
        let grazing = (1.0 - sample.cos_theta_d).max(0.0);
        let grazing2 = grazing * grazing;
        [sample.weight, sample.weight * (grazing2 * grazing2 * grazing)]
    }
}

/// Factors that convert predictions for GGX to predictions for another scattering model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PredictionFactors {
    /// The factor for the time of a sample, including its value and density.
    pub(crate) sample: f64,
    /// The factor for the mean error of a table.
    pub(crate) error: f64,
}

/// A scattering model as an item of [`super::BrdfKind`].
pub(crate) trait BrdfRules: Sync {
    /// The surface with these roughnesses along x and y, both in (0, 1].
    fn surface(&self, roughness: [f64; 2]) -> Box<dyn Brdf>;

    /// True if a surface looks the same from all azimuths. Its roughness is the larger of the two roughnesses, and
    /// tables have a ratio of one only.
    fn is_isotropic(&self) -> bool {
        false
    }

    /// True if lobes are centred near GGX's reflection. Layouts that store lobes relative to the reflection need this.
    /// It is false for diffuse reflection and sheen.
    fn follows_reflection(&self) -> bool {
        true
    }

    /// True if the lobes are LTCs, with the matrices of [`Brdf::ltc`].
    fn is_ltc(&self) -> bool {
        false
    }

    /// True if the values are in a file that the recipe names.
    fn needs_file(&self) -> bool {
        false
    }

    /// The factors that convert a prediction for GGX to a prediction for this model.
    fn prediction_factors(&self) -> PredictionFactors {
        PredictionFactors { sample: 1.0, error: 1.0 }
    }
}
