//! The tables of docs/normals.md and docs/lights.md: errors of model `normals` and of a table of LTCs for random
//! lights.

use std::fmt::Write as _;

use ltcforge::{
    Preset, Recipe, RecipeDocument as _,
    fit::{Sides, Table},
    light::{
        NormalsRule, by_table,
        normals::{reflected, region, visible},
    },
};

use crate::{
    lights::{Case, Kind, Lit, Spread, cases, errors},
    markdown::{short, spread},
    networks::Numbers,
    tables::fitted,
};

/// Lights per row of the first table, and in its tail.
const LIGHTS: [usize; 2] = [4000, 20_000];
const RULES: [NormalsRule; 3] = [NormalsRule::Fast, NormalsRule::Balanced, NormalsRule::Fine];
/// The kinds in the table for the visible part by four arcs.
const ARCS: [Kind; 6] = [Kind::Random, Kind::Anisotropic, Kind::Huge, Kind::Steep, Kind::Strip, Kind::Sliver];

/// Errors of V by four arcs per edge, against the exact integrals.
fn visible_errors(cases: &[Case]) -> Spread {
    let error = |case: &Case| {
        let Lit { vertices, .. } = &case.lit;
        let (alpha, wo) = (case.lit.alpha(), case.lit.wo());
        let found = region(alpha, wo, vertices, Sides::Two, NormalsRule::Balanced).map_or(0.0, |found| found.visible);
        (found - visible(alpha, wo, vertices).abs()).abs()
    };
    Spread::of(cases.iter().map(error).collect())
}

/// The reflected light by a rule of model `normals`.
#[must_use]
pub fn by_rule(rule: NormalsRule, lit: &Lit) -> [f64; 2] {
    reflected(lit.alpha(), lit.wo(), &lit.vertices, Sides::Two, rule)
}

fn by_ltc(table: &Table, lit: &Lit) -> [f64; 2] {
    let found = lit.light().and_then(|light| by_table(table, &lit.at, &light));
    found.map_or([f64::NAN; 2], |found| [found.energy, found.fresnel])
}

/// The table of docs/accuracy.md for very smooth surfaces and grazing views.
fn extremes(lights: usize) -> String {
    let mut out =
        "\ndocs/accuracy.md:\n\n| lights | rule | mean | p50 | p95 | p99 | max |\n|---|---|---|---|---|---|---|\n"
            .to_owned();
    for (kind, seed) in [(Kind::Extreme, 1008), (Kind::Needle, 1009)] {
        let cases = cases(kind, seed, lights);
        for rule in RULES {
            let [Spread { mean, p50, p95, p99, max, .. }, _] = errors(&cases, |lit| by_rule(rule, lit));
            let cells = [mean, p50, p95, p99, max].map(|error| short(error, 2)).join(" | ");
            // Writing to a String cannot fail.
            let _ = writeln!(out, "| {}, {lights} | `{rule}` | {cells} |", kind.name());
        }
    }
    out
}

/// The tables, measured with a `part` of the lights in each row.
///
/// # Errors
/// None, because preset `paper` is a recipe.
pub fn tables(part: f64) -> Result<String, ltcforge::Error> {
    let [lights, tail] = LIGHTS.map(|count| ((count as f64 * part) as usize).max(20));
    let table = fitted(&Recipe::builder().preset(Preset::Paper).build()?);
    let mut out = String::new();
    // Writing to a String cannot fail.
    let _ = writeln!(out, "docs/normals.md, {lights} lights a row:\n");
    out += "| lights | LTC, default table | `fast` | `balanced` | `fine` |\n|---|---|---|---|---|\n";
    let mut fresnel = Vec::new();
    for (i, kind) in [
        Kind::Random,
        Kind::Anisotropic,
        Kind::Sharp,
        Kind::Steep,
        Kind::Across,
        Kind::Huge,
        Kind::Tiny,
        Kind::Strip,
        Kind::Extreme,
        Kind::Thin,
    ]
    .into_iter()
    .enumerate()
    {
        let cases = cases(kind, 1000 + i as u64, lights);
        let [ltc, _] = errors(&cases, |lit| by_ltc(&table, lit));
        let by_rules = RULES.map(|rule| errors(&cases, |lit| by_rule(rule, lit)));
        fresnel.push(short(by_rules[1][1].mean, 2));
        let cells = [ltc, by_rules[0][0], by_rules[1][0], by_rules[2][0]].map(spread).join(" | ");
        let _ = writeln!(out, "| {} | {cells} |", kind.name());
    }
    let _ = writeln!(out, "\nSchlick's part, mean of `balanced`: {}", fresnel.join(", "));
    let [Spread { p999, max, .. }, _] =
        errors(&cases(Kind::Random, 1010, tail), |lit| by_rule(NormalsRule::Balanced, lit));
    let _ = writeln!(
        out,
        "of {tail} more of the first row: one in a thousand {}, largest {}",
        short(p999, 2),
        short(max, 2)
    );

    out += &extremes(lights);

    let _ = writeln!(out, "\ndocs/normals.md, V by four arcs an edge:\n\n| light | four arcs |\n|---|---|");
    for (i, kind) in ARCS.into_iter().enumerate() {
        let cases = cases(kind, 1040 + i as u64, lights);
        let _ = writeln!(out, "| V, {} | {} |", kind.name(), spread(visible_errors(&cases)));
    }

    out += "\ndocs/lights.md:\n\n| lights | rule | energy: mean, p95, max | Fresnel part: mean, p95, max |\n|---|---|---|---|\n";
    for (kind, seed, count) in [(Kind::Random, 1030, 10 * lights / 4), (Kind::Anisotropic, 1031, 3 * lights / 4)] {
        let cases = cases(kind, seed, count);
        for rule in [NormalsRule::Balanced, NormalsRule::Fine, NormalsRule::Fast] {
            let [energy, fresnel] = errors(&cases, |lit| by_rule(rule, lit)).map(|x| spread(x).replace(" /", ","));
            let _ = writeln!(out, "| {}, {count} | `{rule}` | {energy} | {fresnel} |", kind.name());
        }
    }
    Ok(out)
}

/// Mean errors of the energy, with the current numbers and with an empty network.
#[must_use]
pub fn current_and_empty(cases: &[Case]) -> [f64; 2] {
    let rule = NormalsRule::Balanced;
    let empty = Numbers { units: Vec::new(), outputs: Vec::new() };
    [Numbers::from(rule.network()), empty].map(|numbers| errors(cases, |lit| numbers.reflected(rule, lit))[0].mean)
}
