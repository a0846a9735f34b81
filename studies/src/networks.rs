//! The numbers by which model `normals` takes the mean of the weight of shadowing: see docs/normals.md, section 7.
//!
//! Networks are found by Adam [Kingma, Ba 2015]: steps along the gradient over a few cases at a time, in units of its
//! running size, which get shorter along half a cosine. The best of several starts is taken. Everything is drawn from
//! the seed, and sums have one order.

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

/// Digits of a number, as the source has them.
const DIGITS: i32 = 4;
/// Cases of a step.
const BATCH: usize = 256;
/// The length of the first step.
const STEP: f32 = 0.015;
/// How much of the gradient's running mean is kept from step to step, and of its running square.
const KEPT: [f32; 2] = [0.9, 0.999];
/// Errors below this are as good as none: squares take the place of sizes there.
const NEGLIGIBLE: f32 = 2e-4;
/// How much an error's square counts beside its size, so that no light is far off.
const LARGE: f32 = 10.0;
/// How much an error of Schlick's part counts beside one of the energy.
const SCHLICK: f32 = 0.7;

/// The arguments of [`find`].
#[derive(Debug, Clone, Copy)]
pub struct Asked {
    /// The rule.
    pub rule: NormalsRule,
    /// Lights of the search, and again of the hold-out.
    pub lights: usize,
    /// How often each is seen.
    pub rounds: usize,
    /// How many networks are tried.
    pub starts: u64,
    /// Seed of lights and starts.
    pub seed: u64,
}

/// How many units a rule's network has.
#[must_use]
pub fn units(rule: NormalsRule) -> usize {
    match rule {
        NormalsRule::Fast => 3,
        NormalsRule::Balanced => 12,
        NormalsRule::Fine | NormalsRule::Exact => 8,
    }
}

/// How many outputs a rule's network has: only triangles have a tip.
#[must_use]
pub fn outputs(rule: NormalsRule) -> usize {
    if matches!(rule, NormalsRule::Fine | NormalsRule::Exact) { OUTPUTS } else { OUTPUTS - 1 }
}

/// `count` cases, shared evenly among the kinds.
#[must_use]
pub fn drawn(seed: u64, count: usize) -> Vec<(usize, Case)> {
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
    /// The light that a rule finds by these numbers.
    #[must_use]
    pub fn reflected(&self, rule: NormalsRule, lit: &Lit) -> [f64; 2] {
        let (units, outputs) = (slices(&self.units), slices(&self.outputs));
        let network = Network { units: &units, outputs: &outputs };
        let found = regions(lit.alpha(), lit.wo(), &lit.vertices, Sides::Two, rule);
        found.map_or([0.0; 2], |found| found.reflected(|region| network.at(&region.inputs[..rule.inputs()])))
    }

    /// The numbers as `src/light/normals/numbers.rs` has them.
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

    /// The numbers as the rule's shader has them: matrices by columns, four inputs a matrix and at most four units.
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

/// Columns of rows as a matrix of WGSL.
fn matrix(rows: &[Vec<f64>], from: usize, to: usize) -> String {
    let column = |k: usize| listed(&rows.iter().map(|row| row[k]).collect::<Vec<_>>());
    let columns: Vec<String> = (from..to).map(column).collect();
    format!("mat{}x{}({})", to - from, rows.len(), columns.join(", "))
}

fn listed(numbers: &[f64]) -> String {
    numbers.iter().map(|x| format!("{x:?}")).collect::<Vec<_>>().join(", ")
}

/// A number with as many digits as the source has.
fn rounded(x: f64) -> f64 {
    if x == 0.0 {
        return 0.0;
    }
    let one = 10_f64.powi(DIGITS - 1 - x.abs().log10().floor() as i32);
    // Decimal digits: the quotient of two whole numbers, or the product where there are no digits behind the point.
    if one >= 1.0 { (x * one).round() / one } else { (x * one).round() * one.recip().round() }
}

/// A region in the numbers of the search.
struct Seen {
    part: f32,
    at_mean: f32,
    schlick: f32,
    /// What the outputs count: 1 times the part for the first two, then how far corners and tip are from the mean.
    beside: [f32; 2],
    inputs: [f32; INPUTS],
}

/// How much the cases of a kind count.
fn weight(kind: Kind) -> f64 {
    if matches!(kind, Kind::Random | Kind::Anisotropic | Kind::Strip) { 3.0 } else { 1.0 }
}

/// A case in the numbers of the search.
struct Lesson {
    truth: [f32; 2],
    /// How much it counts.
    count: f32,
    visible: f32,
    regions: Vec<Seen>,
}

impl Lesson {
    fn of(rule: NormalsRule, kind: Kind, Case { lit, truth }: &Case) -> Self {
        let found = regions(lit.alpha(), lit.wo(), &lit.vertices, Sides::Two, rule);
        let (visible, regions) = found.map_or((0.0, Vec::new()), |found| (found.visible, found.regions));
        let seen = |region: &Region<f64>| Seen {
            part: region.part as f32,
            at_mean: region.at_mean as f32,
            schlick: region.schlick as f32,
            beside: [region.at_corners - region.at_mean, region.at_tip - region.at_mean].map(|x| x as f32),
            inputs: region.inputs.map(|x| x as f32),
        };
        let count = weight(kind) as f32;
        Self {
            truth: truth.map(|x| x as f32),
            count,
            visible: visible as f32,
            regions: regions.iter().map(seen).collect(),
        }
    }
}

/// A network in the search: `weights` are its rows, one after the other.
struct Search {
    inputs: usize,
    units: usize,
    outputs: usize,
    weights: Vec<f32>,
}

/// What a network makes of a region, and what of it can be moved.
#[derive(Clone, Copy, Default)]
struct Told {
    mean: [f32; 2],
    is_free: [bool; 2],
}

/// Running sums of a search.
struct Adam {
    slope: Vec<f32>,
    square: Vec<f32>,
    kept: [f32; 2],
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
            // Corners count a third to begin with.
            weights.push(if output == 2 { 0.3 } else { 0.0 });
        }
        Self { inputs, units, outputs, weights }
    }

    /// Where the row of an output begins.
    fn output(&self, output: usize) -> usize {
        self.units * (self.inputs + 1) + output * (self.units + 1)
    }

    fn tell(&self, seen: &Seen, units: &mut [f32]) -> Told {
        for (row, unit) in self.weights.chunks_exact(self.inputs + 1).zip(units.iter_mut()) {
            let sum = row.iter().zip(&seen.inputs[..self.inputs]).fold(row[self.inputs], |sum, (w, x)| sum + w * x);
            *unit = sum.max(0.0);
        }
        let mut out = [0.0; OUTPUTS];
        for (output, out) in out[..self.outputs].iter_mut().enumerate() {
            let row = &self.weights[self.output(output)..][..=self.units];
            *out = row.iter().zip(&*units).fold(row[self.units], |sum, (w, x)| sum + w * x);
        }
        let size = seen.part.abs();
        let mean = seen.at_mean + out[2] * seen.beside[0] + out[3] * seen.beside[1] + size * out[0];
        let held = mean.clamp(0.0, 1.0);
        let schlick = held * seen.schlick + size * out[1];
        Told { mean: [held, schlick.clamp(0.0, held)], is_free: [mean == held, (0.0..=held).contains(&schlick)] }
    }

    /// Adds the gradient of a lesson's error.
    fn learn(&self, lesson: &Lesson, units: &mut [Vec<f32>], slope: &mut [f32]) {
        let (mut sum, mut all, mut parts) = ([0.0; 2], [0.0; 2], 1e-30_f32);
        let mut told = [Told::default(); 16];
        for ((seen, told), units) in lesson.regions.iter().zip(&mut told).zip(units.iter_mut()) {
            *told = self.tell(seen, units);
            for i in 0..2 {
                sum[i] += seen.part * told.mean[i];
                all[i] += seen.part.abs() * told.mean[i];
            }
            parts += seen.part.abs();
        }
        let least = LEAST_OF_OVERLAPPING as f32 * lesson.visible / parts;
        let is_least = [0, 1].map(|i| least * all[i] > sum[i]);
        let errors = [0, 1].map(|i| sum[i].max(least * all[i]) - lesson.truth[i]);
        let by_error = |i: usize| {
            let (error, count) = (errors[i], if i == 0 { lesson.count } else { SCHLICK * lesson.count });
            count * (error / error.hypot(NEGLIGIBLE) + 2.0 * LARGE * error)
        };
        let by_error = [by_error(0), by_error(1)];
        for ((seen, told), units) in lesson.regions.iter().zip(&told).zip(units.iter()) {
            let size = seen.part.abs();
            let by_mean = |i: usize| by_error[i] * if is_least[i] { least * size } else { seen.part };
            let by_schlick = if told.is_free[1] { by_mean(1) } else { 0.0 };
            let by_energy = if told.is_free[0] { by_mean(0) + by_schlick * seen.schlick } else { 0.0 };
            let by_output =
                [by_energy * size, by_schlick * size, by_energy * seen.beside[0], by_energy * seen.beside[1]];
            for (output, by_output) in by_output[..self.outputs].iter().enumerate() {
                let row = &mut slope[self.output(output)..][..=self.units];
                row.iter_mut().zip(units).for_each(|(slope, unit)| *slope += by_output * unit);
                row[self.units] += by_output;
            }
            for (unit, _) in units.iter().enumerate().filter(|(_, value)| **value > 0.0) {
                let by_unit =
                    (0..self.outputs).map(|k| by_output[k] * self.weights[self.output(k) + unit]).sum::<f32>();
                let row = &mut slope[unit * (self.inputs + 1)..][..=self.inputs];
                row.iter_mut().zip(&seen.inputs[..self.inputs]).for_each(|(slope, x)| *slope += by_unit * x);
                row[self.inputs] += by_unit;
            }
        }
    }

    fn step(&mut self, adam: &mut Adam, slope: &[f32], length: f32) {
        for (kept, of) in adam.kept.iter_mut().zip(KEPT) {
            *kept *= of;
        }
        let [by, by2] = adam.kept.map(|kept| 1.0 / (1.0 - kept));
        for (i, slope) in slope.iter().enumerate() {
            adam.slope[i] += (1.0 - KEPT[0]) * (slope - adam.slope[i]);
            adam.square[i] += (1.0 - KEPT[1]) * (slope * slope - adam.square[i]);
            self.weights[i] -= length * (adam.slope[i] * by) / ((adam.square[i] * by2).sqrt() + 1e-9);
        }
    }

    /// The numbers for inputs as they are, found for inputs less `mean` over `spread`.
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
    let mean = |of: &dyn Fn(&Seen) -> f64| lessons.iter().flat_map(|l| &l.regions).map(of).sum::<f64>() / count;
    let means: Vec<f64> = (0..INPUTS).map(|i| mean(&|seen| f64::from(seen.inputs[i]))).collect();
    let spread = |i: usize| mean(&|seen| (f64::from(seen.inputs[i]) - means[i]).powi(2)).sqrt().max(1e-6) as f32;
    [means.iter().map(|x| *x as f32).collect(), (0..INPUTS).map(spread).collect()]
}

fn trained(asked: &Asked, start: u64, lessons: &[Lesson]) -> Search {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(1000 * asked.seed + start);
    let mut search = Search::new(asked.rule, &mut random);
    let count = search.weights.len();
    let mut adam = Adam { slope: vec![0.0; count], square: vec![0.0; count], kept: [1.0; 2] };
    let mut units = vec![vec![0.0; search.units]; 16];
    let mut order: Vec<usize> = (0..lessons.len()).collect();
    let steps = asked.rounds * lessons.len().div_ceil(BATCH);
    let mut step = 0;
    for _ in 0..asked.rounds {
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

/// The mean over cases of both parts' absolute errors, weighed as in the search.
#[must_use]
pub fn objective(rule: NormalsRule, numbers: &Numbers, cases: &[(usize, Case)]) -> f64 {
    let error = |(kind, case): &(usize, Case)| {
        let found = numbers.reflected(rule, &case.lit);
        let count = weight(Kind::ALL[*kind]);
        count * ((found[0] - case.truth[0]).abs() + f64::from(SCHLICK) * (found[1] - case.truth[1]).abs())
    };
    let errors: Vec<f64> = cases.par_iter().map(error).collect();
    errors.iter().sum::<f64>() / cases.len() as f64
}

/// The numbers that were found, and the objective of those that stand and of these, on other lights.
#[derive(Debug, Clone)]
pub struct Found {
    /// The numbers, rounded as the source has them.
    pub numbers: Numbers,
    /// Objectives on the cases of the search: of the numbers that stand, of those found.
    pub seen: [f64; 2],
    /// The same on others.
    pub held_out: [f64; 2],
}

/// Finds the numbers of a rule.
#[must_use]
pub fn find(asked: &Asked) -> Found {
    let rule = asked.rule;
    let [seen, held_out] = [asked.seed, asked.seed + 1].map(|seed| drawn(seed, asked.lights));
    let mut lessons: Vec<Lesson> =
        seen.par_iter().map(|(kind, case)| Lesson::of(rule, Kind::ALL[*kind], case)).collect();
    let [mean, spread] = spreads(&lessons);
    for x in lessons.iter_mut().flat_map(|lesson| &mut lesson.regions) {
        for (i, input) in x.inputs.iter_mut().enumerate() {
            *input = (*input - mean[i]) / spread[i];
        }
    }
    let starts: Vec<u64> = (0..asked.starts).collect();
    let tried: Vec<Numbers> =
        starts.into_par_iter().map(|start| trained(asked, start, &lessons).numbers(&mean, &spread)).collect();
    let scored = tried.into_iter().map(|numbers| (objective(rule, &numbers, &seen), numbers));
    let standing = Numbers::from(rule.network());
    let best = scored.min_by(|a, b| a.0.total_cmp(&b.0)).map_or_else(|| standing.clone(), |(_, numbers)| numbers);
    let [seen, held_out] =
        [seen, held_out].map(|cases| [&standing, &best].map(|numbers| objective(rule, numbers, &cases)));
    Found { numbers: best, seen, held_out }
}

/// The errors of some numbers for each kind, on cases of another seed, as markdown.
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
            let of = |part: usize| {
                Spread::of(cases.iter().zip(&found).map(|(case, x)| (x[part] - case.truth[part]).abs()).collect())
            };
            let (Spread { mean, p95, max, .. }, schlick) = (of(0), of(1).mean);
            let dark = dark(&cases, &found);
            let _ = write!(out, " {mean:.5} / {p95:.5} / {max:.4}, {dark}, {schlick:.5} |");
        }
        out.push('\n');
    }
    out
}

/// How many lights are nearly black that are not: less than a fifth of the truth, where that is above .001.
#[must_use]
pub fn dark(cases: &[Case], found: &[[f64; 2]]) -> usize {
    cases.iter().zip(found).filter(|(case, x)| case.truth[0] > 0.001 && x[0] < 0.2 * case.truth[0]).count()
}
