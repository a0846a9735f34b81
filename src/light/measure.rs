//! Measures the error of a model's light. Tables and closed forms use the same measure.

use std::f64::consts::{E, TAU};

use glam::DVec3;
use rand_core::{Rng, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use rayon::prelude::*;

use super::{LightError, Lighting, PolygonLight, ReflectedLight, truth_of};
use ltcforge_fit::{
    BrdfModel, Configuration, PerAxis, Sides, Spread, Table,
    math::{cos, direction, ln, pow},
    terms_of,
};

/// The smallest random roughness. Sharper lobes are almost always either entirely inside or entirely outside of a
/// light.
const LEAST_DRAWN_ALPHA: f64 = 0.01;
const LEAST_DRAWN_ACROSS: f64 = 0.005;
/// The largest angle of a view from the normal: 88 degrees.
const STEEPEST: f64 = 88.0 / 360.0 * TAU;
/// The range of the geometric mean of a light's two half widths, at distance one. The ratio of one half width to this
/// mean is between 1/e and e.
const HALF_WIDTH: [f64; 2] = [0.05, 1.2];
/// The tolerance of the reference: a thirtieth of the mean error of the best model.
const TOLERANCE: f64 = 1e-5;
const SEED: u64 = 1;
/// Maximum number of random lights that are tried around one reflection.
const TRIED: usize = 64;

/// All surfaces and views of an error measurement.
pub const EVERYWHERE: PerAxis<[f64; 2]> =
    PerAxis { alpha: [LEAST_DRAWN_ALPHA, 1.0], ratio: [0.0, 1.0], theta: [0.0, STEEPEST], phi: [0.0, 0.25 * TAU] };

/// A surface, a view of it, and a light.
#[derive(Debug, Clone)]
struct Lit {
    at: Configuration,
    light: PolygonLight,
}

/// Random rectangles around the reflections of random surfaces of a scattering model, with the reference light of each.
///
/// Equal arguments give equal lights.
#[derive(Debug, Clone)]
pub struct RandomLights {
    brdf: BrdfModel,
    lit: Vec<Lit>,
    truth: Vec<ReflectedLight>,
}

impl RandomLights {
    /// `count` lights on surfaces and views within the ranges of a table of a scattering model.
    ///
    /// The square root of alpha, the ratio and the angles are uniformly distributed. Alpha is at least 0.01 and theta
    /// at most 88 degrees. A light is at distance one, around a direction drawn by the model's sampler (for GGX the
    /// reflection of a visible normal). It is turned and tilted at random. The geometric mean of its half widths is
    /// 0.05 to 1.2. Domain: at least one light. Runs on the current rayon pool. The size of the pool does not change
    /// the result.
    ///
    /// # Errors
    /// [`LightError::Domain`] for invalid ranges, [`LightError::NoBrdfFile`] for a tabulated model without its values.
    pub fn draw(brdf: &BrdfModel, range: &PerAxis<[f64; 2]>, count: usize) -> Result<Self, LightError> {
        if !brdf.is_complete() {
            return Err(LightError::NoBrdfFile);
        }
        let mut random = Draw(Xoshiro256PlusPlus::seed_from_u64(SEED));
        let lit: Vec<Lit> = (0..count).map(|_| random.lit(brdf, range)).collect();
        let truth = |lit: &Lit| truth_of(brdf, TOLERANCE, &lit.at, &lit.light);
        let truth = lit.par_iter().map(truth).collect::<Result<_, _>>()?;
        Ok(Self { brdf: brdf.clone(), lit, truth })
    }

    /// A random light for each surface and view, around its reflection, as [`RandomLights::draw`] draws them; `None` for
    /// a view of which nothing is reflected.
    #[must_use]
    pub fn around(brdf: &BrdfModel, at: &[Configuration]) -> Vec<Option<PolygonLight>> {
        let mut random = Draw(Xoshiro256PlusPlus::seed_from_u64(SEED));
        at.iter().map(|at| (0..TRIED).find_map(|_| random.light(brdf, at))).collect()
    }

    /// The scattering model of the surfaces.
    #[must_use]
    pub fn brdf(&self) -> &BrdfModel {
        &self.brdf
    }

    /// The number of lights.
    #[must_use]
    #[expect(clippy::len_without_is_empty, reason = "there is at least one light")]
    pub fn len(&self) -> usize {
        self.lit.len()
    }

    /// Mean of the reflected energy. It is in [0, 1] for a model that does not gain light.
    #[must_use]
    pub fn mean_energy(&self) -> f64 {
        self.truth.iter().map(|truth| truth.energy).sum::<f64>() / self.truth.len() as f64
    }

    /// Mean of the light that a material with Schlick's factor reflects. Its reflectance is `f0` at normal and one at
    /// grazing incidence.
    #[must_use]
    pub fn mean_reflected(&self, f0: f64) -> f64 {
        self.truth.iter().map(|truth| truth.schlick(f0, 1.0)).sum::<f64>() / self.truth.len() as f64
    }
}

/// Absolute error of the energy that a model reflects, for a Fresnel factor of one, over random lights. It is in [0, 1]
/// for a scattering model that does not gain light.
///
/// # Errors
/// [`LightError::Singular`] for a table with a singular matrix, [`LightError::OtherLights`] for a table of another
/// scattering model than the lights, [`LightError::OtherBrdf`] for a closed form if the lights are not for GGX.
pub fn light_error(model: Lighting<'_>, lights: &RandomLights) -> Result<Spread, LightError> {
    let own = with_terms(model, &lights.brdf)?;
    let model = own.as_ref().map_or(model, |table| model.with_table(table));
    light_error_by(|at, light| model.reflected(at, light), lights)
}

/// Like [`light_error`], for a material with Schlick's Fresnel factor. Its reflectance is `f0` at normal and one at
/// grazing incidence.
///
/// # Errors
/// The errors of [`light_error`].
pub fn material_error(model: Lighting<'_>, lights: &RandomLights, f0: f64) -> Result<Spread, LightError> {
    let own = with_terms(model, &lights.brdf)?;
    let model = own.as_ref().map_or(model, |table| model.with_table(table));
    errors(|at, light| model.of_material(at, light, [f0, 1.0]), lights, |truth| truth.schlick(f0, 1.0))
}

/// Like [`light_error`], for a function that returns the light of a surface.
///
/// # Errors
/// The errors of `reflected`.
pub fn light_error_by(
    reflected: impl Fn(&Configuration, &PolygonLight) -> Result<ReflectedLight, LightError>,
    lights: &RandomLights,
) -> Result<Spread, LightError> {
    errors(|at, light| Ok(reflected(at, light)?.energy), lights, |truth| truth.energy)
}

/// Like [`material_error`], for a function that returns the light of a surface.
///
/// # Errors
/// The errors of `reflected`.
pub fn material_error_by(
    reflected: impl Fn(&Configuration, &PolygonLight) -> Result<ReflectedLight, LightError>,
    lights: &RandomLights,
    f0: f64,
) -> Result<Spread, LightError> {
    errors(|at, light| Ok(reflected(at, light)?.schlick(f0, 1.0)), lights, |truth| truth.schlick(f0, 1.0))
}

/// Absolute errors of a model. `wanted` selects the reference value.
fn errors(
    reflected: impl Fn(&Configuration, &PolygonLight) -> Result<f64, LightError>,
    lights: &RandomLights,
    wanted: impl Fn(&ReflectedLight) -> f64,
) -> Result<Spread, LightError> {
    let pairs = lights.lit.iter().zip(&lights.truth);
    let error = |(Lit { at, light }, truth): (&Lit, &ReflectedLight)| Ok((reflected(at, light)? - wanted(truth)).abs());
    pairs.map(error).collect::<Result<_, _>>().map(spread)
}

fn spread(mut errors: Vec<f64>) -> Spread {
    errors.sort_by(f64::total_cmp);
    let count = errors.len();
    let mean = errors.iter().sum::<f64>() / count as f64;
    Spread { mean, p95: errors[count * 95 / 100], max: errors[count - 1] }
}

/// If a model's table has no terms, returns it with the terms of its scattering model. Models are measured by the
/// reference of their own scattering model.
pub(super) fn with_terms(model: Lighting<'_>, brdf: &BrdfModel) -> Result<Option<Table>, LightError> {
    model.check_brdf(brdf)?;
    let Some(table) = model.table() else { return Ok(None) };
    if table.terms.is_some() {
        return Ok(None);
    }
    if table.lobe.gaussian().is_some() {
        return Err(LightError::NoTerms);
    }
    Ok(Some(Table { terms: Some(terms_of(brdf, table.layout, &table.axes)), ..table.clone() }))
}

struct Draw(Xoshiro256PlusPlus);

impl Draw {
    fn within(&mut self, [low, high]: [f64; 2]) -> f64 {
        low + (high - low) * ((self.0.next_u64() >> 11) as f64 / (1_u64 << 53) as f64)
    }

    fn unit(&mut self) -> f64 {
        self.within([0.0, 1.0])
    }

    /// A vector of normally distributed numbers.
    fn vector(&mut self) -> DVec3 {
        let mut normal = || (-2.0 * ln(1.0 - self.unit())).sqrt() * cos(TAU * self.unit());
        DVec3::new(normal(), normal(), normal())
    }

    fn configuration(&mut self, range: &PerAxis<[f64; 2]>) -> Configuration {
        let roughness = self.within(range.alpha.map(|alpha| alpha.max(LEAST_DRAWN_ALPHA).sqrt()));
        let alpha = (roughness * roughness).clamp(LEAST_DRAWN_ALPHA, 1.0);
        let across = (alpha * self.within(range.ratio)).max(LEAST_DRAWN_ACROSS);
        let theta = self.within(range.theta.map(|theta| theta.min(STEEPEST)));
        Configuration { alpha_x: alpha, alpha_y: across, theta, phi: self.within(range.phi) }
    }

    fn lit(&mut self, brdf: &BrdfModel, range: &PerAxis<[f64; 2]>) -> Lit {
        loop {
            let at = self.configuration(range);
            if let Some(light) = self.light(brdf, &at) {
                return Lit { at, light };
            }
        }
    }

    /// A rectangle around a direction that a surface reflects; `None` below the horizon, and for a rectangle that is
    /// seen edge-on, which may fail the test of convexity.
    fn light(&mut self, brdf: &BrdfModel, at: &Configuration) -> Option<PolygonLight> {
        let surface = brdf.surface([at.alpha_x, at.alpha_y]);
        let centre = surface.sample(direction(at.theta, at.phi), [self.unit(), self.unit()]).wi;
        let towards = (0.5 * self.vector() - centre).normalize();
        let x = towards.cross(self.vector()).normalize();
        let [least, most] = HALF_WIDTH;
        let size = least * pow(most / least, self.unit());
        let stretch = pow(E, self.within([-1.0, 1.0]));
        let (x, y) = (x * size * stretch, towards.cross(x) * size / stretch);
        let vertices = vec![centre - x - y, centre + x - y, centre + x + y, centre - x + y];
        PolygonLight::new(vertices, Sides::Two).ok().filter(|_| centre.z > 0.0)
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use super::*;
    use crate::cases::cosine;
    use crate::{LightModel, NormalsRule};
    use ltcforge_fit::BrdfKind;

    fn normals(rule: NormalsRule) -> Lighting<'static> {
        Lighting::ClosedForm(LightModel::Normals.closed_form(Some(rule)).expect("a formula"))
    }

    const RANGE: PerAxis<[f64; 2]> =
        PerAxis { alpha: [1e-4, 1.0], ratio: [0.0, 1.0], theta: [0.0, FRAC_PI_2], phi: [0.0, FRAC_PI_2] };

    fn lights(range: &PerAxis<[f64; 2]>, count: usize) -> RandomLights {
        RandomLights::draw(&BrdfKind::Ggx.into(), range, count).expect("ranges of a table")
    }

    /// A black material reflects only Schlick's part, and a mirror reflects everything.
    #[test]
    fn errors_of_materials_lie_between_the_errors_of_both_parts() {
        let everywhere = PerAxis { phi: [0.0, 0.1], ..EVERYWHERE };
        let lights = RandomLights::draw(&BrdfKind::Ggx.into(), &everywhere, 60).expect("lights");
        let form = LightModel::Normals.closed_form(None).expect("a formula");
        let error = |f0: f64| material_error(Lighting::ClosedForm(form), &lights, f0).expect("lights");
        let energy = light_error(Lighting::ClosedForm(form), &lights).expect("lights");
        assert!((error(1.0).mean - energy.mean).abs() < 1e-15);
        let means = [0.0, 0.04, 1.0].map(|f0| lights.mean_reflected(f0));
        assert!(means[0] > 0.0 && means[0] < means[1] && means[1] < means[2], "{means:?}");
        assert!((means[2] - lights.mean_energy()).abs() < 1e-15);
        assert!(error(0.04).mean < 0.04 * energy.mean + error(0.0).mean + 1e-15);
    }

    #[test]
    fn lights_lie_where_they_are_asked_for_and_come_again() {
        let narrow = PerAxis { alpha: [0.2, 0.5], ratio: [0.5, 0.5], theta: [0.1, 0.4], phi: [0.7, 0.7] };
        let [once, again] = [0; 2].map(|_: u32| lights(&narrow, 50));
        assert_eq!((once.len(), &once.truth), (50, &again.truth));
        assert!((0.1..0.9).contains(&once.mean_energy()), "{}", once.mean_energy());
        for Lit { at, light } in &once.lit {
            assert!((0.2..=0.5).contains(&at.alpha_x) && (at.alpha_y - 0.5 * at.alpha_x).abs() < 1e-12, "{at:?}");
            assert!((0.1..=0.4).contains(&at.theta) && at.phi == 0.7, "{at:?}");
            let [a, b, c, d] = light.vertices() else { panic!("{light:?}") };
            let middle = *a + *b + *c + *d;
            assert!(middle.z > 0.0 && (*b - *a).dot(*c - *b).abs() < 1e-9 * middle.length_squared(), "{light:?}");
        }
        assert!(
            RandomLights::draw(&BrdfKind::Ggx.into(), &PerAxis { alpha: [0.5, 0.5], theta: [-1.0, -1.0], ..RANGE }, 3)
                .is_err()
        );
    }

    #[test]
    fn more_normals_are_nearer_and_a_wrong_model_is_found_out() {
        let lights = lights(&RANGE, 400);
        let error = |rule| light_error(normals(rule), &lights).expect("a surface").mean;
        let [fast, balanced, fine] = [NormalsRule::Fast, NormalsRule::Balanced, NormalsRule::Fine].map(error);
        assert!(10.0 * TOLERANCE < fine && 1.2 * fine < balanced, "{fine} {balanced}");
        assert!(1.2 * balanced < fast && fast < 0.002, "{balanced} {fast}");
        let wrong = light_error(Lighting::by(&cosine(BrdfKind::Ggx.into())), &lights).expect("a lobe");
        assert!(wrong.mean > 0.05 && wrong.max > 0.5, "{wrong:?}");
        assert!(wrong.mean < wrong.p95 && wrong.p95 <= wrong.max, "{wrong:?}");
        let flat = Table { matrix: vec![[0.0; 9]], ..cosine(BrdfKind::Ggx.into()) };
        assert_eq!(light_error(Lighting::by(&flat), &lights).err(), Some(LightError::Singular));
    }
}
