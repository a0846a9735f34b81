//! Finds the networks of model `normals`. They estimate the mean weight of shadowing: see docs/normals.md.
//!
//! The optimiser is Adam [Kingma, Ba 2015]: each step follows the gradient over a few cases, in units of its running
//! size. The step length decreases along half a cosine. The result is the start with the least product of its error and
//! the relative error of strips. All random numbers
//! come from the seed, and sums have a fixed order.

use std::{f64::consts::PI, fmt::Write as _};

use ltcforge::{
    fit::Sides,
    light::{
        NormalsRule,
        normals::{INPUTS, Network, OUTPUTS, Region, region},
    },
};
use rand_core::{Rng as _, SeedableRng as _};
use rand_xoshiro::Xoshiro256PlusPlus;
use rayon::prelude::*;

use crate::{
    lights::{Case, Kind, Lit, Spread, cases, lits},
    paths::{about_middle, to_one_side},
};

/// Significant digits of a number in the source.
const DIGITS: i32 = 4;
/// Cases per step.
const BATCH: usize = 256;
/// The length of the first step.
const STEP: f64 = 0.006;
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
const SCHLICK: f64 = 0.7;
/// Steps of a light that grows.
const GROWTH: usize = 10;
/// The number of lights that grow, relative to the number of lights.
const PATHS: f64 = 0.25;
/// The weight of a squared fall of a light that grows, for metal and for plastic.
const FALL: [f64; 2] = [400.0, 2000.0];
/// Reflectance at normal incidence of the plastic.
const PLASTIC: f64 = 0.04;
/// The outputs that are shares of blends.
const SHARES: [usize; 2] = [0, 3];
/// The slope of a share beyond its ends, in the first half of the search.
const LEAK: f64 = 0.1;
/// The step of differences by an output.
const TINY: f64 = 1e-5;

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
        NormalsRule::Balanced => 4,
        NormalsRule::Fine | NormalsRule::Exact => 24,
    }
}

/// The number of outputs of a rule's network. Rule `fast` has no samples of the outline, so it has no use for the last
/// two.
#[must_use]
pub fn outputs(rule: NormalsRule) -> usize {
    if rule == NormalsRule::Fast { OUTPUTS - 2 } else { OUTPUTS }
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
        region_of(rule, lit).map_or([0.0; 2], |region| region.reflected(&network))
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

    /// The numbers as written in the shader of the rule: matrices in column order, each with at most four inputs and
    /// four units. The fifth output is apart.
    #[must_use]
    pub fn as_wgsl(&self, rule: NormalsRule) -> String {
        let mut out = String::new();
        let (group, inputs) = (self.units.len().min(4), rule.inputs());
        for (i, units) in self.units.chunks(group).enumerate() {
            let term = |(from, name): (usize, &str)| format!("{} * {name}", matrix(units, from, inputs.min(from + 4)));
            let terms: Vec<String> = (0..inputs).step_by(4).zip(["first", "second", "third"]).map(term).collect();
            let bias = listed(&units.iter().map(|row| row[inputs]).collect::<Vec<_>>());
            let _ = writeln!(
                out,
                "    let sum_{i} = {}\n        + vec{group}({bias});\n    let units_{i} = sum_{i} + sqrt(sum_{i} * sum_{i} + 1.0);",
                terms.join("\n        + "),
            );
        }
        let (told, fifth) = self.outputs.split_at(self.outputs.len().min(4));
        let groups = 0..self.units.len() / group;
        for (name, rows) in [("outputs", told), ("fifth", fifth)].into_iter().filter(|(_, rows)| !rows.is_empty()) {
            let count = rows.len();
            let term = |i: usize| {
                let matrix = matrix(rows, i * group, (i + 1) * group);
                if count == 1 { format!("dot({matrix}, units_{i})") } else { format!("{matrix} * units_{i}") }
            };
            let terms: Vec<String> = groups.clone().map(term).collect();
            let bias = listed(&rows.iter().map(|row| row[self.units.len()]).collect::<Vec<_>>());
            let bias = if count == 1 { bias } else { format!("vec{count}({bias})") };
            let _ = writeln!(out, "    let {name} = {}\n        + {bias};", terms.join("\n        + "));
        }
        out
    }
}

fn region_of(rule: NormalsRule, lit: &Lit) -> Option<Region<f64>> {
    region(lit.alpha(), lit.wo(), &lit.vertices, Sides::Two, rule)
}

fn slices(rows: &[Vec<f64>]) -> Vec<&[f64]> {
    rows.iter().map(Vec::as_slice).collect()
}

/// Some columns of the rows, as a WGSL matrix, or as a vector if there is one row or one column.
fn matrix(rows: &[Vec<f64>], from: usize, to: usize) -> String {
    let column = |k: usize| listed(&rows.iter().map(|row| row[k]).collect::<Vec<_>>());
    let columns: Vec<String> = (from..to).map(column).collect();
    let name = match (to - from, rows.len()) {
        (1, count) | (count, 1) => format!("vec{count}"),
        (columns, rows) => format!("mat{columns}x{rows}"),
    };
    format!("{name}({})", columns.join(", "))
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

/// The weight of cases of a kind.
fn weight(kind: Kind) -> f64 {
    if matches!(kind, Kind::Random | Kind::Anisotropic | Kind::Strip) { 3.0 } else { 1.0 }
}

/// What a network has to learn. The inputs of the regions are normalised.
enum Lesson {
    /// The true light of a region, and the weight of the case.
    Light(Region<f64>, [f64; 2], f64),
    /// A light that grows, in some steps. What it reflects must not fall.
    Growth(Vec<Region<f64>>),
}

impl Lesson {
    fn light(rule: NormalsRule, kind: Kind, case: &Case) -> Option<Self> {
        Some(Self::Light(region_of(rule, &case.lit)?, case.truth, weight(kind)))
    }

    fn growth(rule: NormalsRule, path: fn(&Lit, f64) -> Lit, lit: &Lit, from: f64) -> Self {
        let at = |i: usize| path(lit, from + (1.0 - from) * i as f64 / (GROWTH - 1) as f64);
        Self::Growth((0..GROWTH).filter_map(|i| region_of(rule, &at(i))).collect())
    }

    fn regions(&mut self) -> &mut [Region<f64>] {
        match self {
            Self::Light(region, ..) => std::slice::from_mut(region),
            Self::Growth(regions) => regions,
        }
    }
}

/// The lessons of a search, and the mean and the spread by which their inputs are normalised.
fn lessons(options: &Options, cases: &[(usize, Case)]) -> (Vec<Lesson>, [Vec<f64>; 2]) {
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
struct Search {
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
struct Told {
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
            // Both blends start in their middle.
            weights.push(if SHARES.contains(&output) { 0.5 } else { 0.0 });
        }
        Self { inputs, units, outputs, weights }
    }

    /// The index of the first weight of an output's row.
    fn output(&self, output: usize) -> usize {
        self.units * (self.inputs + 1) + output * (self.units + 1)
    }

    fn told(&self, region: &Region<f64>) -> Told {
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
        Told { units, slopes, outputs, light: light(region, outputs) }
    }

    /// Adds the gradient of an error, from its slope by both parts of the light. `leak` is the slope of a blend's share
    /// beyond its ends, so that it can return.
    fn learn(&self, region: &Region<f64>, told: &Told, by_light: [f64; 2], leak: f64, slope: &mut [f64]) {
        let mut by_output = [0.0; OUTPUTS];
        for (k, by_output) in by_output[..self.outputs].iter_mut().enumerate() {
            let at = |x: f64| {
                let mut outputs = told.outputs;
                outputs[k] = x;
                light(region, outputs)
            };
            let x = told.outputs[k];
            let is_beyond = SHARES.contains(&k) && !(0.0..=1.0).contains(&x);
            let ([low, high], scale) =
                if is_beyond { ([0.0, 1.0].map(at), leak) } else { ([x - TINY, x + TINY].map(at), 0.5 / TINY) };
            *by_output = scale * (by_light[0] * (high[0] - low[0]) + by_light[1] * (high[1] - low[1]));
            let row = &mut slope[self.output(k)..][..=self.units];
            row.iter_mut().zip(&told.units).for_each(|(slope, unit)| *slope += *by_output * unit);
            row[self.units] += *by_output;
        }
        for unit in 0..self.units {
            let sum: f64 = (0..self.outputs).map(|k| by_output[k] * self.weights[self.output(k) + unit]).sum();
            let by_unit = sum * told.slopes[unit];
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
                let told = self.told(region);
                let mut by_light = [0.0; 2];
                for (i, by_light) in by_light.iter_mut().enumerate() {
                    let error = told.light[i] - truth[i];
                    let relative = 1.0 + RELATIVE / (truth[i] + DARK);
                    let part = if i == 0 { *weight } else { SCHLICK * weight };
                    let root = error.hypot(NEGLIGIBLE);
                    sum += part * (relative * root + LARGE * error * error);
                    *by_light = part * (relative * error / root + 2.0 * LARGE * error);
                }
                self.learn(region, &told, by_light, leak, slope);
            }
            Lesson::Growth(regions) => {
                let told: Vec<Told> = regions.iter().map(|region| self.told(region)).collect();
                let mut by_light = vec![[0.0; 2]; told.len()];
                for (of, fall_weight) in [[1.0, 0.0], [PLASTIC, 1.0 - PLASTIC]].into_iter().zip(FALL) {
                    let value = |told: &Told| of[0] * told.light[0] + of[1] * told.light[1];
                    let mut most = 0;
                    for i in 0..told.len() {
                        let fall = value(&told[most]) - value(&told[i]);
                        if fall <= 0.0 {
                            most = i;
                            continue;
                        }
                        sum += 0.5 * fall_weight * fall * fall;
                        for part in 0..2 {
                            by_light[i][part] -= fall_weight * fall * of[part];
                            by_light[most][part] += fall_weight * fall * of[part];
                        }
                    }
                }
                for ((region, told), by_light) in regions.iter().zip(&told).zip(by_light) {
                    if by_light != [0.0; 2] {
                        self.learn(region, told, by_light, leak, slope);
                    }
                }
            }
        }
        sum
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
    fn numbers(&self, [mean, spread]: &[Vec<f64>; 2]) -> Numbers {
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
fn trained(options: &Options, start: u64, lessons: &[Lesson]) -> (f64, Search) {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(1000 * options.seed + start);
    let mut search = Search::new(options.rule, &mut random);
    let count = search.weights.len();
    let mut adam = Adam { slope: vec![0.0; count], square: vec![0.0; count], decayed: [1.0; 2] };
    let mut order: Vec<usize> = (0..lessons.len()).collect();
    let steps = options.rounds * lessons.len().div_ceil(BATCH);
    let mut step = 0_usize;
    for round in 0..options.rounds {
        for i in (1..order.len()).rev() {
            order.swap(i, (random.next_u64() % (i as u64 + 1)) as usize);
        }
        let leak = if 2 * round < options.rounds { LEAK } else { 0.0 };
        for batch in order.chunks(BATCH) {
            let mut slope = vec![0.0; count];
            for i in batch {
                search.study(&lessons[*i], leak, &mut slope);
            }
            for slope in &mut slope {
                *slope /= batch.len() as f64;
            }
            let length = STEP * (0.5 + 0.5 * (PI * step as f64 / steps as f64).cos()).powf(1.5) + 1e-5;
            search.step(&mut adam, &slope, length);
            step += 1;
        }
    }
    let error: f64 = lessons.iter().map(|lesson| search.study(lesson, 0.0, &mut vec![0.0; count])).sum();
    (error / lessons.len() as f64, search)
}

/// The mean absolute errors of both parts over the cases, weighted as in the search.
#[must_use]
pub fn objective(rule: NormalsRule, numbers: &Numbers, cases: &[(usize, Case)]) -> f64 {
    let error = |(kind, case): &(usize, Case)| {
        let found = numbers.reflected(rule, &case.lit);
        let weight = weight(Kind::ALL[*kind]);
        weight * ((found[0] - case.truth[0]).abs() + SCHLICK * (found[1] - case.truth[1]).abs())
    };
    let errors: Vec<f64> = cases.par_iter().map(error).collect();
    errors.iter().sum::<f64>() / cases.len() as f64
}

/// p95 of the relative error of the strips that reflect more than .001.
fn strips(rule: NormalsRule, numbers: &Numbers, cases: &[(usize, Case)]) -> f64 {
    let bright = cases.iter().filter(|(kind, case)| Kind::ALL[*kind] == Kind::Strip && case.truth[0] > 0.001);
    let relative =
        |(_, case): &(usize, Case)| (numbers.reflected(rule, &case.lit)[0] - case.truth[0]).abs() / case.truth[0];
    Spread::of(bright.map(relative).collect()).p95
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
    let (lessons, normal) = lessons(options, &training);
    let starts: Vec<u64> = (0..options.starts).collect();
    let tried = starts.into_par_iter().map(|start| {
        let (error, search) = trained(options, start, &lessons);
        let numbers = search.numbers(&normal);
        (error * strips(rule, &numbers, &training), numbers)
    });
    let tried: Vec<(f64, Numbers)> = tried.collect();
    let current = Numbers::from(rule.network());
    let best = tried.into_iter().min_by(|a, b| a.0.total_cmp(&b.0)).map_or_else(|| current.clone(), |(_, best)| best);
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
