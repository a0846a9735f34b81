//! Compares tables with the best LTC at each configuration, for README.md and docs/layouts.md.
//!
//! The distance is computed as in reports. It shares neither code nor samples with the fit.

use std::{f64::consts::FRAC_PI_2, fmt::Write as _, path::Path};

use ltcforge::{
    BrdfKind, Configuration, Layout, LobeModel, LookedUp, Precision, Preset, Recipe, RecipeDocument as _, Table,
    files::container::decode_npy,
    fit::{Figures, figures_of},
};

use crate::{
    l3::Sampled,
    lights::Spread,
    tables::{best, fitted, looked_up, materials},
};

/// The number of materials between the nodes, and of isotropic materials.
const MATERIALS: [usize; 2] = [400, 300];
/// Nodes along each axis of the grid of KT et al. 2022. The study measures every fifth node.
const GRID: u32 = 8;
const EVERY: usize = 5;

/// Configurations, and the errors of their best LTCs.
struct Judged {
    places: Vec<Configuration>,
    best: Vec<Figures>,
}

fn figures(found: &[(Configuration, LookedUp)]) -> Vec<Figures> {
    figures_of(&BrdfKind::Ggx.into(), LobeModel::Ltc, found)
}

impl Judged {
    fn at(places: Vec<Configuration>) -> Self {
        let best = figures(&best(&places));
        Self { places, best }
    }

    fn compare(&self, table: &Table) -> Comparison {
        self.compare_lookups(&looked_up(table, &self.places))
    }

    fn compare_lookups(&self, found: &[(Configuration, LookedUp)]) -> Comparison {
        let found = figures(found);
        let pairs = || found.iter().zip(&self.best);
        let mean = |of: &[Figures]| of.iter().map(|f| f.sw1).sum::<f64>() / of.len() as f64;
        let ratio_where = |keep: fn(&Configuration) -> bool| {
            Spread::of(pairs().filter(|(found, _)| keep(&found.at)).map(|(found, best)| found.sw1 / best.sw1).collect())
        };
        let term = |k: usize| {
            let errors: Option<Vec<f64>> = found.iter().map(|f| f.terms.map(|terms| terms[k])).collect();
            errors.map(|errors| Spread::of(errors).mean)
        };
        Comparison {
            excess: mean(&found) / mean(&self.best) - 1.0,
            ratio: ratio_where(|_| true),
            sharp: ratio_where(|at| at.alpha_x.max(at.alpha_y) < 0.15).mean,
            grazing: ratio_where(|at| at.theta > 1.3).mean,
            width: Spread::of(pairs().map(|(found, best)| found.width * (1.0 - best.sw1 / found.sw1)).collect()),
            light: Spread::of(found.iter().map(|f| f.light).collect()).mean,
            terms: [term(0), term(1)],
        }
    }
}

/// How close a table comes to the best LTCs.
#[derive(Debug, Clone, Copy)]
pub struct Comparison {
    /// Mean distance divided by the mean distance of the best LTCs, minus one.
    pub excess: f64,
    /// Distance divided by the distance of the best LTC.
    pub ratio: Spread,
    /// Mean of `ratio` for alpha below 0.15.
    pub sharp: f64,
    /// Mean of `ratio` for theta above 1.3.
    pub grazing: f64,
    /// The difference between the distances, relative to the lobe's width.
    pub width: Spread,
    /// Mean error of the energy of square lights.
    pub light: f64,
    /// Mean errors of amplitude and Fresnel term.
    pub terms: [Option<f64>; 2],
}

impl Comparison {
    fn row(&self, name: &str, bytes: &str) -> String {
        let Self { excess, ratio, sharp, grazing, width, light, terms } = *self;
        let terms = terms.map(|term| term.map_or("none".to_owned(), |term| format!("{term:.4}"))).join(" / ");
        format!(
            "| {name} | {bytes} | {:.1} % | {:.3} / {:.2} / {:.2} | {sharp:.2} | {grazing:.2} | {:.4} / {:.4} / {:.3} | \
             {light:.4} | {terms} |\n",
            100.0 * excess,
            ratio.mean,
            ratio.p95,
            ratio.max,
            width.mean,
            width.p95,
            width.max,
        )
    }
}

const HEAD: &str = "\
| table | bytes | excess over best | ratio to best: mean / p95 / max | alpha < 0.15 | theta > 1.3 | \
width above best: mean / p95 / max | light | amplitude / Fresnel term |
|---|---|---|---|---|---|---|---|---|
";

fn bytes(recipe: &Recipe) -> String {
    let number = if recipe.precision() == Precision::F16 { 2 } else { 4 };
    format!("{} KiB", (11 * number * recipe.entries() + 512) / 1024)
}

/// Rows for the default tables of the presets, for preset `draft` in `f16`, and for a table in the published form of KT
/// et al.
///
/// # Errors
/// The file cannot be read, or is not a table in this form.
pub fn presets(published: Option<&Path>) -> Result<String, Box<dyn std::error::Error>> {
    let judged = Judged::at(materials(MATERIALS[0], false));
    let mut out = HEAD.to_owned();
    if let Some(path) = published {
        let table = decode_npy(&std::fs::read(path)?)?.table;
        let bytes = format!("{} KiB", 4 * 11 * table.matrices().len() / 1024);
        out += &judged.compare(&table).row("published", &bytes);
    }
    let f32 = [Preset::Best, Preset::Paper, Preset::Standard, Preset::Draft].map(|preset| (preset, Precision::F32));
    for (preset, precision) in f32.into_iter().chain([(Preset::Draft, Precision::F16)]) {
        let recipe = Recipe::builder().preset(preset).precision(precision).build()?;
        let name = format!("preset `{}`{}", preset.name(), if precision == Precision::F16 { ", `f16`" } else { "" });
        out += &judged.compare(&fitted(&recipe)).row(&name, &bytes(&recipe));
    }
    let at_nodes = Judged::at(grid());
    let builder = Recipe::builder().preset(Preset::Paper).layout(Layout::Kt2022);
    let recipe = ["alpha", "ratio", "theta", "phi"].iter().fold(builder, |b, axis| b.resolution(axis, GRID)).build()?;
    let Comparison { excess, ratio, .. } = at_nodes.compare(&fitted(&recipe));
    let nodes = at_nodes.places.len();
    let _ = writeln!(
        out,
        "\n`kt2022`, 8^4, preset `paper`, at {nodes} of its nodes: {:.1} % above the best, ratio at most {:.1}",
        100.0 * excess,
        ratio.max
    );
    Ok(out)
}

/// Every fifth node of the uniform grid, except nodes with ratio zero.
fn grid() -> Vec<Configuration> {
    let part = |i: u32| f64::from(i) / f64::from(GRID - 1);
    let node = |index: u32| {
        let [alpha, ratio, theta, phi] = [512, 64, 8, 1].map(|stride| part(index / stride % GRID));
        let alpha_x = alpha.max(1e-4);
        let alpha_y = (alpha_x * ratio).max(1e-4);
        Configuration { alpha_x, alpha_y, theta: 0.9999 * FRAC_PI_2 * theta, phi: FRAC_PI_2 * phi }
    };
    (0..GRID.pow(4)).step_by(EVERY).map(node).collect()
}

/// Rows for isotropic tables in the layouts of engines, at preset `standard`, and for the textures that engines ship.
///
/// # Errors
/// A file cannot be read.
pub fn isotropic(shipped: Option<[&Path; 2]>) -> Result<String, Box<dyn std::error::Error>> {
    let judged = Judged::at(materials(MATERIALS[1], true));
    let mut out = HEAD.to_owned();
    if let Some(shipped) = shipped.map(Sampled::read).transpose()? {
        let found: Vec<_> = judged.places.iter().map(|at| (*at, shipped.lookup(at))).collect();
        out += &judged.compare_lookups(&found).row("shipped with engines", "64 KiB");
    }
    let tables = [
        (Layout::Ltc2017, 64, Preset::Standard),
        (Layout::Ltc2016, 64, Preset::Standard),
        (Layout::Ltc2016, 32, Preset::Standard),
        (Layout::Godot, 64, Preset::Standard),
        (Layout::Hdrp, 64, Preset::Standard),
        (Layout::Ltc2017, 64, Preset::Paper),
    ];
    for (layout, side, preset) in tables {
        let builder = Recipe::builder().preset(preset).layout(layout);
        let recipe = builder.resolution("alpha", side).resolution("theta", side).build()?;
        let name = format!("`{layout}`, {side} x {side}, preset `{}`", preset.name());
        out += &judged.compare(&fitted(&recipe)).row(&name, &bytes(&recipe));
    }
    Ok(out)
}

/// Compares a table with the best LTCs at a few materials.
#[must_use]
pub fn compared(recipe: &Recipe, places: usize) -> Comparison {
    Judged::at(materials(places, false)).compare(&fitted(recipe))
}
