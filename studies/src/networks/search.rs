//! The search for the numbers of a network.

use std::f64::consts::PI;

use ltcforge::light::{
    NormalsRule,
    normals::{INPUTS, OUTPUTS, Region},
};
use rand_core::{Rng as _, SeedableRng as _};
use rand_xoshiro::Xoshiro256PlusPlus;
use rayon::prelude::*;

use super::{
    Numbers, Options,
    numbers::{region_of, rounded},
    outputs, units,
};
use crate::{
    lights::{Case, Kind, Lit, lits, truth_of},
    paths::{TOLERANCE, about_middle, smooth, smooth_paths, to_one_side},
};

/// Cases per step.
const BATCH: usize = 256;
/// The length of the first step of rule `fine`, and of the other rules.
const STEP: [f64; 2] = [0.006, 0.015];
/// The factor on the first step of a search that refines the current numbers.
const REFINED: f64 = 0.2;
/// The decay per step of the running means of the gradient and of its square.
const DECAY: [f64; 2] = [0.9, 0.999];
/// Errors below this are negligible: the objective is quadratic there.
const NEGLIGIBLE: f64 = 2e-4;
/// The weight of the squared error relative to the absolute error. It reduces large errors.
const LARGE: f64 = 10.0;
/// The weight of the relative error, for lights much brighter than `DARK`.
const RELATIVE: f64 = 0.015;
const DARK: f64 = 0.002;
/// The weight of an error in Schlick's part, relative to an error in the energy.
pub(super) const SCHLICK: f64 = 0.7;
/// Steps of a light that grows.
const GROWTH: usize = 10;
/// The number of lights that grow, relative to the number of lights.
const PATHS: f64 = 0.25;
/// The weight of a squared fall of a light that grows, for metal and for plastic.
const FALL: [f64; 2] = [400.0, 2000.0];
/// Steps of a light that moves and turns.
const MOVING: usize = 8;
/// The weight of the squared change of an error from step to step, for metal and for plastic.
const ROUGH: [f64; 2] = [100.0, 500.0];
/// Reflectance at normal incidence of the plastic.
const PLASTIC: f64 = 0.04;
/// The light of metal and of plastic, from its two parts.
const SURFACES: [[f64; 2]; 2] = [[1.0, 0.0], [PLASTIC, 1.0 - PLASTIC]];
/// The outputs that are shares of blends.
const SHARES: [usize; 2] = [0, 3];
/// The slope of a share beyond its ends, in the first half of the search.
const LEAK: f64 = 0.1;
/// The step of differences by an output.
const TINY: f64 = 1e-5;

/// The weight of cases of a kind.
pub(super) fn weight(kind: Kind) -> f64 {
    if matches!(kind, Kind::Random | Kind::Anisotropic | Kind::Strip) { 3.0 } else { 1.0 }
}

/// A training example. The inputs of the regions are normalised.
pub(super) enum Lesson {
    /// The true light of a region, and the weight of the case.
    Light(Region<f64>, [f64; 2], f64),
    /// A light that grows, in some steps. Its reflected light must not decrease.
    Growth(Vec<Region<f64>>),
    /// A light that moves and turns while the view tilts, in some steps, and its true light. The error must not change
    /// quickly.
    Moving(Vec<Region<f64>>, Vec<[f64; 2]>),
}

impl Lesson {
    fn light(rule: NormalsRule, kind: Kind, case: &Case) -> Option<Self> {
        Some(Self::Light(region_of(rule, &case.lit)?, case.truth, weight(kind)))
    }

    fn growth(rule: NormalsRule, path: fn(&Lit, f64) -> Lit, lit: &Lit, from: f64) -> Self {
        let at = |i: usize| path(lit, from + (1.0 - from) * i as f64 / (GROWTH - 1) as f64);
        Self::Growth((0..GROWTH).filter_map(|i| region_of(rule, &at(i))).collect())
    }

    fn moving(rule: NormalsRule, lit: &Lit) -> Self {
        let along = (0..MOVING).map(|i| smooth(lit, i as f64 / (MOVING - 1) as f64));
        let (regions, truths) =
            along.filter_map(|lit| Some((region_of(rule, &lit)?, truth_of(&lit, TOLERANCE)))).unzip();
        Self::Moving(regions, truths)
    }

    fn regions(&mut self) -> &mut [Region<f64>] {
        match self {
            Self::Light(region, ..) => std::slice::from_mut(region),
            Self::Growth(regions) | Self::Moving(regions, _) => regions,
        }
    }
}

/// The lessons of a search, and the mean and the spread by which their inputs are normalised.
pub(super) fn lessons(options: &Options, cases: &[(usize, Case)]) -> (Vec<Lesson>, [Vec<f64>; 2]) {
    let rule = options.rule;
    let lights: Vec<Lesson> =
        cases.par_iter().filter_map(|(kind, case)| Lesson::light(rule, Kind::ALL[*kind], case)).collect();
    let mut lessons = lights;
    let count = (options.lights as f64 * PATHS) as usize / 4;
    for (i, kind) in [Kind::Random, Kind::Anisotropic].into_iter().enumerate() {
        let lits = lits(kind, 100 * options.seed + 50 + i as u64, count);
        for path in [about_middle, to_one_side] {
            let of = |(i, lit): (usize, &Lit)| Lesson::growth(rule, path, lit, (i % 16) as f64 / 24.0);
            lessons.extend(lits.par_iter().enumerate().map(of).collect::<Vec<_>>());
        }
    }
    let moving = smooth_paths(100 * options.seed + 52, count / 2);
    lessons.extend(moving.par_iter().map(|lit| Lesson::moving(rule, lit)).collect::<Vec<_>>());
    let regions = || cases.iter().filter_map(|(_, case)| region_of(rule, &case.lit));
    let all: Vec<[f64; INPUTS]> = regions().map(|region| region.inputs).collect();
    let mean = |of: &dyn Fn(&[f64; INPUTS]) -> f64| all.iter().map(of).sum::<f64>() / all.len() as f64;
    let means: Vec<f64> = (0..INPUTS).map(|i| mean(&|inputs| inputs[i])).collect();
    let spreads: Vec<f64> =
        (0..INPUTS).map(|i| mean(&|inputs| (inputs[i] - means[i]).powi(2)).sqrt().max(1e-6)).collect();
    for region in lessons.iter_mut().flat_map(Lesson::regions) {
        for (input, (mean, spread)) in region.inputs.iter_mut().zip(means.iter().zip(&spreads)) {
            *input = (*input - mean) / spread;
        }
    }
    (lessons, [means, spreads])
}

/// A network during the search. `weights` has all rows one after another.
pub(super) struct Search {
    inputs: usize,
    units: usize,
    outputs: usize,
    weights: Vec<f64>,
}

/// The running sums of Adam.
struct Adam {
    slope: Vec<f64>,
    square: Vec<f64>,
    /// The current powers of [`DECAY`]. They correct the bias of the sums.
    decayed: [f64; 2],
}

/// A network's values for a region.
#[derive(Clone)]
struct Evaluation {
    units: Vec<f64>,
    /// The slopes of the units.
    slopes: Vec<f64>,
    outputs: [f64; OUTPUTS],
    /// The reflected light: for a Fresnel factor of one, and weighted by Schlick's factor.
    light: [f64; 2],
}

fn light(region: &Region<f64>, outputs: [f64; OUTPUTS]) -> [f64; 2] {
    region.mean(outputs).map(|mean| region.visible * mean)
}

/// The penalty `weight / 2 * change^2` for a change of light between two steps of a path. Adds its slope to `by_light`.
fn penalty(weight: f64, change: f64, of: [f64; 2], [more, less]: [usize; 2], by_light: &mut [[f64; 2]]) -> f64 {
    for part in 0..2 {
        by_light[more][part] += weight * change * of[part];
        by_light[less][part] -= weight * change * of[part];
    }
    0.5 * weight * change * change
}

impl Search {
    fn new(rule: NormalsRule, random: &mut Xoshiro256PlusPlus) -> Self {
        let (inputs, units, outputs) = (rule.inputs(), units(rule), outputs(rule));
        let mut uniform = || (random.next_u64() >> 11) as f64 / (1_u64 << 53) as f64;
        let mut normal = || (-2.0 * (1.0 - uniform()).ln()).sqrt() * (2.0 * PI * uniform()).cos();
        let mut weights = Vec::new();
        for _ in 0..units {
            weights.extend((0..inputs).map(|_| 0.5 * normal() / (inputs as f64).sqrt()));
            weights.push(0.7 * normal());
        }
        for output in 0..outputs {
            weights.extend((0..units).map(|_| 0.1 * normal()));
            // Both blends start with equal shares.
            weights.push(if SHARES.contains(&output) { 0.5 } else { 0.0 });
        }
        Self { inputs, units, outputs, weights }
    }

    /// The current numbers of a rule, for inputs with this mean and spread.
    fn current(rule: NormalsRule, [mean, spread]: &[Vec<f64>; 2]) -> Self {
        let (network, inputs) = (rule.network(), rule.inputs());
        let mut weights = Vec::new();
        for row in network.units {
            weights.extend((0..inputs).map(|i| row[i] * spread[i]));
            weights.push(row[inputs] + (0..inputs).map(|i| row[i] * mean[i]).sum::<f64>());
        }
        weights.extend(network.outputs.iter().copied().flatten());
        Self { inputs, units: units(rule), outputs: outputs(rule), weights }
    }

    /// The index of the first weight of an output's row.
    fn output(&self, output: usize) -> usize {
        self.units * (self.inputs + 1) + output * (self.units + 1)
    }

    fn evaluate(&self, region: &Region<f64>) -> Evaluation {
        let unit = |row: &[f64]| {
            let h = row.iter().zip(&region.inputs[..self.inputs]).fold(row[self.inputs], |sum, (w, x)| sum + w * x);
            let root = (h * h + 1.0).sqrt();
            (h + root, (h + root) / root)
        };
        let (units, slopes): (Vec<f64>, Vec<f64>) =
            self.weights.chunks_exact(self.inputs + 1).take(self.units).map(unit).unzip();
        let mut outputs = [0.0; OUTPUTS];
        for (k, output) in outputs[..self.outputs].iter_mut().enumerate() {
            let row = &self.weights[self.output(k)..][..=self.units];
            *output = row.iter().zip(&units).fold(row[self.units], |sum, (w, x)| sum + w * x);
        }
        Evaluation { units, slopes, outputs, light: light(region, outputs) }
    }

    /// Adds the gradient of an error, from its slope by both parts of the light. `leak` is the slope of a blend's share
    /// beyond its ends, so that it can return.
    fn learn(&self, region: &Region<f64>, values: &Evaluation, by_light: [f64; 2], leak: f64, slope: &mut [f64]) {
        let mut by_output = [0.0; OUTPUTS];
        for (k, by_output) in by_output[..self.outputs].iter_mut().enumerate() {
            let at = |x: f64| {
                let mut outputs = values.outputs;
                outputs[k] = x;
                light(region, outputs)
            };
            let x = values.outputs[k];
            let is_beyond = SHARES.contains(&k) && !(0.0..=1.0).contains(&x);
            let ([low, high], scale) =
                if is_beyond { ([0.0, 1.0].map(at), leak) } else { ([x - TINY, x + TINY].map(at), 0.5 / TINY) };
            *by_output = scale * (by_light[0] * (high[0] - low[0]) + by_light[1] * (high[1] - low[1]));
            let row = &mut slope[self.output(k)..][..=self.units];
            row.iter_mut().zip(&values.units).for_each(|(slope, unit)| *slope += *by_output * unit);
            row[self.units] += *by_output;
        }
        for unit in 0..self.units {
            let sum: f64 = (0..self.outputs).map(|k| by_output[k] * self.weights[self.output(k) + unit]).sum();
            let by_unit = sum * values.slopes[unit];
            let row = &mut slope[unit * (self.inputs + 1)..][..=self.inputs];
            row.iter_mut().zip(&region.inputs[..self.inputs]).for_each(|(slope, x)| *slope += by_unit * x);
            row[self.inputs] += by_unit;
        }
    }

    /// Adds the gradient of a lesson's error, and returns the error.
    fn study(&self, lesson: &Lesson, leak: f64, slope: &mut [f64]) -> f64 {
        let mut sum = 0.0;
        match lesson {
            Lesson::Light(region, truth, weight) => {
                let values = self.evaluate(region);
                let mut by_light = [0.0; 2];
                for (i, by_light) in by_light.iter_mut().enumerate() {
                    let error = values.light[i] - truth[i];
                    let relative = 1.0 + RELATIVE / (truth[i] + DARK);
                    let part = if i == 0 { *weight } else { SCHLICK * weight };
                    let root = error.hypot(NEGLIGIBLE);
                    sum += part * (relative * root + LARGE * error * error);
                    *by_light = part * (relative * error / root + 2.0 * LARGE * error);
                }
                self.learn(region, &values, by_light, leak, slope);
            }
            Lesson::Growth(regions) => {
                let values: Vec<Evaluation> = regions.iter().map(|region| self.evaluate(region)).collect();
                let mut by_light = vec![[0.0; 2]; values.len()];
                for (of, fall_weight) in SURFACES.into_iter().zip(FALL) {
                    let value = |i: usize| of[0] * values[i].light[0] + of[1] * values[i].light[1];
                    let mut most = 0;
                    for i in 0..values.len() {
                        let fall = value(most) - value(i);
                        if fall <= 0.0 {
                            most = i;
                        } else {
                            sum += penalty(fall_weight, fall, of, [most, i], &mut by_light);
                        }
                    }
                }
                self.learn_path(regions, &values, &by_light, leak, slope);
            }
            Lesson::Moving(regions, truths) => {
                let values: Vec<Evaluation> = regions.iter().map(|region| self.evaluate(region)).collect();
                let mut by_light = vec![[0.0; 2]; values.len()];
                for (of, rough) in SURFACES.into_iter().zip(ROUGH) {
                    let error = |i: usize| -> f64 {
                        (0..2).map(|part| of[part] * (values[i].light[part] - truths[i][part])).sum()
                    };
                    for i in 1..values.len() {
                        sum += penalty(rough, error(i) - error(i - 1), of, [i, i - 1], &mut by_light);
                    }
                }
                self.learn_path(regions, &values, &by_light, leak, slope);
            }
        }
        sum
    }

    fn learn_path(
        &self,
        regions: &[Region<f64>],
        values: &[Evaluation],
        by_light: &[[f64; 2]],
        leak: f64,
        slope: &mut [f64],
    ) {
        for ((region, values), by_light) in regions.iter().zip(values).zip(by_light) {
            if *by_light != [0.0; 2] {
                self.learn(region, values, *by_light, leak, slope);
            }
        }
    }

    fn step(&mut self, adam: &mut Adam, slope: &[f64], length: f64) {
        for (decayed, decay) in adam.decayed.iter_mut().zip(DECAY) {
            *decayed *= decay;
        }
        let [by, by2] = adam.decayed.map(|decayed| 1.0 / (1.0 - decayed));
        for (i, slope) in slope.iter().enumerate() {
            adam.slope[i] += (1.0 - DECAY[0]) * (slope - adam.slope[i]);
            adam.square[i] += (1.0 - DECAY[1]) * (slope * slope - adam.square[i]);
            self.weights[i] -= length * (adam.slope[i] * by) / ((adam.square[i] * by2).sqrt() + 1e-9);
        }
    }

    /// The numbers for inputs that are not normalised. In the search, inputs had `mean` subtracted and were divided by
    /// `spread`.
    pub(super) fn numbers(&self, [mean, spread]: &[Vec<f64>; 2]) -> Numbers {
        let unit = |row: &[f64]| {
            let weights: Vec<f64> = (0..self.inputs).map(|i| rounded(row[i] / spread[i])).collect();
            let moved = weights.iter().zip(mean).map(|(w, mean)| w * mean).sum::<f64>();
            [weights, vec![rounded(row[self.inputs] - moved)]].concat()
        };
        let units = self.weights.chunks_exact(self.inputs + 1).take(self.units).map(unit).collect();
        let output = |k: usize| self.weights[self.output(k)..][..=self.units].iter().map(|x| rounded(*x)).collect();
        Numbers { units, outputs: (0..self.outputs).map(output).collect() }
    }
}

/// Searches from a start. Returns the network and its mean error over the lessons.
pub(super) fn trained(options: &Options, start: u64, lessons: &[Lesson], normal: &[Vec<f64>; 2]) -> (f64, Search) {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(1000 * options.seed + start);
    let mut search =
        if options.refine { Search::current(options.rule, normal) } else { Search::new(options.rule, &mut random) };
    let count = search.weights.len();
    let mut adam = Adam { slope: vec![0.0; count], square: vec![0.0; count], decayed: [1.0; 2] };
    let mut order: Vec<usize> = (0..lessons.len()).collect();
    let steps = options.rounds * lessons.len().div_ceil(BATCH);
    let first = STEP[usize::from(options.rule != NormalsRule::Fine)] * if options.refine { REFINED } else { 1.0 };
    let mut step = 0_usize;
    for round in 0..options.rounds {
        for i in (1..order.len()).rev() {
            order.swap(i, (random.next_u64() % (i as u64 + 1)) as usize);
        }
        let leak = if !options.refine && 2 * round < options.rounds { LEAK } else { 0.0 };
        for batch in order.chunks(BATCH) {
            let mut slope = vec![0.0; count];
            for i in batch {
                search.study(&lessons[*i], leak, &mut slope);
            }
            for slope in &mut slope {
                *slope /= batch.len() as f64;
            }
            let length = first * (0.5 + 0.5 * (PI * step as f64 / steps as f64).cos()).powf(1.5) + 1e-5;
            search.step(&mut adam, &slope, length);
            step += 1;
        }
    }
    let error: f64 = lessons.iter().map(|lesson| search.study(lesson, 0.0, &mut vec![0.0; count])).sum();
    (error / lessons.len() as f64, search)
}
