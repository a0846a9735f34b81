//! The tables of docs/accuracy.md and docs/lights.md: how much light from below the surface the models let through, and
//! the error of a table's light with and without a cut at the surface.

use std::{f64::consts::TAU, fmt::Write as _};

use glam::DVec3;
use ltcforge::{
    Configuration, Preset, Recipe, RecipeDocument as _,
    fit::{Sides, Table, math::recurrence4},
    light::{LightModel, Lighting, PolygonLight, TableUse},
};
use rayon::prelude::*;

use crate::{
    lights::{Kind, Lit, cases, errors},
    markdown::{short, spread},
    tables::fitted,
};

/// The number of random surfaces per view, and of random lights per row.
const COUNT: usize = 4000;
/// The polar angles of the views, in degrees.
const VIEWS: [f64; 6] = [0.0, 45.0, 60.0, 75.0, 85.0, 89.0];
/// The start of the sequence of surfaces.
const START: [f64; 4] = [0.5; 4];

/// The models with their names. The table stores LTCs.
fn models(table: &Table) -> Vec<(String, Lighting<'_>)> {
    let mut models = vec![
        ("`ltc`, default table".to_owned(), Lighting::by(table)),
        ("the same, `--cut`".to_owned(), Lighting::Table(table, TableUse { cut: true, ..TableUse::default() })),
    ];
    let formulas = LightModel::ALL.iter().flat_map(|model| model.closed_forms());
    models.extend(formulas.map(|form| {
        let rule = form.chosen_rule().map_or(String::new(), |rule| format!(", rule `{rule}`"));
        (format!("`{}`{rule}", form.model()), Lighting::ClosedForm(form))
    }));
    let cut = LightModel::LtcFormula.closed_form(None).map(|form| Lighting::ClosedForm(form.with_cut(true)));
    models.extend(cut.map(|cut| ("`ltc-formula`, `--cut`".to_owned(), cut)));
    models
}

/// The reflected light of a ground that fills all directions below the surface: mean and largest over the surfaces.
fn through(model: Lighting<'_>, theta: f64, count: usize) -> [f64; 2] {
    let square = [[-1e4, -1e4, -1.0], [-1e4, 1e4, -1.0], [1e4, 1e4, -1.0], [1e4, -1e4, -1.0]].map(DVec3::from_array);
    let ground = PolygonLight::new(square.to_vec(), Sides::Two).expect("a light");
    let reflected = |index: usize| {
        let [a, ratio, phi, _] = recurrence4(index, START);
        let alpha_x = a * a;
        let at = Configuration { alpha_x, alpha_y: alpha_x * ratio, theta: theta / 360.0 * TAU, phi: 0.25 * TAU * phi };
        model.reflected(&at, &ground).expect("a surface").energy
    };
    let found: Vec<f64> = (0..count).into_par_iter().map(reflected).collect();
    [found.iter().sum::<f64>() / count as f64, found.iter().copied().fold(0.0, f64::max)]
}

/// The tables, measured with a `part` of the surfaces and lights.
///
/// # Errors
/// None, because preset `paper` is a recipe.
pub fn tables(part: f64) -> Result<String, ltcforge::Error> {
    let count = ((COUNT as f64 * part) as usize).max(20);
    let table = fitted(&Recipe::builder().preset(Preset::Paper).build()?);
    Ok(tables_of(&table, count))
}

/// The tables of the docs, measured with this table of LTCs.
#[must_use]
pub fn tables_of(table: &Table, count: usize) -> String {
    let mut out = String::new();
    let models = models(table);
    // Writing to a String cannot fail.
    let _ = writeln!(out, "docs/accuracy.md, {count} surfaces a view, mean / most of a ground's light:\n");
    let heads = VIEWS.map(|theta| format!("{theta} degrees"));
    let _ = writeln!(out, "| model | {} |\n|---|{}", heads.join(" | "), "---|".repeat(VIEWS.len()));
    for (name, model) in &models {
        let cell = |theta: &f64| match through(*model, *theta, count) {
            [_, 0.0] => " 0 |".to_owned(),
            [mean, most] => format!(" {} / {} |", short(mean, 2), short(most, 2)),
        };
        let _ = writeln!(out, "| {name} |{}", VIEWS.iter().map(cell).collect::<String>());
    }
    let _ = writeln!(out, "\ndocs/lights.md, {count} lights a row, mean / 95th percentile / largest error:\n");
    out += "| lights | `ltc` | `ltc --cut` |\n|---|---|---|\n";
    let kinds = [Kind::Random, Kind::Anisotropic, Kind::Huge, Kind::Steep, Kind::Across, Kind::Strip];
    for (i, kind) in kinds.into_iter().enumerate() {
        let cases = cases(kind, 1060 + i as u64, count);
        let by = |model: Lighting<'_>, lit: &Lit| {
            let found = lit.light().and_then(|light| model.reflected(&lit.at, &light));
            found.map_or([f64::NAN; 2], |found| [found.energy, found.fresnel])
        };
        let cells = models[..2].iter().map(|(_, model)| spread(errors(&cases, |lit| by(*model, lit))[0]));
        let _ = writeln!(out, "| {} | {} |", kind.name(), cells.collect::<Vec<_>>().join(" | "));
    }
    out
}
