//! What a table gives at a configuration, beside the lobe that it stands for.

use rayon::prelude::*;

use super::{
    distance::{Distance, LOBE_SAMPLES, Probe, SHIFT, Workspace},
    light::light_error,
};
use crate::fit::{
    ALPHA_FLOOR, Configuration, LEAST_ALPHA, Table,
    brdf::Ggx,
    brdf::Mirrors,
    math::{Lattice, direction, from_row_major},
    metric::Target,
};

/// The figures of one configuration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Figures {
    pub(super) at: Configuration,
    /// Sliced Wasserstein-1 distance between lobe and LTC.
    pub(super) sw1: f64,
    /// The same as a part of the lobe's width.
    pub(super) width: f64,
    /// Mean absolute error of the energy in a few square lights.
    pub(super) light: f64,
    /// Absolute errors of amplitude and Fresnel term, where the table has them.
    pub(super) terms: Option<[f64; 2]>,
}

/// The farthest that two distributions of directions can be from each other. A matrix that makes no distribution
/// counts as that far.
pub(super) const FARTHEST: f64 = 2.0;

/// The figures at each place, in order.
pub(super) fn all(table: &Table, places: &[Configuration]) -> Vec<Figures> {
    let probe = Probe::new();
    let measure = |work: &mut Workspace, at: &Configuration| one(table, at, &probe, work);
    places.par_iter().with_max_len(4).map_init(Workspace::default, measure).collect()
}

fn one(table: &Table, at: &Configuration, probe: &Probe, work: &mut Workspace) -> Figures {
    let ggx = Ggx { alpha_x: at.alpha_x.max(ALPHA_FLOOR), alpha_y: at.alpha_y.max(LEAST_ALPHA) };
    let wo = direction(at.theta, at.phi);
    let target = Target::sample(&ggx, wo, Mirrors::of(wo), Lattice::new(LOBE_SAMPLES, SHIFT));
    let found = table.lookup(at);
    let m = from_row_major(&found.matrix);
    let inverse = m.inverse();
    let is_regular = m.determinant() != 0.0 && inverse.is_finite();
    // The spread is the lobe's alone.
    let Distance { sw1, spread } = probe.distance(&target, if is_regular { &m } else { &target.frame }, work);
    let (sw1, light) = if is_regular { (sw1, light_error(&target, &inverse)) } else { (FARTHEST, 1.0) };
    let terms = found.amplitude.zip(found.fresnel).map(|(amplitude, fresnel)| {
        [(amplitude - target.terms.amplitude).abs(), (fresnel - target.terms.fresnel).abs()]
    });
    Figures { at: *at, sw1, width: sw1 / spread, light, terms }
}
