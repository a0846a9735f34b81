//! Finds the constants by which `src/fit/expectation.rs` predicts the error of a table from its recipe: the numbers of
//! that file and of the layouts, and the factors of scattering and lobe models.
//!
//! The study fits tables and measures `between.width.mean` of a report. The law is a sum of powers. Its factors come
//! from least squares of relative errors, and its two exponents come from a grid search. See docs/tradeoff.md.

use ltcforge::{
    BrdfKind, Layout, LobeModel, Preset, Recipe, RecipeDocument as _,
    fit::{expectation, width_between},
};

use crate::{
    linear::{Measured, least_squares, predicted, relative_error},
    source::line,
    tables::fitted,
};

/// The exponents to try: first, last and step.
const SAMPLES_EXPONENT: [f64; 3] = [0.8, 2.0, 0.1];
const DIRECTIONS_EXPONENT: [f64; 3] = [1.0, 3.0, 0.5];
const AXES: [&str; 4] = ["alpha", "ratio", "theta", "phi"];

/// The limit, and the factors of alpha, ratio, theta, phi, samples and directions.
pub type Numbers = [f64; 7];

/// The numbers of a layout, and the exponents for samples and directions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Law {
    /// The limit and the factors.
    pub numbers: Numbers,
    /// Exponents for samples and for directions.
    pub exponents: [f64; 2],
}

/// A recipe and the error of its table.
struct Fitted {
    recipe: Recipe,
    error: f64,
}

impl Fitted {
    fn new(recipe: Recipe, points: usize) -> Self {
        let error = width_between(&fitted(&recipe), points).mean;
        Self { recipe, error }
    }

    fn measured(&self, exponents: [f64; 2]) -> Measured<7> {
        let Self { recipe, error } = self;
        let steps = recipe.layout().steps(&recipe.range(), &recipe.resolution());
        let [alpha, ratio, theta, phi] = [steps.alpha, steps.ratio, steps.theta, steps.phi].map(|h| h * h);
        let fit = recipe.fit();
        let [samples, directions] =
            [(fit.samples(), exponents[0]), (fit.directions(), exponents[1])].map(|(x, e)| f64::from(x).powf(-e));
        Measured { factors: [1.0, alpha, ratio, theta, phi, samples, directions], value: *error }
    }

    /// Measured error divided by the error that the current constants predict.
    fn over_current(&self) -> f64 {
        self.error / expectation(&self.recipe).error
    }
}

/// A recipe based on preset `draft`, with other nodes on each axis and another effort.
fn recipe(layout: Layout, nodes: [u32; 4], samples: u32, directions: u32) -> Result<Recipe, ltcforge::Error> {
    let builder = Recipe::builder().preset(Preset::Draft).layout(layout).samples(samples).directions(directions);
    let isotropic = layout.only_ranges().is_some();
    let axes = AXES.into_iter().zip(nodes).filter(|(axis, _)| !isotropic || matches!(*axis, "alpha" | "theta"));
    axes.fold(builder, |builder, (axis, nodes)| builder.resolution(axis, nodes)).build()
}

fn nodes_of(layout: Layout) -> Result<[u32; 4], ltcforge::Error> {
    let usual = Recipe::builder().layout(layout).build()?;
    let nodes = usual.resolution();
    Ok([nodes.alpha, nodes.ratio, nodes.theta, nodes.phi])
}

/// The extent of a study.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extent {
    /// Configurations at which each table is measured.
    pub points: usize,
    /// Factors on the default numbers of nodes. They apply to all axes together, and to one axis at a time.
    pub scales: &'static [f64],
    /// Samples and directions, in all combinations.
    pub efforts: [&'static [u32]; 2],
    /// Nodes of alpha and theta of isotropic tables.
    pub isotropic: &'static [[u32; 2]],
}

impl Extent {
    /// The full study. It takes some minutes on two cores.
    pub const WHOLE: Self = Self {
        points: 512,
        scales: &[0.4, 0.6, 0.8, 1.25, 1.6],
        efforts: [&[64, 128, 256, 512, 1024], &[4, 8, 16, 32]],
        isotropic: &[[12, 48], [24, 48], [48, 12], [48, 24], [16, 16], [32, 32], [64, 64]],
    };
    /// The study for tests. It takes some seconds.
    pub const SHORT: Self = Self { points: 96, scales: &[0.4, 0.6], efforts: [&[64, 192], &[4, 8]], isotropic: &[] };
}

/// The recipes of a layout with scaled nodes, on all axes and on one axis at a time. With `has_effort`, there are also
/// recipes with other efforts at the default nodes.
fn recipes(layout: Layout, extent: &Extent, has_effort: bool) -> Result<Vec<Recipe>, ltcforge::Error> {
    if layout.only_ranges().is_some() {
        let nodes = extent.isotropic.iter();
        return nodes.map(|[alpha, theta]| recipe(layout, [*alpha, 1, *theta, 1], 64, 8)).collect();
    }
    let (usual, [samples, directions]) = (nodes_of(layout)?, [192, 8]);
    let scaled = |n: u32, scale: f64| ((f64::from(n) * scale).round() as u32).max(2);
    let mut found = vec![recipe(layout, usual, samples, directions)?];
    for scale in extent.scales {
        found.push(recipe(layout, usual.map(|n| scaled(n, *scale)), samples, directions)?);
        for axis in 0..4 {
            let mut nodes = usual;
            nodes[axis] = scaled(nodes[axis], *scale);
            found.push(recipe(layout, nodes, samples, directions)?);
        }
    }
    let [all_samples, all_directions] = extent.efforts;
    for samples in all_samples.iter().filter(|_| has_effort) {
        for directions in all_directions {
            found.push(recipe(layout, usual, *samples, *directions)?);
        }
    }
    Ok(found)
}

/// Recipes that are not used in the search for a law.
fn held_out(layout: Layout) -> Result<Vec<Recipe>, ltcforge::Error> {
    if layout.only_ranges().is_some() {
        return [[20, 50], [50, 20]].map(|n| recipe(layout, [n[0], 1, n[1], 1], 96, 8)).into_iter().collect();
    }
    let tables = [([5, 4, 6, 5], 96, 8), ([8, 5, 7, 6], 320, 12), ([12, 5, 10, 6], 160, 24)];
    tables.map(|(nodes, samples, directions)| recipe(layout, nodes, samples, directions)).into_iter().collect()
}

fn measured(recipes: Vec<Recipe>, points: usize) -> Vec<Fitted> {
    recipes.into_iter().map(|recipe| Fitted::new(recipe, points)).collect()
}

fn tried([from, to, step]: [f64; 3]) -> impl Iterator<Item = f64> {
    (0..).map(move |i| from + step * f64::from(i)).take_while(move |x| *x < to + 0.5 * step)
}

/// The law of a layout with tables for several efforts.
///
/// # Panics
/// Never: the list of exponents is not empty.
fn with_exponents(tables: &[Fitted]) -> Law {
    let both = tried(SAMPLES_EXPONENT).flat_map(|s| tried(DIRECTIONS_EXPONENT).map(move |d| [s, d]));
    let laws = both.map(|exponents| {
        let measured: Vec<_> = tables.iter().map(|table| table.measured(exponents)).collect();
        let numbers = least_squares(&measured);
        (relative_error(&measured, &numbers), Law { numbers, exponents })
    });
    laws.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, law)| law).expect("exponents to try")
}

/// The law of another layout. Samples and directions have the same factors and exponents as in `law`.
fn with_effort_of(law: &Law, tables: &[Fitted]) -> Law {
    let rest = tables.iter().map(|table| {
        let Measured { factors, value } = table.measured(law.exponents);
        let [limit, alpha, ratio, theta, phi, samples, directions] = factors;
        let effort = samples * law.numbers[5] + directions * law.numbers[6];
        Measured { factors: [limit, alpha, ratio, theta, phi], value: (value - effort).max(1e-3) }
    });
    let [limit, alpha, ratio, theta, phi] = least_squares(&rest.collect::<Vec<_>>());
    Law { numbers: [limit, alpha, ratio, theta, phi, law.numbers[5], law.numbers[6]], exponents: law.exponents }
}

/// A law that the study found, and its test on held-out tables.
#[derive(Debug, Clone)]
pub struct Found {
    /// The layout.
    pub layout: Layout,
    /// The found constants.
    pub law: Law,
    /// Measured error divided by expected error for each held-out table: with the found constants, and with the
    /// constants in the sources.
    pub held_out: Vec<[f64; 2]>,
}

/// Finds the laws of some layouts.
///
/// # Errors
/// None, because all recipes are within bounds.
pub fn find(layouts: &[Layout], extent: &Extent, mut report: impl FnMut(&Found)) -> Result<(), ltcforge::Error> {
    let first = with_exponents(&measured(recipes(Layout::Reflected, extent, true)?, extent.points));
    for layout in layouts {
        let is_first = *layout == Layout::Reflected;
        let tables = if is_first { Vec::new() } else { measured(recipes(*layout, extent, false)?, extent.points) };
        let law = if is_first { first } else { with_effort_of(&first, &tables) };
        let tests = measured(held_out(*layout)?, extent.points);
        let ratio = |table: &Fitted| {
            let Measured { factors, value } = table.measured(law.exponents);
            [value / predicted(&factors, &law.numbers), table.over_current()]
        };
        report(&Found { layout: *layout, law, held_out: tests.iter().map(ratio).collect() });
    }
    Ok(())
}

/// The factor of a scattering or lobe model, found and current: the error of its table divided by the expected error of
/// LTCs for GGX.
fn factor(brdf: BrdfKind, lobe: LobeModel, points: usize) -> Result<[f64; 2], ltcforge::Error> {
    let layout = if brdf.follows_reflection() { Layout::Reflected } else { Layout::Kt2022 };
    let with = |brdf: BrdfKind, lobe: LobeModel, samples: u32, nodes: [u32; 4]| {
        let builder = Recipe::builder().preset(Preset::Draft).brdf(brdf).lobe(lobe).layout(layout).samples(samples);
        let isotropic = BrdfKind::is_isotropic(brdf);
        let axes = AXES.into_iter().zip(nodes).filter(|(axis, _)| !isotropic || matches!(*axis, "alpha" | "theta"));
        axes.fold(builder, |builder, (axis, nodes)| builder.resolution(axis, nodes)).build()
    };
    let tables = if brdf.is_isotropic() {
        [([8, 1, 8, 1], 64), ([12, 1, 16, 1], 96)]
    } else {
        [([5, 3, 5, 3], 64), ([7, 4, 7, 5], 96)]
    };
    let (mut measured, mut current) = (1.0, 1.0);
    for (nodes, samples) in tables {
        let recipe = with(brdf, lobe, samples, nodes)?;
        let expected = expectation(&recipe).error;
        // The same recipe for GGX. It has an isotropic range if the model is isotropic.
        let ggx = Recipe::builder().preset(Preset::Draft).layout(layout).samples(samples);
        let ggx = if brdf.is_isotropic() { ggx.isotropic() } else { ggx };
        let axes = AXES.into_iter().zip(nodes).filter(|(_, n)| *n > 1);
        let ggx = axes.fold(ggx, |builder, (axis, nodes)| builder.resolution(axis, nodes)).build()?;
        let of_ggx = expectation(&ggx).error;
        measured *= width_between(&fitted(&recipe), points).mean / of_ggx;
        current *= expected / of_ggx;
    }
    Ok([measured, current].map(f64::sqrt))
}

const REFLECTED: &str = include_str!("../../src/fit/layout/reflected.rs");
const KT2022: &str = include_str!("../../src/fit/layout/kt2022.rs");
const ISOTROPIC: &str = include_str!("../../src/fit/layout/isotropic.rs");
const EXPECTATION: &str = include_str!("../../src/fit/expectation.rs");

/// The layouts that have their own numbers. Layouts `inverse` and `matrix33` use those of `hdrp`.
const LAYOUTS: [Layout; 6] =
    [Layout::Reflected, Layout::Kt2022, Layout::Ltc2017, Layout::Ltc2016, Layout::Godot, Layout::Hdrp];

/// Calls `line_of` with the found and the current numbers, line by line, as written in the sources.
///
/// # Errors
/// The errors of [`find`].
pub fn lines(mut line_of: impl FnMut(String)) -> Result<(), ltcforge::Error> {
    let isotropic = || ISOTROPIC.lines().map(str::trim).filter(|line| line.contains("interpolation: ["));
    find(&LAYOUTS, &Extent::WHOLE, |Found { layout, law: Law { numbers, exponents }, held_out }| {
        let [limit, alpha, ratio, theta, phi, samples, directions] = numbers.map(|x| format!("{x:.3}"));
        if *layout == Layout::Reflected {
            let [of_samples, of_directions] = exponents.map(|exponent| format!("-{exponent:.1}"));
            line_of(format!("const SAMPLES: [f64; 2] = [{samples}, {of_samples}];"));
            line_of(format!("const DIRECTIONS: [f64; 2] = [{directions}, {of_directions}];"));
            for name in ["const SAMPLES", "const DIRECTIONS"] {
                line_of(format!("// current: {}", line(EXPECTATION, name).unwrap_or_default()));
            }
        }
        let of_source = |source| line(source, "Interpolation { limit").unwrap_or_default();
        let isotropic_index = LAYOUTS.iter().position(|item| item == layout).unwrap_or_default().saturating_sub(2);
        if layout.only_ranges().is_some() {
            line_of(format!("// {layout}\ninterpolation: [{limit}, {:.1}, {:.1}],", numbers[1], numbers[3]));
            line_of(format!("// current: {}", isotropic().nth(isotropic_index).unwrap_or_default()));
        } else {
            let step = format!("PerAxis {{ alpha: {alpha}, ratio: {ratio}, theta: {theta}, phi: {phi} }}");
            line_of(format!("// {layout}\nInterpolation {{ limit: {:.4}, step: {step} }}", numbers[0]));
            let source = if *layout == Layout::Reflected { REFLECTED } else { KT2022 };
            line_of(format!("// current: {}", of_source(source)));
        }
        let ratios: Vec<_> = held_out.iter().map(|[found, current]| format!("{found:.2} ({current:.2})")).collect();
        line_of(format!("// held out, measured over expected (by the current constants): {}", ratios.join(", ")));
    })?;
    line_of("\n| model | error over the error of LTCs of GGX: found | current |\n|---|---|---|".to_owned());
    let ltcs = BrdfKind::formulas().skip(1).map(|kind| (kind, LobeModel::Ltc));
    let gaussians = [LobeModel::Sg, LobeModel::Asg].map(|lobe| (BrdfKind::Ggx, lobe));
    for (brdf, lobe) in ltcs.chain(gaussians) {
        let [found, current] = factor(brdf, lobe, Extent::WHOLE.points)?;
        line_of(format!("| `{brdf}`, `{lobe}` | {found:.2} | {current:.2} |"));
    }
    Ok(())
}
