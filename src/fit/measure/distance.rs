//! The sliced Wasserstein-1 distance between a lobe and the LTC of any matrix, good or bad.
//!
//! `SW1 = mean_d integral |F_d(x) - G_d(x)| dx` over directions `d`, where `F_d` and `G_d` are the cumulative
//! distributions of lobe and LTC projected on `d` [KT et al. 2022, equation 9]. Both come from weighted samples, so
//! they are step functions. The integral is a sum over the sorted projections, and exact for the samples.
//!
//! Invariant: this file shares neither code nor samples with the loss that fits minimise.

use glam::DVec3;

use super::{
    lobe::Lobe,
    sequence::{net, uniform},
    steps::Steps,
};
use crate::{lobe::LobeDistribution, math::rotation_from_z};

/// Samples of the LTC: `2^11`.
const LOG2_SAMPLES: u32 = 11;
/// Digital shift of the points of the LTC's samples.
const SCRAMBLE: [u32; 2] = [0x1b87_3593, 0x7f4a_7c15];
/// Directions of the projections: `2^5`.
pub(super) const LOG2_DIRECTIONS: u32 = 5;

/// The largest possible distance between two distributions of directions. It is also the result for invalid numbers.
pub(super) const FARTHEST: f64 = 2.0;

/// The distance of a distribution from the lobe that it represents.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LobeDistance {
    /// Sliced Wasserstein-1 distance.
    pub(super) sw1: f64,
    /// The lobe's width: the mean absolute deviation of its projections from their median.
    pub(super) spread: f64,
}

/// Buffers that measurements reuse.
#[derive(Debug, Default)]
pub(super) struct Workspace {
    lobe: Offsets,
    model: Offsets,
    steps: Steps,
}

/// The fixed samples and directions.
#[derive(Debug)]
pub(super) struct Probe {
    points: Vec<[f64; 2]>,
    directions: Vec<DVec3>,
}

impl Probe {
    pub(super) fn new() -> Self {
        Self::of_directions(LOG2_DIRECTIONS)
    }

    /// A probe of `2^log2_directions` directions.
    pub(super) fn of_directions(log2_directions: u32) -> Self {
        Self {
            points: net(LOG2_SAMPLES, SCRAMBLE).collect(),
            // A projection on -d mirrors the projection on d, so the half sphere suffices.
            directions: net(log2_directions, [0, 0]).map(uniform).collect(),
        }
    }

    /// The distance between `lobe` and the distribution that represents it; [`FARTHEST`] without a distribution.
    pub(super) fn distance(
        &self,
        lobe: &Lobe,
        model: Option<&dyn LobeDistribution>,
        work: &mut Workspace,
    ) -> LobeDistance {
        // The directions are evenly spaced around the lobe. Offsets from its axis keep the digits of a sharp lobe in
        // f32; directions would lose them.
        let frame = rotation_from_z(lobe.axis);
        work.lobe.fill(lobe.directions.iter().map(|w| *w - lobe.axis));
        let samples = model.iter().flat_map(|model| self.points.iter().map(|u| model.sample(*u)));
        work.model.fill(samples.map(|w| w - lobe.axis));
        let share = -1.0 / self.points.len() as f32;
        let (mut sw1, mut spread) = (0.0, 0.0);
        for direction in &self.directions {
            let d = (frame * *direction).as_vec3().to_array();
            work.steps.clear();
            work.steps.extend(work.lobe.projections(d).zip(lobe.weights.iter().map(|weight| *weight as f32)));
            work.steps.extend(work.model.projections(d).map(|x| (x, share)));
            let areas = work.steps.areas();
            sw1 += areas.between;
            spread += areas.deviation;
        }
        let count = self.directions.len() as f64;
        let sw1 = if model.is_some() { sw1 / count } else { FARTHEST };
        LobeDistance { sw1, spread: spread / count }
    }
}

/// Offsets from a lobe's axis, with one array for each coordinate.
#[derive(Debug, Default)]
struct Offsets {
    x: Vec<f32>,
    y: Vec<f32>,
    z: Vec<f32>,
}

impl Offsets {
    fn fill(&mut self, offsets: impl Iterator<Item = DVec3>) {
        for buffer in [&mut self.x, &mut self.y, &mut self.z] {
            buffer.clear();
        }
        for offset in offsets {
            self.x.push(offset.x as f32);
            self.y.push(offset.y as f32);
            self.z.push(offset.z as f32);
        }
    }

    fn projections(&self, [dx, dy, dz]: [f32; 3]) -> impl Iterator<Item = f32> {
        self.x.iter().zip(&self.y).zip(&self.z).map(move |((x, y), z)| dx * x + dy * y + dz * z)
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use glam::DMat3;

    use super::{super::lobe::tests as lobes, *};
    use crate::Ltc;

    fn lobe(scale: f64) -> DMat3 {
        DMat3::from_cols(
            DVec3::new(0.9 * scale, 0.1 * scale, 0.2 * scale),
            DVec3::new(-0.2 * scale, 0.4 * scale, 0.0),
            DVec3::new(-0.6, 0.2, 0.8),
        )
    }

    fn ltc(m: &DMat3) -> Ltc {
        Ltc::new(*m).expect("a regular matrix")
    }

    fn distance(lobe: &Lobe, m: &DMat3) -> LobeDistance {
        Probe::new().distance(lobe, Some(&ltc(m)), &mut Workspace::default())
    }

    /// Along the normal the cumulative distributions of cosine and uniform hemisphere are `z^2` and `z`. Along a
    /// direction in the plane they are the distribution of a semicircle and `(x + 1) / 2`.
    #[test]
    fn cosine_and_uniform_hemisphere_are_as_far_apart_as_their_integrals_say() {
        let hemisphere: Vec<_> = net(12, [3, 9]).map(|u| (uniform(u), 1.0)).collect();
        let hemisphere = lobes::of(&hemisphere);
        for (direction, sw1, spread) in [
            (DVec3::Z, 1.0 / 6.0, 0.25),
            (DVec3::X, 0.5 - 4.0 / (3.0 * PI), 0.5),
            (DVec3::Y, 0.5 - 4.0 / (3.0 * PI), 0.5),
        ] {
            let probe = Probe { directions: vec![direction], ..Probe::new() };
            let found = probe.distance(&hemisphere, Some(&ltc(&DMat3::IDENTITY)), &mut Workspace::default());
            assert!((found.sw1 / sw1 - 1.0).abs() < 0.01, "{direction}: {found:?} {sw1}");
            assert!((found.spread / spread - 1.0).abs() < 0.01, "{direction}: {found:?} {spread}");
        }
    }

    /// The mean of `|d . t|` over directions is half the length of t.
    #[test]
    fn two_needles_are_half_their_distance_apart() {
        for [from, to] in [[DVec3::Z, DVec3::X], [DVec3::new(0.6, 0.0, 0.8), DVec3::new(-0.6, 0.0, 0.8)]] {
            let lobe = lobes::of(&[(from, 1.0)]);
            let needle =
                DMat3::from_cols(1e-6 * to.any_orthonormal_vector(), 1e-6 * to.cross(to.any_orthonormal_vector()), to);
            let found = distance(&lobe, &needle).sw1;
            assert!((found / (0.5 * (from - to).length()) - 1.0).abs() < 0.01, "{from} {to}: {found}");
        }
    }

    /// A sharp LTC is a distribution in a plane. If it is wider by a fifth, each of its quantiles is a fifth farther
    /// out. The samples in its tails cause an error of 0.01 to 0.02.
    #[test]
    fn the_relative_distance_of_a_wider_highlight_is_its_relative_excess() {
        let lobe = lobes::planted(DMat3::from_diagonal(DVec3::new(1e-2, 0.5e-2, 1.0)));
        for excess in [0.1, 0.2, 0.5] {
            let wider = (1.0 + excess) * 1e-2;
            let LobeDistance { sw1, spread } =
                distance(&lobe, &DMat3::from_diagonal(DVec3::new(wider, 0.5 * wider, 1.0)));
            assert!((sw1 / spread - excess).abs() < 0.03, "{excess}: {}", sw1 / spread);
        }
    }

    #[test]
    fn no_distribution_is_farthest_and_the_lobe_keeps_its_width() {
        let target = lobes::planted(lobe(0.1));
        let found = Probe::new().distance(&target, None, &mut Workspace::default());
        assert_eq!(found, LobeDistance { sw1: FARTHEST, ..distance(&target, &lobe(0.1)) });
    }

    /// Equation 10 of KT et al. 2022: sorted projections, compared quantile by quantile. It is exact if all samples of
    /// a distribution have the same weight. Also returns the mean deviation from the median.
    fn by_quantiles(probe: &Probe, lobe: &Lobe, m: &DMat3) -> LobeDistance {
        const QUANTILES: usize = 1 << 12;
        let quantiles = |mut samples: Vec<(f64, f64)>| -> Vec<f64> {
            samples.sort_by(|a, b| a.0.total_cmp(&b.0));
            let (mut below, mut at) = (samples[0].1, 0);
            (0..QUANTILES)
                .map(|k| {
                    while below < (k as f64 + 0.5) / QUANTILES as f64 && at + 1 < samples.len() {
                        at += 1;
                        below += samples[at].1;
                    }
                    samples[at].0
                })
                .collect()
        };
        let (mut sw1, mut spread) = (0.0, 0.0);
        let frame = rotation_from_z(lobe.axis);
        for d in probe.directions.iter().map(|d| frame * *d) {
            let of_lobe = quantiles(lobe.directions.iter().zip(&lobe.weights).map(|(w, x)| (d.dot(*w), *x)).collect());
            let (share, ltc) = (1.0 / probe.points.len() as f64, ltc(m));
            let of_ltc =
                quantiles(probe.points.iter().map(|u| (d.dot(LobeDistribution::sample(&ltc, *u)), share)).collect());
            let median = of_lobe[QUANTILES / 2];
            sw1 += of_lobe.iter().zip(&of_ltc).map(|(a, b)| (a - b).abs()).sum::<f64>();
            spread += of_lobe.iter().map(|x| (x - median).abs()).sum::<f64>();
        }
        let count = (QUANTILES * probe.directions.len()) as f64;
        LobeDistance { sw1: sw1 / count, spread: spread / count }
    }

    /// Tests matrices close to the lobe, a lobe thousands of its widths away, a lobe much too wide, and a mirrored
    /// lobe.
    #[test]
    fn equals_the_distance_by_quantiles_for_good_and_bad_matrices() {
        let probe = Probe { directions: Probe::new().directions.into_iter().step_by(4).collect(), ..Probe::new() };
        let near =
            DMat3::from_cols(DVec3::new(1.1, 0.05, 0.02), DVec3::new(0.05, 0.9, -0.03), DVec3::new(0.1, -0.05, 1.0));
        for scale in [1.0, 0.1, 1e-3, 1e-5] {
            let target = lobes::planted(lobe(scale));
            let far = DMat3::from_cols(scale * DVec3::X, scale * DVec3::Y, DVec3::new(0.3, -0.4, 0.2));
            let flipped = DMat3::from_diagonal(DVec3::new(1.0, -1.0, 1.0));
            for m in [lobe(scale) * near, far, DMat3::IDENTITY, lobe(scale) * near * flipped] {
                let found = probe.distance(&target, Some(&ltc(&m)), &mut Workspace::default());
                let exact = by_quantiles(&probe, &target, &m);
                assert!((found.sw1 / exact.sw1 - 1.0).abs() < 1e-4, "{scale}: {found:?} {exact:?}");
                assert!((found.spread / exact.spread - 1.0).abs() < 1e-4, "{scale}: {found:?} {exact:?}");
            }
        }
    }

    /// The remaining distance is sampling error. The tails of a sharp lobe fall with the square of the distance, so the
    /// few samples in the tails contribute a part of the mean that varies with their number.
    #[test]
    fn the_lobe_s_own_matrix_is_nearest() {
        for (scale, left) in [(1.0, 0.01), (1e-4, 0.08)] {
            let target = lobes::planted(lobe(scale));
            let found = distance(&target, &lobe(scale));
            assert!(found.sw1 < left * found.spread, "{scale}: {found:?}");
        }
    }
}
