//! The errors of a table at a configuration, compared with the lobe that it stands for.

use rayon::prelude::*;

use super::{
    distance::{LobeDistance, Probe, Workspace},
    light::light_error,
    lobe::Lobe,
};
use crate::{ALPHA_FLOOR, Configuration, LEAST_ALPHA, Table, lobe::LobeDistribution, math::direction};

/// Asked whether a measurement is to go on. Several threads ask.
pub type GoOn<'a> = dyn Fn() -> bool + Sync + 'a;

/// The figures of one configuration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Figures {
    pub(super) at: Configuration,
    /// Sliced Wasserstein-1 distance between the lobe and the distribution that stands for it.
    pub(super) sw1: f64,
    /// The same as a part of the lobe's width.
    pub(super) width: f64,
    /// Mean absolute error of the energy in a few square lights.
    pub(super) light: f64,
    /// Absolute errors of amplitude and Fresnel term, where the table has them.
    pub(super) terms: Option<[f64; 2]>,
}

/// The figures at each place, in order.
pub(super) fn all(table: &Table, places: &[Configuration]) -> Vec<Figures> {
    let probe = Probe::new();
    let measure = |work: &mut Workspace, at: &Configuration| one(table, at, &probe, work);
    places.par_iter().with_max_len(4).map_init(Workspace::default, measure).collect()
}

/// The figures at each place, in order; `None` when `go_on`, which is asked before each place, says no.
pub(super) fn all_while(go_on: &GoOn, table: &Table, places: &[Configuration]) -> Option<Vec<Figures>> {
    let probe = Probe::new();
    let measure = |work: &mut Workspace, at: &Configuration| go_on().then(|| one(table, at, &probe, work));
    places.par_iter().with_max_len(4).map_init(Workspace::default, measure).collect()
}

fn one(table: &Table, at: &Configuration, probe: &Probe, work: &mut Workspace) -> Figures {
    let surface = table.brdf.surface([at.alpha_x.max(ALPHA_FLOOR), at.alpha_y.max(LEAST_ALPHA)]);
    let lobe = Lobe::sample(&*surface, direction(at.theta, at.phi));
    let found = table.lookup(at);
    let model = table.lobe.distribution(&found.matrix);
    let model = model.as_deref();
    let LobeDistance { sw1, spread } = probe.distance(&lobe, model, work);
    let light = model.map_or(1.0, |model| light_error(&lobe, model));
    let terms = found.amplitude.zip(found.fresnel);
    let above = model.map_or(1.0, LobeDistribution::above_horizon);
    let terms = terms.map(|(amplitude, fresnel)| (above * amplitude, above * fresnel));
    let terms = terms.map(|(amplitude, fresnel)| [(amplitude - lobe.amplitude).abs(), (fresnel - lobe.fresnel).abs()]);
    Figures { at: *at, sw1, width: sw1 / spread, light, terms }
}
