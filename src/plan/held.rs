//! The errors of tables on a scene, held to the lobes of its materials.

use crate::needs::{Needs, Place};
use ltcforge_fit::{
    BrdfModel, Closeness, LobeFresnel, LobeModel, LookedUp, SampledLobes, Table, WeightedF0, brdf::LobeTerms,
};

/// Configurations at which a plan is measured, predicted and fitted alike.
const POINTS: usize = 256;

/// Why there is no prediction.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("stopped")]
pub struct Stopped;

/// Places of a scene with the lobes of the materials that are there.
#[derive(Debug, Clone)]
pub(crate) struct Held {
    places: Vec<Place>,
    lobes: SampledLobes,
}

impl Held {
    /// The places of a plan, as often as the scene has them. Runs on the current rayon pool, whose size changes nothing.
    pub(crate) fn new(needs: &Needs<'_>) -> Self {
        let places = needs.draw(POINTS);
        let model = |place: &Place| {
            let material = LobeFresnel::mix(vec![WeightedF0 { f0: place.f0, weight: 1.0 }]).unwrap_or_default();
            (BrdfModel::from(needs.brdf()).with_fresnel(material), place.at)
        };
        let at: Vec<_> = places.iter().map(model).collect();
        Self { lobes: SampledLobes::new(&at), places }
    }

    /// The places.
    pub(crate) fn places(&self) -> &[Place] {
        &self.places
    }

    /// Mean error of a table at all places, as a part of the width of the lobe of the material that is there.
    pub(crate) fn error(&self, table: &Table) -> f64 {
        self.error_as(table, table.brdf.fresnel())
    }

    /// The same where the table stands for one of some lobes: of a table of two lobes an entry, their blend at the reflectance to
    /// which the one would be fitted.
    pub(crate) fn error_as(&self, table: &Table, lobes: &LobeFresnel) -> f64 {
        self.mean(table.lobe, &looked_up(table, lobes, &self.places), Closeness::Report)
    }

    /// The same at the first places, coarsely: for the difference of two tables.
    pub(crate) fn coarse_error_as(&self, table: &Table, lobes: &LobeFresnel, places: usize) -> f64 {
        self.mean(table.lobe, &looked_up(table, lobes, &self.places[..places]), Closeness::Coarse)
    }

    /// The same of numbers that stand for the lobes of the first places, whether they come from a table or not. Domain: one at least.
    pub(crate) fn error_of(&self, found: &[(Place, LookedUp)]) -> f64 {
        let found: Vec<LookedUp> = found.iter().map(|(place, found)| found.blended_for(place.f0)).collect();
        self.mean(LobeModel::Ltc, &found, Closeness::Report)
    }

    fn mean(&self, lobe: LobeModel, found: &[LookedUp], closeness: Closeness) -> f64 {
        self.lobes.widths(lobe, found, closeness).iter().sum::<f64>() / found.len() as f64
    }
}

/// A table's matrices and terms at `places`. The table is read as one that was fitted to `lobes`.
fn looked_up(table: &Table, lobes: &LobeFresnel, places: &[Place]) -> Vec<LookedUp> {
    let at = |place: &Place| {
        let found = table.lookup(&place.at);
        let terms = found.amplitude.zip(found.fresnel);
        let f0 = match terms.filter(|_| lobes.second().is_none()) {
            Some((amplitude, fresnel)) => lobes.f0(&LobeTerms { amplitude, fresnel }),
            None => place.f0,
        };
        found.blended_for(f0)
    };
    places.iter().map(at).collect()
}
