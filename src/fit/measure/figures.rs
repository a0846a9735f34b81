//! The errors of a table at a configuration, relative to the exact lobe.

use rayon::prelude::*;

use super::{
    distance::{LobeDistance, Probe, Workspace},
    light::light_error,
    lobe::Lobe,
};
use crate::{
    ALPHA_FLOOR, BrdfModel, Configuration, LEAST_ALPHA, LobeModel, LookedUp, Table, lobe::LobeDistribution,
    math::direction,
};

/// Returns true if a measurement should continue. Several threads call it.
pub type GoOn<'a> = dyn Fn() -> bool + Sync + 'a;

/// The errors of one configuration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Figures {
    /// The configuration.
    pub at: Configuration,
    /// Sliced Wasserstein-1 distance between the lobe and the distribution that represents it.
    pub sw1: f64,
    /// The distance `sw1` relative to the lobe's width.
    pub width: f64,
    /// Mean absolute error of the energy in a few square lights.
    pub light: f64,
    /// Absolute errors of amplitude and Fresnel term, if they are known.
    pub terms: Option<[f64; 2]>,
}

/// The errors of lookups, in order. The lookups need not come from a table. Runs on the current rayon pool. The size of
/// the pool does not change the result.
#[must_use]
pub fn figures_of(brdf: &BrdfModel, lobe: LobeModel, found: &[(Configuration, LookedUp)]) -> Vec<Figures> {
    let probe = Probe::new();
    let measure =
        |work: &mut Workspace, (at, found): &(Configuration, LookedUp)| of_numbers(brdf, lobe, at, found, &probe, work);
    found.par_iter().with_max_len(4).map_init(Workspace::default, measure).collect()
}

/// The errors at each configuration, in order.
pub(super) fn all(table: &Table, places: &[Configuration]) -> Vec<Figures> {
    let probe = Probe::new();
    let measure = |work: &mut Workspace, at: &Configuration| one(table, at, &probe, work);
    places.par_iter().with_max_len(4).map_init(Workspace::default, measure).collect()
}

/// The errors at each configuration, in order; `None` if `go_on`, called before each configuration, returns false.
pub(super) fn all_while(go_on: &GoOn, table: &Table, places: &[Configuration]) -> Option<Vec<Figures>> {
    found_while(go_on, &table.brdf, table.lobe, places, |at| table.lookup(at))
}

/// Like [`all_while`], for lookups that a function returns for each configuration.
pub(super) fn found_while(
    go_on: &GoOn,
    brdf: &BrdfModel,
    lobe: LobeModel,
    places: &[Configuration],
    found: impl Fn(&Configuration) -> LookedUp + Sync,
) -> Option<Vec<Figures>> {
    let probe = Probe::new();
    let measure = |work: &mut Workspace, at: &Configuration| {
        go_on().then(|| of_numbers(brdf, lobe, at, &found(at), &probe, work))
    };
    places.par_iter().with_max_len(4).map_init(Workspace::default, measure).collect()
}

fn one(table: &Table, at: &Configuration, probe: &Probe, work: &mut Workspace) -> Figures {
    of_numbers(&table.brdf, table.lobe, at, &table.lookup(at), probe, work)
}

fn of_numbers(
    brdf: &BrdfModel,
    lobe_model: LobeModel,
    at: &Configuration,
    found: &LookedUp,
    probe: &Probe,
    work: &mut Workspace,
) -> Figures {
    let (roughness, wo) = ([at.alpha_x.max(ALPHA_FLOOR), at.alpha_y.max(LEAST_ALPHA)], direction(at.theta, at.phi));
    let lobe = Lobe::sample(&*brdf.lobe_surface(roughness, wo), wo);
    let model = lobe_model.distribution(&found.matrix);
    let model = model.as_deref();
    let LobeDistance { sw1, spread } = probe.distance(&lobe, model, work);
    let light = model.map_or(1.0, |model| light_error(&lobe, model));
    let terms = found.amplitude.zip(found.fresnel);
    let above = model.map_or(1.0, LobeDistribution::above_horizon);
    let terms = terms.map(|(amplitude, fresnel)| (above * amplitude, above * fresnel));
    // The terms are for a Fresnel factor of one, even if the lobe has a different factor.
    let plain = (!brdf.fresnel().is_one() && terms.is_some()).then(|| Lobe::sample(&*brdf.surface(roughness), wo));
    let of_one = plain.as_ref().unwrap_or(&lobe);
    let terms =
        terms.map(|(amplitude, fresnel)| [(amplitude - of_one.amplitude).abs(), (fresnel - of_one.fresnel).abs()]);
    Figures { at: *at, sw1, width: sw1 / spread, light, terms }
}
