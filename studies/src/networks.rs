//! Finds the networks of model `normals`. They estimate the mean weight of shadowing: see docs/normals.md.
//!
//! The optimiser is Adam [Kingma, Ba 2015], with batches of 256 cases. The step length follows half a cosine. Of several
//! starts, the search keeps the one with the smallest product of loss and relative error of strips. All random numbers
//! come from the seed, and sums have a fixed order.

mod numbers;
mod search;

use std::fmt::Write as _;

use ltcforge::light::{NormalsRule, normals::OUTPUTS};
use rayon::prelude::*;

pub use self::numbers::Numbers;
use self::search::{SCHLICK, lessons, trained, weight};
use crate::lights::{Case, Kind, Spread, cases};

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
    /// True to start from the current numbers, with a shorter step. Otherwise starts are random.
    pub refine: bool,
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
        let (error, search) = trained(options, start, &lessons, &normal);
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
