//! The fitter of KT et al. 2022, Algorithm 3, as the paper states it: the yardstick for speed and accuracy.
//!
//! Every step draws fresh samples of the lobe (Algorithm 1, by rejection) and of the LTC (Algorithm 2) and fresh
//! directions, sorts the projections, and moves all nine numbers of `M` down the gradient by a constant rate.

use std::f64::consts::{LN_2, PI};

use glam::{DMat3, DVec3};
use rand_core::{Rng, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use super::objective::{Effort, Objective, SolverRules};
use crate::fit::{
    brdf::Brdf,
    lobe::LobeModel,
    math::{cosine_hemisphere, ln, sin_cos},
    metric::Metric,
    pulse::Pulse,
};

/// Length of a step in units of the gradient. The paper gives none; at 0.1 a broad lobe is within three times its best
/// fit's error after some hundred steps.
const RATE: f64 = 0.1;

/// Seconds of a step for each sample, whatever the number of directions: a sample of the lobe and one of the LTC.
const DRAW_SECONDS: f64 = 0.25e-6;
/// Seconds of a step for each sample and direction, most of them of two sorts: `a + b log2 samples`. From 128 to
/// 65,536 samples, measured steps take 0.75 to 1.25 times as long.
const SORT_SECONDS: [f64; 2] = [12e-9, 4.5e-9];
/// Seconds for each sample and direction outside of the steps: the lobe's projections and the measured error.
const REST_SECONDS: f64 = 20e-9;

/// The published descent as an item of [`super::Solver`].
pub(super) struct Rules;

impl SolverRules for Rules {
    fn solve(&self, objective: Objective<'_>, pulse: &mut Pulse) -> Option<DMat3> {
        descend(objective.brdf, objective.wo, &objective.effort, objective.stream, pulse)
    }

    fn seconds(&self, _: LobeModel, effort: &Effort) -> f64 {
        let (samples, directions) = (effort.samples as f64, effort.directions as f64);
        let [sample, halving] = SORT_SECONDS;
        let step = samples * (DRAW_SECONDS + directions * (sample + halving * ln(samples) / LN_2));
        f64::from(effort.steps) * step + REST_SECONDS * samples * directions
    }

    /// Its steps are those down the sliced Wasserstein distance.
    fn takes(&self, metric: Metric) -> bool {
        metric == Metric::Sw1
    }
}

/// Random numbers in [0, 1): the upper 53 bits of each draw.
struct Uniform(Xoshiro256PlusPlus);

impl Uniform {
    fn next(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn pair(&mut self) -> [f64; 2] {
        [self.next(), self.next()]
    }

    /// Uniform on the sphere.
    fn direction(&mut self) -> DVec3 {
        let z = 2.0 * self.next() - 1.0;
        let radius = (1.0 - z * z).max(0.0).sqrt();
        let (sin, cos) = sin_cos(2.0 * PI * self.next());
        DVec3::new(radius * cos, radius * sin, z)
    }

    /// Algorithm 1: a direction drawn from the density proportional to the cosine-weighted lobe.
    fn lobe(&mut self, brdf: &dyn Brdf, wo: DVec3) -> DVec3 {
        loop {
            let u = self.pair();
            let sample = brdf.sample(wo, u);
            if self.next() < sample.weight {
                return sample.wi;
            }
        }
    }
}

/// Work of a step for each sample and direction, in projections: two sorts.
const SORTING: usize = 16;

/// The matrix after all steps, from the identity, in the tangent frame; `None` when `pulse` stops the descent. Its
/// determinant may have either sign.
fn descend(brdf: &dyn Brdf, wo: DVec3, effort: &Effort, stream: u64, pulse: &mut Pulse) -> Option<DMat3> {
    // A multiplier that mixes every bit of the entry's number separates the streams of one seed.
    let seed = effort.seed ^ stream.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let mut random = Uniform(Xoshiro256PlusPlus::seed_from_u64(seed));
    let n = effort.samples;
    let mut m = DMat3::IDENTITY;
    let (mut lobe, mut cosine, mut ltc) = (vec![DVec3::ZERO; n], vec![DVec3::ZERO; n], vec![DVec3::ZERO; n]);
    let (mut gradient, mut wanted, mut order) = (vec![DVec3::ZERO; n], vec![0.0; n], vec![(0.0, 0_usize); n]);
    for _ in 0..effort.steps {
        for wi in &mut lobe {
            *wi = random.lobe(brdf, wo);
        }
        for c in &mut cosine {
            *c = cosine_hemisphere(random.pair());
        }
        for (f, c) in ltc.iter_mut().zip(&cosine) {
            *f = (m * *c).normalize();
        }
        gradient.fill(DVec3::ZERO);
        for _ in 0..effort.directions {
            pulse.worked(SORTING * n)?;
            let d = random.direction();
            wanted.iter_mut().zip(&lobe).for_each(|(x, wi)| *x = d.dot(*wi));
            wanted.sort_unstable_by(f64::total_cmp);
            order.iter_mut().zip(&ltc).enumerate().for_each(|(i, (slot, f))| *slot = (d.dot(*f), i));
            order.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
            for ((x, i), wanted) in order.iter().zip(&wanted) {
                gradient[*i] += if x > wanted { d } else { -d };
            }
        }
        // Back through f = M c / |M c|.
        let mut by_m = DMat3::ZERO;
        for ((f, g), c) in ltc.iter().zip(&gradient).zip(&cosine) {
            let by_w = (*g - *f * f.dot(*g)) * (1.0 / (m * *c).length());
            by_m += DMat3::from_cols(by_w * c.x, by_w * c.y, by_w * c.z);
        }
        m -= by_m * (RATE / (n * effort.directions) as f64);
    }
    Some(m)
}
