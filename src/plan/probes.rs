//! Configurations of a scene with the lobes and the true light of its materials, for measuring the errors of tables.

use std::sync::OnceLock;

use crate::{
    histogram::LEAST_METAL,
    needs::Needs,
    scene::{LobeKind, Place, SceneLight},
};
use ltcforge_fit::{
    BrdfModel, Closeness, LobeFresnel, LobeModel, LookedUp, SampledLobes, Table, WeightedF0, brdf::LobeTerms, terms_of,
};
use ltcforge_light::{AnyLight, Lighting, LitSurface, LitSurfaces, RandomLights};

/// Number of configurations at which the error of a table is measured.
pub(crate) const POINTS: usize = 256;
/// Number of configurations for errors that only show how much worse one table is than another. They are the first of
/// all configurations.
const COARSE_POINTS: usize = 64;

/// The caller's `go_on` returned `false`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("stopped")]
pub struct Stopped;

/// Configurations of a scene with the lobes and the light of its materials.
#[derive(Debug, Clone)]
pub(crate) struct Probes {
    pub(crate) places: Vec<Place>,
    /// The lobes; `None` under the scene's own lights. Errors are then errors of the light.
    lobes: Option<SampledLobes>,
    /// The places under the scene's own lights, or each under a random rectangle.
    surfaces: Vec<LitSurface>,
    lit: OnceLock<Option<LitSurfaces>>,
    brdf: BrdfModel,
}

impl Probes {
    /// Draws configurations by their weights in the scene, or takes the points of its surface under its own lights.
    /// Runs on the current rayon pool. The size of the pool does not change the result.
    pub(crate) fn new(needs: &Needs<'_>, count: usize) -> Self {
        let brdf = BrdfModel::from(needs.brdf);
        let lit = needs.lit();
        let places = if lit.is_empty() { needs.draw(count) } else { lit };
        let is_lit = !needs.scene.lights.is_empty();
        // The brightest light counts as radiance 1, so that errors do not depend on the unit of the scene.
        let brightest = needs.scene.lights.iter().map(|light| light.radiance).fold(0.0, f64::max);
        let radiance =
            |(index, light): &(usize, AnyLight)| (needs.scene.lights[*index].radiance / brightest, light.clone());
        let lights: Vec<Vec<(f64, AnyLight)>> = if is_lit {
            places.iter().map(|place| place.lights.iter().map(radiance).collect()).collect()
        } else {
            let around = RandomLights::around(&brdf, &places.iter().map(|place| place.at).collect::<Vec<_>>());
            around
                .into_iter()
                .map(|light| light.into_iter().map(|light| (1.0, AnyLight::Polygon(light))).collect())
                .collect()
        };
        let surface = |(place, lights): (&Place, _)| LitSurface { at: place.at, fresnel: place.fresnel, lights };
        let surfaces = places.iter().zip(lights).map(surface).collect();
        let model = |place: &Place| {
            let material = LobeFresnel::mix(vec![WeightedF0 { f0: place.f0(), weight: 1.0 }]).unwrap_or_default();
            (brdf.clone().with_fresnel(material), place.at)
        };
        let lobes = (!is_lit).then(|| SampledLobes::new(&places.iter().map(model).collect::<Vec<_>>()));
        Self { lobes, surfaces, lit: OnceLock::new(), brdf, places }
    }

    /// Whether errors are errors of light, under the scene's own lights.
    pub(crate) fn are_lit(&self) -> bool {
        self.lobes.is_none()
    }

    /// Mean error of a table: as a fraction of the width of the material's lobe, or of light.
    pub(crate) fn error(&self, table: &Table) -> f64 {
        self.error_as(table, table.brdf.fresnel(), Closeness::Report)
    }

    /// Mean error of a table that is read as if it was fitted to `lobes`.
    pub(crate) fn error_as(&self, table: &Table, lobes: &LobeFresnel, closeness: Closeness) -> f64 {
        self.mean(&self.errors_as(table, lobes, closeness))
    }

    /// The error of a table at each place. A table with two lobes is blended for the reflectance that one lobe would be
    /// fitted to.
    pub(crate) fn errors_as(&self, table: &Table, lobes: &LobeFresnel, closeness: Closeness) -> Vec<f64> {
        let points = if closeness == Closeness::Coarse && !self.are_lit() { COARSE_POINTS } else { self.places.len() };
        // Light needs terms.
        let own = (self.are_lit() && table.terms.is_none())
            .then(|| Table { terms: Some(terms_of(&table.brdf, table.layout, &table.axes)), ..table.clone() });
        let table = own.as_ref().unwrap_or(table);
        let at = |place: &Place| {
            let found = table.lookup(&place.at);
            let terms = found.amplitude.zip(found.fresnel).filter(|_| lobes.second().is_none());
            let f0 = terms.map_or(place.f0(), |(amplitude, fresnel)| lobes.f0(&LobeTerms { amplitude, fresnel }));
            found.blended_for(f0)
        };
        self.errors_of(table.lobe, &self.places.iter().take(points).map(at).collect::<Vec<_>>(), closeness)
    }

    /// The errors of lobes, each fitted for one of the first places.
    pub(crate) fn errors_of_lobes(&self, lobes: &[LookedUp]) -> Vec<f64> {
        let blended = self.places.iter().zip(lobes).map(|(place, lobe)| lobe.blended_for(place.f0()));
        self.errors_of(LobeModel::Ltc, &blended.collect::<Vec<_>>(), Closeness::Report)
    }

    /// Whether light is reflected at a place of the lobe. Light comes from everywhere if the scene has no lights.
    pub(crate) fn reaches(&self, of: (usize, LobeKind)) -> bool {
        let truth = self.lit().map_or(&[][..], |lit| lit.truth());
        let mut lit = self.places.iter().zip(truth);
        !self.are_lit() || lit.any(|(place, truth)| place.of == of && truth.iter().any(|light| *light > 0.0))
    }

    /// How many times the light of lobes is farther than `stock` from dielectrics or from metal, at least 1. Each lobe
    /// is fitted for one of the first places.
    pub(crate) fn farther(&self, lobes: &[LookedUp], stock: &[f64]) -> f64 {
        let errors =
            self.lit().and_then(|lit| lit.errors_of(lobes).ok()).map_or(vec![f64::INFINITY; lobes.len()], sums);
        let ratio = |is_metal: bool| {
            let mean = |errors: &[f64]| self.mean_where(errors, |place| (place.f0() >= LEAST_METAL) == is_metal);
            mean(&errors) / mean(&stock[..errors.len()]).max(f64::MIN_POSITIVE)
        };
        ratio(false).max(ratio(true)).max(1.0)
    }

    fn errors_of(&self, model: LobeModel, found: &[LookedUp], closeness: Closeness) -> Vec<f64> {
        let of_light = || Some(sums(self.lit()?.errors_of(found).ok()?));
        match &self.lobes {
            Some(lobes) => lobes.widths(model, found, closeness),
            None => of_light().unwrap_or_else(|| vec![f64::INFINITY; found.len()]),
        }
    }

    /// The true light, which is computed when it is first needed.
    fn lit(&self) -> Option<&LitSurfaces> {
        self.lit.get_or_init(|| LitSurfaces::new(self.brdf.clone(), self.surfaces.clone()).ok()).as_ref()
    }

    /// Absolute error of the light at each place; `None` if the model cannot light the surfaces.
    pub(crate) fn light_errors(&self, model: Lighting<'_>) -> Option<Vec<f64>> {
        Some(sums(self.lit()?.errors(model).ok()?))
    }

    /// The light of the scene with the largest mean error, and this error. Lights of one name are one light.
    pub(crate) fn worst_light<'a>(&self, model: Lighting<'_>, lights: &'a [SceneLight]) -> Option<(&'a str, f64)> {
        let errors = self.lit().filter(|_| self.are_lit())?.errors(model).ok()?;
        let at = |(place, errors): (&Place, &Vec<f64>), name: &str| {
            let own = place.lights.iter().zip(errors).filter(|((light, _), _)| lights[*light].name == name);
            own.map(|(_, error)| error).sum::<f64>().abs()
        };
        let mean = |name: &'a str| {
            let of_light: Vec<f64> = self.places.iter().zip(&errors).map(|pair| at(pair, name)).collect();
            (name, self.mean(&of_light))
        };
        lights.iter().map(|light| mean(&light.name)).max_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// Weighted mean of the errors at the first places.
    pub(crate) fn mean(&self, errors: &[f64]) -> f64 {
        self.mean_where(errors, |_| true)
    }

    /// Weighted mean of the errors at the places of a lobe; 0 without a place.
    pub(crate) fn mean_of(&self, errors: &[f64], of: (usize, LobeKind)) -> f64 {
        self.mean_where(errors, |place| place.of == of)
    }

    fn mean_where(&self, errors: &[f64], is_wanted: impl Fn(&Place) -> bool) -> f64 {
        let wanted = self.places.iter().zip(errors).filter(|(place, _)| is_wanted(place));
        let [sum, weight] =
            wanted.fold([0.0; 2], |[sum, weight], (place, error)| [sum + place.weight * error, weight + place.weight]);
        if weight > 0.0 { sum / weight } else { 0.0 }
    }
}

/// The absolute error of the light of all lights, for each place.
fn sums(errors: Vec<Vec<f64>>) -> Vec<f64> {
    errors.into_iter().map(|of_lights| of_lights.into_iter().sum::<f64>().abs()).collect()
}
