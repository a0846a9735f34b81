//! Configurations of a scene with the lobes of its materials, for measuring the errors of tables.

use crate::needs::{Needs, Place};
use ltcforge_fit::{
    BrdfModel, Closeness, LobeFresnel, LobeModel, LookedUp, SampledLobes, Table, WeightedF0, brdf::LobeTerms,
};

/// Number of configurations at which the error of a table is measured.
const POINTS: usize = 256;
/// Number of configurations for errors that only show how much worse one table is than another. They are the first of
/// all configurations.
const COARSE_POINTS: usize = 64;

/// The caller's `go_on` returned `false`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("stopped")]
pub struct Stopped;

/// Configurations of a scene with the lobes of its materials.
#[derive(Debug, Clone)]
pub(crate) struct Probes {
    pub(crate) places: Vec<Place>,
    lobes: SampledLobes,
}

impl Probes {
    /// Draws configurations by their weights in the scene. Runs on the current rayon pool. The size of the pool does
    /// not change the result.
    pub(crate) fn new(needs: &Needs<'_>) -> Self {
        let places = needs.draw(POINTS);
        let model = |place: &Place| {
            let material = LobeFresnel::mix(vec![WeightedF0 { f0: place.f0, weight: 1.0 }]).unwrap_or_default();
            (BrdfModel::from(needs.brdf).with_fresnel(material), place.at)
        };
        let at: Vec<_> = places.iter().map(model).collect();
        Self { lobes: SampledLobes::new(&at), places }
    }

    /// Mean error of a table, as a fraction of the width of the material's lobe.
    pub(crate) fn error(&self, table: &Table) -> f64 {
        self.error_as(table, table.brdf.fresnel(), Closeness::Report)
    }

    /// Mean error of a table that is read as if it was fitted to `lobes`. A table with two lobes is blended for the
    /// reflectance that one lobe would be fitted to.
    pub(crate) fn error_as(&self, table: &Table, lobes: &LobeFresnel, closeness: Closeness) -> f64 {
        let points = if closeness == Closeness::Coarse { COARSE_POINTS } else { POINTS };
        let at = |place: &Place| {
            let found = table.lookup(&place.at);
            let terms = found.amplitude.zip(found.fresnel).filter(|_| lobes.second().is_none());
            let f0 = terms.map_or(place.f0, |(amplitude, fresnel)| lobes.f0(&LobeTerms { amplitude, fresnel }));
            found.blended_for(f0)
        };
        self.mean(table.lobe, &self.places[..points].iter().map(at).collect::<Vec<_>>(), closeness)
    }

    /// Mean error of lobes, each fitted for one of the first places. Domain: at least one lobe.
    pub(crate) fn error_of(&self, lobes: &[LookedUp]) -> f64 {
        let blended = self.places.iter().zip(lobes).map(|(place, lobe)| lobe.blended_for(place.f0));
        self.mean(LobeModel::Ltc, &blended.collect::<Vec<_>>(), Closeness::Report)
    }

    fn mean(&self, model: LobeModel, found: &[LookedUp], closeness: Closeness) -> f64 {
        self.lobes.widths(model, found, closeness).iter().sum::<f64>() / found.len() as f64
    }
}
