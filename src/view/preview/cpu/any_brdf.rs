//! The reference for any scattering model, by the model's own sampling and evaluation. Shaders only have GGX, so this
//! file has no twin.

use glam::{DVec3, Vec2, Vec3};

use super::ggx::{ColouredParts, HORIZON, Shaded, point, seeds};
use crate::preview::frame::FrameLight;
use ltcforge_fit::{
    brdf::{Brdf, BrdfModel, BrdfSample, cos_theta_d},
    math::SquarePoint,
};

fn surface(brdf: &BrdfModel, alpha: Vec2) -> Box<dyn Brdf> {
    brdf.surface([alpha.x.into(), alpha.y.into()])
}

fn unit_square(i: u32, seed: [u32; 2]) -> [f64; 2] {
    point(i, seed).to_array().map(f64::from)
}

/// The reflected light, for a Fresnel factor of one and weighted by Schlick's fifth power. It takes `samples`
/// directions from the model and `samples` points of the light, weighted by the balance heuristic [Veach 1997], as in
/// [`super::ggx::reference`].
pub(super) fn reference(
    brdf: &BrdfModel,
    at: &Shaded,
    light: &FrameLight,
    colour: impl Fn(Vec3) -> Vec3,
    samples: u32,
    key: u32,
) -> ColouredParts {
    let [a, b, c, d] = seeds(key);
    let surface = surface(brdf, at.alpha);
    let wo = at.wo.as_dvec3().normalize();
    let points: Vec<SquarePoint> = (0..samples).map(|i| SquarePoint::new(unit_square(i, [a, b]))).collect();
    let mut model_samples = Vec::with_capacity(points.len());
    surface.sample_all(wo, &points, &mut model_samples);
    let (mut all, mut fresnel) = (DVec3::ZERO, DVec3::ZERO);
    let mut add = |value: f64, cosine: f64, towards: Vec3| {
        let grazing = (1.0 - cosine).clamp(0.0, 1.0);
        let grazing2 = grazing * grazing;
        let value = value * colour(towards).as_dvec3();
        all += value;
        fresnel += value * (grazing2 * grazing2 * grazing);
    };
    for (i, BrdfSample { wi, weight, cos_theta_d: cosine }) in (0..samples).zip(model_samples) {
        let to_light = wi.as_vec3();
        if weight > 0.0 && to_light.z > HORIZON {
            let towards = at.x * to_light.x + at.y * to_light.y + at.z * to_light.z;
            let of_light = f64::from(light.pdf(at.position, towards));
            let of_brdf = surface.pdf(wo, wi);
            if of_light >= 0.0 {
                add(weight * of_brdf / (of_brdf + of_light), cosine, towards);
            }
        }
        let (direction, of_light) = light.sample(at.position, point(i, [c, d]));
        let wi = DVec3::new(direction.dot(at.x).into(), direction.dot(at.y).into(), direction.dot(at.z).into());
        if wi.z > f64::from(HORIZON) && of_light > 0.0 {
            let value = surface.eval_cos(wo, wi);
            if value > 0.0 {
                let of_brdf = if light.is_line() { 0.0 } else { surface.pdf(wo, wi) };
                add(value / (of_brdf + f64::from(of_light)), cos_theta_d(wo, wi), direction);
            }
        }
    }
    ColouredParts { all: all.as_vec3(), fresnel: fresnel.as_vec3() }.over(samples as f32)
}

/// The model's lobe: `f cos` of a direction above the horizon, per steradian.
pub(super) fn lobe(brdf: &BrdfModel, alpha: Vec2, wo: Vec3, wi: Vec3) -> f32 {
    surface(brdf, alpha).eval_cos(wo.as_dvec3().normalize(), wi.as_dvec3().normalize()) as f32
}
