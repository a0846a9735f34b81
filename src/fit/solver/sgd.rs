//! The published fitter of KT et al. 2022, Algorithm 3. It is the reference for speed and accuracy.
//!
//! Every step draws new samples of the lobe (Algorithm 1, by rejection), of the LTC (Algorithm 2) and of directions. It
//! sorts the projections, and moves all nine numbers of `M` down the gradient at a constant rate. With a metric other
//! than `sw1`, it estimates the gradient of this metric from the same samples.

use std::f64::consts::{LN_2, PI};

use glam::{DMat3, DVec3};
use rand_core::{Rng, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use super::objective::{Effort, Objective, SolverRules};
use crate::{
    brdf::Brdf,
    lobe::LobeModel,
    math::{Lattice, cosine_hemisphere, ln, sin_cos},
    metric::{Draws, Metric},
    stop_check::StopCheck,
};

/// Length of a step in units of the gradient. The paper gives no value. With 0.1, the error of a broad lobe falls to
/// three times the error of the best fit after a few hundred steps.
const RATE: f64 = 0.1;

/// Seconds of a step for each sample, independent of the number of directions. They cover a sample of the lobe and a
/// sample of the LTC.
const DRAW_SECONDS: f64 = 0.25e-6;
/// Seconds of a step for each sample and direction, mostly for two sorts: `a + b log2 samples`. From 128 to 65,536
/// samples, measured steps take 0.75 to 1.25 times as long as this prediction.
const SORT_SECONDS: [f64; 2] = [12e-9, 4.5e-9];
/// Seconds of a step for each sample with metric `l3`: the densities of lobe and LTC at two samples.
const DENSITY_SECONDS: f64 = 0.1e-6;
/// Seconds for each sample and direction that are not part of a step: for the lobe's projections and the measured
/// error.
const REST_SECONDS: f64 = 20e-9;

/// The published descent as an item of [`super::Solver`].
pub(super) struct Sgd;

impl SolverRules for Sgd {
    fn solve(&self, objective: Objective<'_>, stop_check: &mut StopCheck) -> Option<DMat3> {
        descend(&objective, stop_check)
    }

    fn seconds(&self, _: LobeModel, effort: &Effort) -> f64 {
        let (samples, directions) = (effort.samples as f64, effort.directions as f64);
        let [sample, halving] = SORT_SECONDS;
        let of_sample = match effort.metric {
            Metric::Sw1 => directions * (sample + halving * ln(samples) / LN_2),
            Metric::L3 => DENSITY_SECONDS,
        };
        let step = samples * (DRAW_SECONDS + of_sample);
        f64::from(effort.steps) * step + REST_SECONDS * samples * directions
    }
}

/// Random numbers in [0, 1), from the upper 53 bits of each draw.
struct Uniform(Xoshiro256PlusPlus);

impl Uniform {
    fn next(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn pair(&mut self) -> [f64; 2] {
        [self.next(), self.next()]
    }

    /// A direction with uniform density on the sphere.
    fn direction(&mut self) -> DVec3 {
        let z = 2.0 * self.next() - 1.0;
        let radius = (1.0 - z * z).max(0.0).sqrt();
        let (sin, cos) = sin_cos(2.0 * PI * self.next());
        DVec3::new(radius * cos, radius * sin, z)
    }

    /// Algorithm 1: a direction drawn in proportion to the cosine-weighted lobe. `heaviest` is an upper bound of the
    /// samples' weights.
    fn lobe(&mut self, brdf: &dyn Brdf, wo: DVec3, heaviest: f64, stop_check: &mut StopCheck) -> Option<DVec3> {
        loop {
            stop_check.worked(DRAW)?;
            let u = self.pair();
            let sample = brdf.sample(wo, u);
            if heaviest * self.next() < sample.weight {
                return Some(sample.wi);
            }
        }
    }
}

/// Work of a draw from the lobe, in units of a projection of a sample on a direction.
const DRAW: usize = 16;
/// The number of samples in the search for the largest weight.
const LOOKED_AT: usize = 1024;
/// If all weights were below this value, most samples would be rejected.
const LIGHT: f64 = 0.125;

/// An upper bound of the weights of a lobe's samples. It is one, except for lobes that reflect little, such as smooth
/// sheen. For these it is twice the largest weight in a lattice of samples.
fn heaviest(brdf: &dyn Brdf, wo: DVec3) -> f64 {
    let points = Lattice::new(LOOKED_AT, [0.0; 2]).points();
    let most = 2.0 * points.map(|u| brdf.sample(wo, u).weight).fold(0.0, f64::max);
    if most > 0.0 && most < LIGHT { most } else { 1.0 }
}

/// The matrix after all steps from the identity, in the tangent frame; `None` if `stop_check` stops the descent. Its
/// determinant can have either sign.
fn descend(objective: &Objective<'_>, stop_check: &mut StopCheck) -> Option<DMat3> {
    let Objective { brdf, wo, loss, effort, stream, .. } = objective;
    // The multiplier mixes all bits of the entry's index, which separates the streams of a seed.
    let seed = effort.seed ^ stream.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let mut random = Uniform(Xoshiro256PlusPlus::seed_from_u64(seed));
    let heaviest = heaviest(*brdf, *wo);
    let mut m = DMat3::IDENTITY;
    for _ in 0..effort.steps {
        let draws = Draws {
            lobe: (0..effort.samples).map(|_| random.lobe(*brdf, *wo, heaviest, stop_check)).collect::<Option<_>>()?,
            cosines: (0..effort.samples).map(|_| cosine_hemisphere(random.pair())).collect(),
            directions: (0..effort.directions).map(|_| random.direction()).collect(),
        };
        m -= loss.step(&m, RATE, &draws, stop_check)?;
    }
    Some(m)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        brdf::{Charlie, Ggx},
        math::direction,
        stop_check::work_of,
    };

    /// Smooth sheen seen from above reflects a millionth of the light, and its samples have small weights.
    #[test]
    fn lobes_that_reflect_little_are_drawn_as_quickly() {
        let wo = direction(0.3, 0.0);
        let draws = |brdf: &dyn Brdf| {
            let heaviest = heaviest(brdf, wo);
            let mut random = Uniform(Xoshiro256PlusPlus::seed_from_u64(1));
            work_of(|stop_check| {
                for _ in 0..100 {
                    random.lobe(brdf, wo, heaviest, stop_check).expect("nothing stops it");
                }
            }) / (100 * DRAW)
        };
        let charlie = Charlie::new(0.01);
        assert!(heaviest(&charlie, wo) < 1e-3, "{}", heaviest(&charlie, wo));
        let (sheen, metal) = (draws(&charlie), draws(&Ggx { alpha_x: 0.3, alpha_y: 0.3 }));
        assert!(sheen < 100 && metal < 2, "{sheen} {metal} draws a sample");
    }

    /// Rejected samples count as work, so a search that rejects all samples can be stopped.
    #[test]
    fn a_lobe_that_reflects_nothing_can_be_stopped() {
        #[derive(Debug)]
        struct Black;
        impl Brdf for Black {
            fn eval_cos(&self, _: DVec3, _: DVec3) -> f64 {
                0.0
            }
            fn sample(&self, _: DVec3, _: [f64; 2]) -> crate::brdf::BrdfSample {
                crate::brdf::BrdfSample { wi: DVec3::Z, weight: 0.0, cos_theta_d: 1.0 }
            }
            fn pdf(&self, _: DVec3, _: DVec3) -> f64 {
                1.0
            }
        }
        let mut go_on = || std::ops::ControlFlow::Break(());
        let mut random = Uniform(Xoshiro256PlusPlus::seed_from_u64(1));
        assert!(random.lobe(&Black, DVec3::Z, heaviest(&Black, DVec3::Z), &mut StopCheck::new(&mut go_on)).is_none());
    }
}
