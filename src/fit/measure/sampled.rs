//! Lobes that are sampled once and compared with any number of tables.

use rayon::prelude::*;

use super::{
    distance::{LOG2_DIRECTIONS, Probe, Workspace},
    lobe::Lobe,
};
use crate::{ALPHA_FLOOR, BrdfModel, Configuration, LEAST_ALPHA, LobeModel, LookedUp, math::direction};

/// The precision with which stored numbers are compared with lobes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Closeness {
    /// The directions of a report: [`Figures::width`](crate::Figures::width).
    Report,
    /// A quarter of the directions, in a quarter of the time. This is enough to compare two tables at the same lobes.
    Coarse,
}

/// The lobes of some configurations.
#[derive(Debug, Clone)]
pub struct SampledLobes {
    lobes: Vec<Lobe>,
}

impl SampledLobes {
    /// Samples the lobe of each model at its configuration. Runs on the current rayon pool. The size of the pool does
    /// not change the result.
    #[must_use]
    pub fn new(at: &[(BrdfModel, Configuration)]) -> Self {
        let sampled = |(brdf, at): &(BrdfModel, Configuration)| {
            let wo = direction(at.theta, at.phi);
            let roughness = [at.alpha_x.max(ALPHA_FLOOR), at.alpha_y.max(LEAST_ALPHA)];
            Lobe::sample(&*brdf.lobe_surface(roughness, wo), wo)
        };
        Self { lobes: at.par_iter().with_max_len(4).map(sampled).collect() }
    }

    /// The distance of each lobe from the distribution that represents it, relative to the lobe's width, in order.
    /// Surplus lobes are ignored. Runs on the current rayon pool. The size of the pool does not change the result.
    #[must_use]
    pub fn widths(&self, model: LobeModel, found: &[LookedUp], closeness: Closeness) -> Vec<f64> {
        let probe = Probe::of_directions(match closeness {
            Closeness::Report => LOG2_DIRECTIONS,
            Closeness::Coarse => LOG2_DIRECTIONS - 2,
        });
        let width = |work: &mut Workspace, (lobe, found): (&Lobe, &LookedUp)| {
            let distance = probe.distance(lobe, model.distribution(&found.matrix).as_deref(), work);
            distance.sw1 / distance.spread
        };
        self.lobes.par_iter().zip(found).with_max_len(4).map_init(Workspace::default, width).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{BrdfKind, LobeFresnel, WeightedF0, figures_of};

    fn places() -> Vec<(BrdfModel, Configuration)> {
        let model = |f0: f64| {
            let fresnel = LobeFresnel::mix(vec![WeightedF0 { f0, weight: 1.0 }]).expect("a material");
            BrdfModel::from(BrdfKind::Ggx).with_fresnel(fresnel)
        };
        [(1.0, 0.1, 0.3), (0.04, 0.5, 1.2), (0.04, 0.02, 0.8)]
            .map(|(f0, alpha, theta)| {
                (model(f0), Configuration { alpha_x: alpha, alpha_y: 0.5 * alpha, theta, phi: 0.4 })
            })
            .to_vec()
    }

    fn found(spread: f64) -> LookedUp {
        let matrix = [spread, 0.0, 0.2, 0.0, spread, 0.0, 0.0, 0.0, 1.0];
        LookedUp { matrix, second: None, amplitude: None, fresnel: None, edge: None }
    }

    #[test]
    fn widths_equal_the_figures() {
        let at = places();
        let lobes = SampledLobes::new(&at);
        let found = [found(0.2), found(0.6), found(f64::NAN)];
        let widths = lobes.widths(LobeModel::Ltc, &found, Closeness::Report);
        for (((brdf, at), found), width) in at.iter().zip(found).zip(&widths) {
            let figures = figures_of(brdf, LobeModel::Ltc, &[(*at, found)]);
            assert_eq!(figures[0].width.to_bits(), width.to_bits());
        }
        assert_eq!(lobes.widths(LobeModel::Ltc, &found[..1], Closeness::Report), widths[..1]);
    }

    #[test]
    fn fewer_directions_give_nearly_the_same() {
        let lobes = SampledLobes::new(&places());
        for spread in [0.1, 0.3, 0.6] {
            let of = |closeness| lobes.widths(LobeModel::Ltc, &[found(spread); 3], closeness);
            for (report, coarse) in of(Closeness::Report).iter().zip(of(Closeness::Coarse)) {
                assert!((coarse / report - 1.0).abs() < 0.1, "{spread}: {coarse} {report}");
            }
        }
    }
}
