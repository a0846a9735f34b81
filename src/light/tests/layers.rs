//! Compares layers under area lights with Monte Carlo integration of the published formula of the layered model.

use glam::DVec3;

use crate::cases::{Draw, Lit, Roughness};
use crate::{LightModel, NormalsRule, layers};
use ltcforge_fit::{
    Sides,
    brdf::{Brdf, Fuzz, Ggx, LobeTerms},
    math::{Lattice, SquarePoint},
};

/// Rays for each light and for each albedo.
const RAYS: usize = 1 << 14;
const COAT_F0: f64 = 0.04;

/// `OpenPBR`'s layers for one channel: fuzz over a dielectric coat over a metal.
struct Layers {
    base: Ggx,
    f0: f64,
    coat: Ggx,
    coat_weight: f64,
    transmittance: f64,
    fuzz: Fuzz,
    fuzz_roughness: f64,
    fuzz_weight: f64,
    fuzz_colour: f64,
}

fn schlick(f0: f64, wo: DVec3, wi: DVec3) -> f64 {
    f0 + (1.0 - f0) * (1.0 - wo.dot((wo + wi).normalize())).powi(5)
}

impl Layers {
    fn draw(draw: &mut Draw, lit: &Lit) -> Self {
        let alpha = draw.within(0.02, 0.3);
        let fuzz_roughness = draw.within(0.2, 1.0);
        Self {
            base: Ggx { alpha_x: lit.at.alpha_x.max(0.05), alpha_y: lit.at.alpha_y.max(0.05) },
            f0: draw.within(0.3, 1.0),
            coat: Ggx { alpha_x: alpha, alpha_y: alpha },
            coat_weight: draw.within(0.0, 1.0),
            transmittance: draw.within(0.3, 1.0),
            fuzz: Fuzz::new(fuzz_roughness),
            fuzz_roughness,
            fuzz_weight: draw.within(0.0, 1.0),
            fuzz_colour: draw.within(0.2, 1.0),
        }
    }

    /// The part of uniform light that a layer reflects, from its own sampler.
    fn albedo(brdf: &dyn Brdf, wo: DVec3, f0: f64) -> f64 {
        let of_ray = |u| {
            let ray = brdf.sample(wo, u);
            if ray.wi.z > 0.0 { ray.weight * schlick(f0, wo, ray.wi) } else { 0.0 }
        };
        Lattice::new(RAYS, [0.3, 0.7]).points().map(of_ray).sum::<f64>() / RAYS as f64
    }

    /// `f cos` of all layers towards `wo`, by the formulas of `OpenPBR` 1.1, integrated over the light, and its
    /// standard deviation. The rays come from all three lobes.
    fn reflected(&self, wo: DVec3, hits: impl Fn(DVec3) -> bool) -> [f64; 2] {
        let coat_albedo = Self::albedo(&self.coat, wo, COAT_F0);
        let fuzz_albedo = Self::albedo(&self.fuzz, wo, 1.0);
        let value = |wi: DVec3| {
            let base = schlick(self.f0, wo, wi) * self.base.eval_cos(wo, wi);
            let coat = schlick(COAT_F0, wo, wi) * self.coat.eval_cos(wo, wi);
            let passed = self.transmittance * (1.0 - coat_albedo);
            let coated_base = self.coat_weight * coat + (1.0 + self.coat_weight * (passed - 1.0)) * base;
            let fuzz = self.fuzz_colour * self.fuzz.eval_cos(wo, wi);
            self.fuzz_weight * fuzz + (1.0 + self.fuzz_weight * ((1.0 - fuzz_albedo) - 1.0)) * coated_base
        };
        let lobes: [&dyn Brdf; 3] = [&self.base, &self.coat, &self.fuzz];
        let (mut sum, mut sum2) = (0.0, 0.0);
        for (lobe, u) in lobes.iter().flat_map(|lobe| Lattice::new(RAYS, [0.1, 0.4]).points().map(move |u| (lobe, u))) {
            let wi = lobe.sample(wo, u).wi;
            if wi.z > 0.0 && hits(wi) {
                let density = lobes.iter().map(|lobe| lobe.pdf(wo, wi)).sum::<f64>() / 3.0;
                let found = value(wi) / density;
                (sum, sum2) = (sum + found, sum2 + found * found);
            }
        }
        let count = 3.0 * RAYS as f64;
        let mean = sum / count;
        [mean, ((sum2 / count - mean * mean).max(0.0) / count).sqrt()]
    }

    /// The same light from the functions of [`layers`], with each lobe in closed form.
    fn lit(&self, lit: &Lit) -> f64 {
        let light = lit.light(Sides::Two);
        let form = LightModel::Normals.closed_form(Some(NormalsRule::Fine)).expect("a formula");
        let of = |ggx: &Ggx, f0: f64| {
            let at = ltcforge_fit::Configuration { alpha_x: ggx.alpha_x, alpha_y: ggx.alpha_y, ..lit.at };
            form.reflected(&at, &light).expect("a surface").schlick(f0, 1.0)
        };
        let points: Vec<SquarePoint> = Lattice::new(4096, [0.0; 2]).points().map(SquarePoint::new).collect();
        let LobeTerms { amplitude, fresnel } = self.coat.terms(lit.wo(), &points);
        let albedo = COAT_F0 * (amplitude - fresnel) + fresnel;
        let (base, coat) = (of(&self.base, self.f0), of(&self.coat, COAT_F0));
        let coated_base = layers::coated(base, coat, albedo, self.coat_weight, self.transmittance);
        let [fuzz, albedo] = layers::by_fuzz(self.fuzz_roughness, &lit.at, &light).expect("a surface");
        layers::fuzzed(coated_base, self.fuzz_colour * fuzz, albedo, self.fuzz_weight)
    }
}

#[test]
fn layers_reflect_what_the_layered_model_does() {
    let mut draw = Draw::new(301);
    let (mut errors, mut deviations, mut energy) = (0.0, 0.0, 0.0);
    for _ in 0..60 {
        let lit = draw.lit(Roughness::All);
        let all = Layers::draw(&mut draw, &lit);
        let inside: DVec3 = lit.vertices.iter().sum();
        let ends = lit.vertices.iter().zip(lit.vertices.iter().cycle().skip(1));
        let planes: Vec<DVec3> = ends.map(|(a, b)| a.cross(*b)).collect();
        let side = planes[0].dot(inside).signum();
        let [mean, deviation] = all.reflected(lit.wo(), |wi| planes.iter().all(|plane| side * plane.dot(wi) > 0.0));
        let found = all.lit(&lit);
        let error = (found - mean).abs();
        assert!(error < 4.0 * deviation + 0.02, "{lit:?}: {found} {mean} {deviation}");
        (errors, deviations, energy) = (errors + error, deviations + deviation, energy + mean);
    }
    println!("mean error {:.5} of {:.3}, deviation {:.5}", errors / 60.0, energy / 60.0, deviations / 60.0);
    // Rule fine has a mean error of 0.0004.
    assert!(errors < 60.0 * 0.0005 && energy > 60.0 * 0.1, "{errors} {energy}");
}

/// Layers never add light. White layers under a white sky reflect at most all of it, and only the coat absorbs light.
#[test]
fn white_layers_over_white_are_white() {
    for (albedo, weight) in [(0.3, 0.7), (1.0, 1.0), (0.0, 0.4)] {
        assert!((layers::coated(1.0, albedo, albedo, weight, 1.0) - 1.0).abs() < 1e-15);
        assert!((layers::fuzzed(1.0, albedo, albedo, weight) - 1.0).abs() < 1e-15);
        assert!(layers::coated(1.0, albedo, albedo, weight, 0.5) <= 1.0);
    }
    assert_eq!(layers::coated(0.4, 0.1, 0.2, 0.0, 0.0), 0.4);
    assert_eq!(layers::fuzzed(0.4, 0.1, 0.2, 0.0), 0.4);
}
