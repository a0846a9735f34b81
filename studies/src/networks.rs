//! Finds the networks of model `normals`. They estimate the mean weight of shadowing: see docs/normals.md.
//!
//! The optimiser is Adam [Kingma, Ba 2015]: each step follows the gradient over a few cases, in units of its running
//! size. The step length decreases along half a cosine. The result is the best of several starts. All random numbers
//! come from the seed, and sums have a fixed order.

use std::{f32::consts::PI, fmt::Write as _};

use ltcforge::{
    fit::Sides,
    light::{
        NormalsRule,
        normals::{INPUTS, LEAST_OF_OVERLAPPING, Network, OUTPUTS, Region, regions},
    },
};
use rand_core::{Rng as _, SeedableRng as _};
use rand_xoshiro::Xoshiro256PlusPlus;
use rayon::prelude::*;

use crate::lights::{Case, Kind, Lit, Spread, cases};

/// Significant digits of a number in the source.
const DIGITS: i32 = 4;
/// Cases per step.
const BATCH: usize = 256;
/// The length of the first step.
const STEP: f32 = 0.015;
/// The decay per step of the running means of the gradient and of its square.
const DECAY: [f32; 2] = [0.9, 0.999];
/// Errors below this are negligible: the objective is quadratic there.
const NEGLIGIBLE: f32 = 2e-4;
/// The weight of the squared error relative to the absolute error. It reduces large errors.
const LARGE: f32 = 10.0;
/// The weight of an error in Schlick's part, relative to an error in the energy.
const SCHLICK: f32 = 0.7;

/// The options of [`find`].
#[derive(Debug, Clone, Copy)]
pub struct Options {
    /// The rule.
    pub rule: NormalsRule,
    /// Lights in the search. The same number is held out.
    pub lights: usize,
    /// Rounds over all lights.
    pub rounds: usize,
    /// The number of networks to try.
    pub starts: u64,
    /// Seed for the lights and the starts.
    pub seed: u64,
}

/// The number of units of a rule's network.
#[must_use]
pub fn units(rule: NormalsRule) -> usize {
    match rule {
        NormalsRule::Fast => 3,
        NormalsRule::Balanced => 12,
        NormalsRule::Fine | NormalsRule::Exact => 8,
    }
}

/// The number of outputs of a rule's network. The last output is for the tip of a triangle, and only some rules have
/// triangles.
#[must_use]
pub fn outputs(rule: NormalsRule) -> usize {
    if matches!(rule, NormalsRule::Fine | NormalsRule::Exact) { OUTPUTS } else { OUTPUTS - 1 }
}

/// Draws `count` cases, the same number for each kind.
#[must_use]
pub fn draw(seed: u64, count: usize) -> Vec<(usize, Case)> {
    let kinds = Kind::ALL.into_iter().enumerate();
    let of = |(i, kind): (usize, Kind)| {
        cases(kind, 100 * seed + i as u64, count / Kind::ALL.len()).into_iter().map(move |case| (i, case))
    };
    kinds.flat_map(of).collect()
}

/// The numbers of a network.
#[derive(Debug, Clone, PartialEq)]
pub struct Numbers {
    /// Rows of the units, as in [`Network`].
    pub units: Vec<Vec<f64>>,
    /// Rows of the outputs.
    pub outputs: Vec<Vec<f64>>,
}

impl From<Network<'_>> for Numbers {
    fn from(network: Network<'_>) -> Self {
        let rows = |rows: &[&[f64]]| rows.iter().map(|row| row.to_vec()).collect();
        Self { units: rows(network.units), outputs: rows(network.outputs) }
    }
}

impl Numbers {
    /// The light by a rule, with these numbers.
    #[must_use]
    pub fn reflected(&self, rule: NormalsRule, lit: &Lit) -> [f64; 2] {
        let (units, outputs) = (slices(&self.units), slices(&self.outputs));
        let network = Network { units: &units, outputs: &outputs };
        let found = regions(lit.alpha(), lit.wo(), &lit.vertices, Sides::Two, rule);
        found.map_or([0.0; 2], |found| found.reflected(|region| network.at(&region.inputs[..rule.inputs()])))
    }

    /// The numbers as written in `src/light/normals/numbers.rs`.
    #[must_use]
    pub fn as_rust(&self, rule: NormalsRule) -> String {
        let rows = |rows: &[Vec<f64>]| {
            let row = |row: &Vec<f64>| format!("        &[{}],\n", listed(row));
            rows.iter().map(row).collect::<String>()
        };
        format!(
            "pub(super) const {}: Network<'static> = Network {{\n    units: &[\n{}    ],\n    outputs: &[\n{}    ],\n}};\n",
            rule.name().to_uppercase(),
            rows(&self.units),
            rows(&self.outputs),
        )
    }

    /// The numbers as written in the shader of the rule: matrices in column order, each with four inputs and at most
    /// four units.
    #[must_use]
    pub fn as_wgsl(&self, rule: NormalsRule) -> String {
        let mut out = String::new();
        let (group, inputs) = (self.units.len().min(4), rule.inputs());
        let outputs = self.outputs.len();
        for (i, units) in self.units.chunks(group).enumerate() {
            let columns = |from: usize, to: usize| matrix(units, from, to);
            let names: &[&str] = if inputs == INPUTS { &["first", "second", "third"] } else { &["first", "second"] };
            let terms: Vec<String> =
                names.iter().enumerate().map(|(k, name)| format!("{} * {name}", columns(4 * k, 4 * k + 4))).collect();
            let bias = listed(&units.iter().map(|row| row[inputs]).collect::<Vec<_>>());
            let _ = writeln!(
                out,
                "    let units_{i} = max(\n        {}\n        + vec{group}({bias}),\n        vec{group}(0.0),\n    );",
                terms.join("\n        + "),
            );
        }
        let terms: Vec<String> = (0..self.units.len() / group)
            .map(|i| format!("{} * units_{i}", matrix(&self.outputs, i * group, (i + 1) * group)))
            .collect();
        let bias = listed(&self.outputs.iter().map(|row| row[self.units.len()]).collect::<Vec<_>>());
        let _ = writeln!(out, "    let outputs = {}\n        + vec{outputs}({bias});", terms.join("\n        + "));
        out
    }
}

fn slices(rows: &[Vec<f64>]) -> Vec<&[f64]> {
    rows.iter().map(Vec::as_slice).collect()
}

/// Some columns of the rows, as a WGSL matrix.
fn matrix(rows: &[Vec<f64>], from: usize, to: usize) -> String {
    let column = |k: usize| listed(&rows.iter().map(|row| row[k]).collect::<Vec<_>>());
    let columns: Vec<String> = (from..to).map(column).collect();
    format!("mat{}x{}({})", to - from, rows.len(), columns.join(", "))
}

fn listed(numbers: &[f64]) -> String {
    numbers.iter().map(|x| format!("{x:?}")).collect::<Vec<_>>().join(", ")
}

/// A number rounded to the digits of the source.
fn rounded(x: f64) -> f64 {
    if x == 0.0 {
        return 0.0;
    }
    let one = 10_f64.powi(DIGITS - 1 - x.abs().log10().floor() as i32);
    // The quotient of two whole numbers is the nearest f64, so it prints with these digits. A number without decimals
    // is a product instead.
    if one >= 1.0 { (x * one).round() / one } else { (x * one).round() * one.recip().round() }
}

/// The features of a region of a case, in f32.
struct Features {
    part: f32,
    at_mean: f32,
    schlick: f32,
    /// The values at the corners and at the tip, minus the value at the mean. They are the factors of the last two
    /// outputs.
    offsets: [f32; 2],
    inputs: [f32; INPUTS],
}

/// The weight of cases of a kind.
fn weight(kind: Kind) -> f64 {
    if matches!(kind, Kind::Random | Kind::Anisotropic | Kind::Strip) { 3.0 } else { 1.0 }
}

/// A training case, in f32.
struct Lesson {
    truth: [f32; 2],
    /// The weight of the case.
    weight: f32,
    visible: f32,
    regions: Vec<Features>,
}

impl Lesson {
    fn of(rule: NormalsRule, kind: Kind, Case { lit, truth }: &Case) -> Self {
        let found = regions(lit.alpha(), lit.wo(), &lit.vertices, Sides::Two, rule);
        let (visible, regions) = found.map_or((0.0, Vec::new()), |found| (found.visible, found.regions));
        let features = |region: &Region<f64>| Features {
            part: region.part as f32,
            at_mean: region.at_mean as f32,
            schlick: region.schlick as f32,
            offsets: [region.at_corners - region.at_mean, region.at_tip - region.at_mean].map(|x| x as f32),
            inputs: region.inputs.map(|x| x as f32),
        };
        Self {
            truth: truth.map(|x| x as f32),
            weight: weight(kind) as f32,
            visible: visible as f32,
            regions: regions.iter().map(features).collect(),
        }
    }
}

/// A network during the search. `weights` has all rows one after another.
struct Search {
    inputs: usize,
    units: usize,
    outputs: usize,
    weights: Vec<f32>,
}

/// The means that a network computes for a region, and whether the clamp leaves each unchanged.
#[derive(Clone, Copy, Default)]
struct Estimate {
    mean: [f32; 2],
    is_free: [bool; 2],
}

/// The running sums of Adam.
struct Adam {
    slope: Vec<f32>,
    square: Vec<f32>,
    /// The current powers of [`DECAY`]. They correct the bias of the sums.
    decayed: [f32; 2],
}

impl Search {
    fn new(rule: NormalsRule, random: &mut Xoshiro256PlusPlus) -> Self {
        let (inputs, units, outputs) = (rule.inputs(), units(rule), outputs(rule));
        let mut uniform = || (random.next_u64() >> 40) as f32 / (1_u64 << 24) as f32;
        let mut normal = || (-2.0 * (1.0 - uniform()).ln()).sqrt() * (2.0 * PI * uniform()).cos();
        let mut weights = Vec::new();
        for _ in 0..units {
            weights.extend((0..inputs).map(|_| normal() / (inputs as f32).sqrt()));
            weights.push(0.7 * normal());
        }
        for output in 0..outputs {
            weights.extend((0..units).map(|_| 0.05 * normal()));
            // The weight for corners starts at about a third.
            weights.push(if output == 2 { 0.3 } else { 0.0 });
        }
        Self { inputs, units, outputs, weights }
    }

    /// The index of the first weight of an output's row.
    fn output(&self, output: usize) -> usize {
        self.units * (self.inputs + 1) + output * (self.units + 1)
    }

    fn estimate(&self, features: &Features, units: &mut [f32]) -> Estimate {
        for (row, unit) in self.weights.chunks_exact(self.inputs + 1).zip(units.iter_mut()) {
            let sum = row.iter().zip(&features.inputs[..self.inputs]).fold(row[self.inputs], |s, (w, x)| s + w * x);
            *unit = sum.max(0.0);
        }
        let mut out = [0.0; OUTPUTS];
        for (output, out) in out[..self.outputs].iter_mut().enumerate() {
            let row = &self.weights[self.output(output)..][..=self.units];
            *out = row.iter().zip(&*units).fold(row[self.units], |sum, (w, x)| sum + w * x);
        }
        let Features { part, at_mean, offsets, .. } = *features;
        let size = part.abs();
        let free = at_mean + out[2] * offsets[0] + out[3] * offsets[1] + size * out[0];
        let mean = free.clamp(0.0, 1.0);
        let schlick = mean * features.schlick + size * out[1];
        Estimate { mean: [mean, schlick.clamp(0.0, mean)], is_free: [free == mean, (0.0..=mean).contains(&schlick)] }
    }

    /// Adds the gradient of a lesson's error.
    fn learn(&self, lesson: &Lesson, units: &mut [Vec<f32>], slope: &mut [f32]) {
        let (mut sum, mut all, mut parts) = ([0.0; 2], [0.0; 2], 1e-30_f32);
        let mut estimates = [Estimate::default(); 16];
        for ((features, estimate), units) in lesson.regions.iter().zip(&mut estimates).zip(units.iter_mut()) {
            *estimate = self.estimate(features, units);
            for i in 0..2 {
                sum[i] += features.part * estimate.mean[i];
                all[i] += features.part.abs() * estimate.mean[i];
            }
            parts += features.part.abs();
        }
        let least = LEAST_OF_OVERLAPPING as f32 * lesson.visible / parts;
        let is_least = [0, 1].map(|i| least * all[i] > sum[i]);
        let errors = [0, 1].map(|i| sum[i].max(least * all[i]) - lesson.truth[i]);
        let by_error = |i: usize| {
            let (error, weight) = (errors[i], if i == 0 { lesson.weight } else { SCHLICK * lesson.weight });
            weight * (error / error.hypot(NEGLIGIBLE) + 2.0 * LARGE * error)
        };
        let by_error = [by_error(0), by_error(1)];
        for ((features, estimate), units) in lesson.regions.iter().zip(&estimates).zip(units.iter()) {
            let Features { part, schlick, offsets, .. } = *features;
            let size = part.abs();
            let by_mean = |i: usize| by_error[i] * if is_least[i] { least * size } else { part };
            let by_schlick = if estimate.is_free[1] { by_mean(1) } else { 0.0 };
            let by_energy = if estimate.is_free[0] { by_mean(0) + by_schlick * schlick } else { 0.0 };
            let by_output = [by_energy * size, by_schlick * size, by_energy * offsets[0], by_energy * offsets[1]];
            for (output, by_output) in by_output[..self.outputs].iter().enumerate() {
                let row = &mut slope[self.output(output)..][..=self.units];
                row.iter_mut().zip(units).for_each(|(slope, unit)| *slope += by_output * unit);
                row[self.units] += by_output;
            }
            for (unit, _) in units.iter().enumerate().filter(|(_, value)| **value > 0.0) {
                let by_unit =
                    (0..self.outputs).map(|k| by_output[k] * self.weights[self.output(k) + unit]).sum::<f32>();
                let row = &mut slope[unit * (self.inputs + 1)..][..=self.inputs];
                row.iter_mut().zip(&features.inputs[..self.inputs]).for_each(|(slope, x)| *slope += by_unit * x);
                row[self.inputs] += by_unit;
            }
        }
    }

    fn step(&mut self, adam: &mut Adam, slope: &[f32], length: f32) {
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
    fn numbers(&self, mean: &[f32], spread: &[f32]) -> Numbers {
        let unit = |row: &[f32]| {
            let weights: Vec<f64> =
                (0..self.inputs).map(|i| rounded(f64::from(row[i]) / f64::from(spread[i]))).collect();
            let moved = weights.iter().zip(mean).map(|(w, mean)| w * f64::from(*mean)).sum::<f64>();
            [weights, vec![rounded(f64::from(row[self.inputs]) - moved)]].concat()
        };
        let units = self.weights.chunks_exact(self.inputs + 1).take(self.units).map(unit).collect();
        let output =
            |k: usize| self.weights[self.output(k)..][..=self.units].iter().map(|x| rounded(f64::from(*x))).collect();
        Numbers { units, outputs: (0..self.outputs).map(output).collect() }
    }
}

/// Mean and spread of each input.
fn spreads(lessons: &[Lesson]) -> [Vec<f32>; 2] {
    let count = lessons.iter().map(|lesson| lesson.regions.len()).sum::<usize>() as f64;
    let mean = |f: &dyn Fn(&Features) -> f64| lessons.iter().flat_map(|l| &l.regions).map(f).sum::<f64>() / count;
    let means: Vec<f64> = (0..INPUTS).map(|i| mean(&|region| f64::from(region.inputs[i]))).collect();
    let spread = |i: usize| mean(&|region| (f64::from(region.inputs[i]) - means[i]).powi(2)).sqrt().max(1e-6) as f32;
    [means.iter().map(|x| *x as f32).collect(), (0..INPUTS).map(spread).collect()]
}

fn trained(options: &Options, start: u64, lessons: &[Lesson]) -> Search {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(1000 * options.seed + start);
    let mut search = Search::new(options.rule, &mut random);
    let count = search.weights.len();
    let mut adam = Adam { slope: vec![0.0; count], square: vec![0.0; count], decayed: [1.0; 2] };
    let mut units = vec![vec![0.0; search.units]; 16];
    let mut order: Vec<usize> = (0..lessons.len()).collect();
    let steps = options.rounds * lessons.len().div_ceil(BATCH);
    let mut step = 0;
    for _ in 0..options.rounds {
        for i in (1..order.len()).rev() {
            order.swap(i, (random.next_u64() % (i as u64 + 1)) as usize);
        }
        for batch in order.chunks(BATCH) {
            let mut slope = vec![0.0; count];
            for i in batch {
                search.learn(&lessons[*i], &mut units, &mut slope);
            }
            for slope in &mut slope {
                *slope /= batch.len() as f32;
            }
            let length = STEP * (0.5 + 0.5 * (PI * step as f32 / steps as f32).cos()).powf(1.5) + 1e-5;
            search.step(&mut adam, &slope, length);
            step += 1;
        }
    }
    search
}

/// The mean absolute errors of both parts over the cases, weighted as in the search.
#[must_use]
pub fn objective(rule: NormalsRule, numbers: &Numbers, cases: &[(usize, Case)]) -> f64 {
    let error = |(kind, case): &(usize, Case)| {
        let found = numbers.reflected(rule, &case.lit);
        let weight = weight(Kind::ALL[*kind]);
        weight * ((found[0] - case.truth[0]).abs() + f64::from(SCHLICK) * (found[1] - case.truth[1]).abs())
    };
    let errors: Vec<f64> = cases.par_iter().map(error).collect();
    errors.iter().sum::<f64>() / cases.len() as f64
}

/// The found numbers, with the objectives of the current and the found numbers.
#[derive(Debug, Clone)]
pub struct Found {
    /// The found numbers, rounded to the digits of the source.
    pub numbers: Numbers,
    /// Objectives of the current and the found numbers on the cases of the search.
    pub training: [f64; 2],
    /// Objectives on held-out cases.
    pub held_out: [f64; 2],
}

/// Finds the numbers of a rule.
#[must_use]
pub fn find(options: &Options) -> Found {
    let rule = options.rule;
    let [training, held_out] = [options.seed, options.seed + 1].map(|seed| draw(seed, options.lights));
    let mut lessons: Vec<Lesson> =
        training.par_iter().map(|(kind, case)| Lesson::of(rule, Kind::ALL[*kind], case)).collect();
    let [mean, spread] = spreads(&lessons);
    for x in lessons.iter_mut().flat_map(|lesson| &mut lesson.regions) {
        for (i, input) in x.inputs.iter_mut().enumerate() {
            *input = (*input - mean[i]) / spread[i];
        }
    }
    let starts: Vec<u64> = (0..options.starts).collect();
    let tried: Vec<Numbers> =
        starts.into_par_iter().map(|start| trained(options, start, &lessons).numbers(&mean, &spread)).collect();
    let scored = tried.into_iter().map(|numbers| (objective(rule, &numbers, &training), numbers));
    let current = Numbers::from(rule.network());
    let best = scored.min_by(|a, b| a.0.total_cmp(&b.0)).map_or_else(|| current.clone(), |(_, numbers)| numbers);
    let [training, held_out] =
        [training, held_out].map(|cases| [&current, &best].map(|numbers| objective(rule, numbers, &cases)));
    Found { numbers: best, training, held_out }
}

/// A Markdown table with the errors of several sets of numbers for each kind, on cases from another seed.
#[must_use]
pub fn by_kind(rule: NormalsRule, seed: u64, count: usize, candidates: &[(&str, &Numbers)]) -> String {
    let mut out = "| lights |".to_owned();
    for (name, _) in candidates {
        let _ = write!(out, " {name}: mean / p95 / max, dark, Schlick |");
    }
    let _ = writeln!(out, "\n|---|{}", "---|".repeat(candidates.len()));
    for (i, kind) in Kind::ALL.into_iter().enumerate() {
        let cases = cases(kind, 100 * (seed + 1) + i as u64, count / Kind::ALL.len());
        let _ = write!(out, "| {} |", kind.name());
        for (_, numbers) in candidates {
            let found: Vec<[f64; 2]> = cases.par_iter().map(|case| numbers.reflected(rule, &case.lit)).collect();
            let spread = |part: usize| {
                Spread::of(cases.iter().zip(&found).map(|(case, x)| (x[part] - case.truth[part]).abs()).collect())
            };
            let (Spread { mean, p95, max, .. }, schlick) = (spread(0), spread(1).mean);
            let dark = dark(&cases, &found);
            let _ = write!(out, " {mean:.5} / {p95:.5} / {max:.4}, {dark}, {schlick:.5} |");
        }
        out.push('\n');
    }
    out
}

/// The number of lights that are wrongly dark: the true value is above .001, and the result is less than a fifth of it.
#[must_use]
pub fn dark(cases: &[Case], found: &[[f64; 2]]) -> usize {
    cases.iter().zip(found).filter(|(case, x)| case.truth[0] > 0.001 && x[0] < 0.2 * case.truth[0]).count()
}
