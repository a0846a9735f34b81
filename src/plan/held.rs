//! The errors of tables on a scene, held to the lobes of its materials.

use crate::needs::Place;
use ltcforge_fit::{
    BrdfKind, BrdfModel, Configuration, LobeFresnel, LobeModel, LookedUp, Table, WeightedF0, figures_of,
};

/// Configurations at which a plan is measured, predicted and fitted alike.
pub(crate) const POINTS: usize = 256;
/// Why there is no prediction.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("stopped")]
pub struct Stopped;

/// Mean error of a table at some places, as a part of the width of the lobe of the material that is there.
#[must_use]
pub(crate) fn error(table: &Table, places: &[Place]) -> f64 {
    let found: Vec<_> = places.iter().map(|place| (*place, table.lookup(&place.at))).collect();
    error_of(table.brdf(), table.lobe(), &found)
}

/// The same of numbers that are found at each place, whether they come from a table or not. Domain: one place at least.
#[must_use]
pub(crate) fn error_of(brdf: BrdfKind, lobe: LobeModel, found: &[(Place, LookedUp)]) -> f64 {
    let mut of_f0: Vec<(f64, Vec<(Configuration, LookedUp)>)> = Vec::new();
    for (Place { at, f0 }, found) in found {
        let found = (*at, found.blended_for(*f0));
        match of_f0.iter_mut().find(|(known, _)| known == f0) {
            Some((_, of)) => of.push(found),
            None => of_f0.push((*f0, vec![found])),
        }
    }
    let sum = |(f0, found): &(f64, Vec<_>)| {
        let material = LobeFresnel::mix(vec![WeightedF0 { f0: *f0, weight: 1.0 }]).unwrap_or_default();
        let model = BrdfModel::from(brdf).with_fresnel(material);
        figures_of(&model, lobe, found).iter().map(|figures| figures.width).sum::<f64>()
    };
    of_f0.iter().map(sum).sum::<f64>() / found.len() as f64
}
