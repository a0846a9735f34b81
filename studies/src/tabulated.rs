//! The error of a BRDF given as numbers: the table of docs/materials.md. The study tabulates GGX over azimuths and
//! ratios, because its truth is known. It compares tables fitted to the numbers and to the formula with the truth of
//! the formula.

use std::{fmt::Write as _, sync::Arc};

use ltcforge::{
    BrdfKind, BrdfModel, Digest, Error, Preset, Recipe, RecipeDocument as _,
    files::{
        recipe_document::{DEFAULT_ENTRY_LIMIT, parse_with},
        tabulated::encode,
    },
    fit::{Spread, Table, TabulatedAxes, TabulatedBrdf, TabulatedFile},
    light::{Lighting, RandomLights, light_error_by, truth_of},
};

use crate::{clock::Clock, markdown::short, tables::fitted};

/// The recipe of docs/materials.md.
const RECIPE: &str = include_str!("../../docs/recipes/tabulated-anisotropic.json");
/// The nodes of the command in docs/materials.md: roughnesses and ratios.
const ALPHA: [f64; 4] = [0.2, 0.4, 0.7, 1.0];
const RATIO: [f64; 3] = [0.4, 0.7, 1.0];
/// The numbers of polar angles, of azimuth differences on one side, and of view azimuths.
const ANGLES: [u16; 3] = [32, 17, 7];
/// Random rectangles, with random surfaces in the range of the file.
const LIGHTS: usize = 2000;
/// The tolerance of the truth, as in [`lights`](crate::lights).
const TOLERANCE: f64 = 1e-5;

/// The results of the study.
pub struct Found {
    /// Absolute errors of the energy against the truth of the formula: for the numbers, for their table, for the
    /// formula's table with the same nodes, and for the default table of the formula.
    pub errors: [Spread; 4],
    mean_energy: f64,
    lights: usize,
    /// The number of values in the file.
    pub values: usize,
    /// Size of the file in bytes.
    pub file_bytes: usize,
    entries: u64,
    /// Processor seconds of the fits to the numbers, and to the formula with the same nodes.
    seconds: [f64; 2],
}

/// Fits the tables with a preset, and measures them with a part of the lights.
///
/// # Errors
/// None, because the recipe fits the file.
///
/// # Panics
/// Never: GGX between these nodes is a BRDF.
pub fn find(preset: Preset, part: f64) -> Result<Found, Error> {
    let axes = TabulatedAxes::spread(ALPHA.to_vec(), ANGLES[0], ANGLES[1]).with_azimuths(RATIO.to_vec(), ANGLES[2]);
    let tabulated = TabulatedBrdf::tabulate(BrdfKind::Ggx, axes).expect("GGX between these nodes is a BRDF");
    let bytes = encode(&tabulated)?;
    let values = tabulated.values().len();
    let file = TabulatedFile::new(*Digest::of(&bytes).as_bytes(), Arc::new(tabulated));
    let numbers = BrdfModel::tabulated(file.clone());
    let document = RECIPE.replace(Preset::Paper.name(), preset.name());
    let recipe = parse_with(document.as_bytes(), DEFAULT_ENTRY_LIMIT, &|_| Ok(file.clone()))?;

    let timed = |recipe: &Recipe| {
        let clock = Clock::of_process();
        (fitted(recipe), clock.seconds())
    };
    let (of_numbers, slow) = timed(&recipe);
    let (of_formula, fast) = timed(&Recipe { brdf: BrdfKind::Ggx.into(), ..recipe.clone() });
    let default = fitted(&Recipe::builder().preset(preset).build()?);

    let count = ((LIGHTS as f64 * part) as usize).max(20);
    let lights = RandomLights::draw(&BrdfKind::Ggx.into(), &recipe.range(), count)?;
    let by_table = |table: &Table| light_error_by(|at, light| Lighting::by(table).reflected(at, light), &lights);
    Ok(Found {
        errors: [
            light_error_by(|at, light| truth_of(&numbers, TOLERANCE, at, light), &lights)?,
            by_table(&of_numbers)?,
            by_table(&of_formula)?,
            by_table(&default)?,
        ],
        mean_energy: lights.mean_energy(),
        lights: count,
        values,
        file_bytes: bytes.len(),
        entries: recipe.entries(),
        seconds: [slow, fast],
    })
}

impl Found {
    /// The table of docs/materials.md, and the seconds of the fits.
    #[must_use]
    pub fn text(&self) -> String {
        let names = [
            "the numbers themselves",
            "the table of the numbers",
            "the table of the formula on the same nodes",
            "the default table of `ggx`",
        ];
        let mut out = "| light by | mean error | p95 | largest |\n|---|---|---|---|\n".to_owned();
        // Writing to a String cannot fail.
        for (name, Spread { mean, p95, max }) in names.iter().zip(self.errors) {
            let _ = writeln!(out, "| {name} | {} | {} | {} |", short(mean, 2), short(p95, 2), short(max, 2));
        }
        let Self { mean_energy, lights, values, file_bytes, entries, seconds: [slow, fast], .. } = self;
        let _ = writeln!(out, "\n{lights} lights, mean energy {mean_energy:.3}");
        let _ = writeln!(out, "{} values, {} bytes", grouped(*values), grouped(*file_bytes));
        let _ =
            writeln!(out, "{entries} entries: {slow:.1} processor seconds for the numbers, {fast:.1} for the formula");
        out
    }
}

/// A whole number in groups of three digits.
#[must_use]
pub fn grouped(n: usize) -> String {
    let digits = n.to_string();
    let groups: Vec<&str> =
        (0..digits.len()).rev().step_by(3).rev().map(|end| &digits[end.saturating_sub(2)..=end]).collect();
    groups.join(",")
}
