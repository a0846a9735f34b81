//! The models that light a surface, each with its error and its costs.

use serde::Serialize;

use ltcforge_files::{digest::Digest, recipe_document::Preset};
use ltcforge_fit::{FitSettings, Layout, LobeModel, Recipe, Spread, StoredTerms};
use ltcforge_light::{LightModel, normals::NormalsRule};
use ltcforge_shaders::GpuCost;

/// The number of random lights with which all models are measured.
pub const LIGHTS: usize = 2048;

/// A model that lights a surface, with its costs and its error.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ModelRow {
    /// The model.
    pub model: LightModel,
    /// The rule of model `normals`.
    pub rule: Option<NormalsRule>,
    /// The layout of the model's table, if it uses a table. Gaussians can use a table or a closed form.
    pub layout: Option<Layout>,
    /// The recipe of the model's table. For model `ltc`, the recipe is from the family.
    pub recipe_digest: Option<Digest>,
    /// Absolute error of the reflected energy of random lights.
    pub light_error: Spread,
    /// The cost of the model's shader on a GPU.
    pub gpu_cost: Option<GpuCost>,
    /// Bytes that the shader reads from GPU memory.
    pub gpu_bytes: u64,
    /// Bytes of the file that ships with a renderer.
    pub file_bytes: u64,
    /// Bytes of the shader in WGSL.
    pub shader_bytes: u64,
    /// Processor time of the fit divided by the number of threads.
    pub fit_seconds: f64,
}

/// All models, and the conditions of the measurement.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ModelRows {
    /// The number of random lights, [`LIGHTS`].
    pub lights: usize,
    /// The mean reflected energy of these lights.
    pub mean_energy: f64,
    /// The compiler that reports the cost of shaders, [`COMPILER`](ltcforge_shaders::COMPILER).
    pub compiler: &'static str,
    /// The models.
    pub rows: Vec<ModelRow>,
}

impl ModelRow {
    /// The model's name in pictures. It includes the layout or the rule, if there is one.
    #[must_use]
    pub fn name(&self) -> String {
        match self.layout.map(Layout::name).or(self.rule.map(NormalsRule::name)) {
            Some(kind) => format!("{} {kind}", self.model),
            None => self.model.name().to_owned(),
        }
    }
}

impl ModelRows {
    /// The models as a text table, with one line for each model.
    #[must_use]
    pub fn text(&self) -> String {
        let heads = ["error", "p95", "registers", "instructions", "GPU bytes", "file bytes", "WGSL bytes", "seconds"];
        let mut out = line("model", heads.map(str::to_owned));
        for row in &self.rows {
            let cost = |of: fn(GpuCost) -> u32| row.gpu_cost.map_or_else(String::new, |cost| of(cost).to_string());
            let cells = [
                format!("{:.5}", row.light_error.mean),
                format!("{:.5}", row.light_error.p95),
                cost(|cost| cost.registers),
                cost(|cost| cost.instructions),
                row.gpu_bytes.to_string(),
                row.file_bytes.to_string(),
                row.shader_bytes.to_string(),
                format!("{:.2}", row.fit_seconds),
            ];
            out += &line(&row.name(), cells);
        }
        let Self { lights, mean_energy, compiler, .. } = self;
        out + &format!(
            "{lights} lights of mean energy {mean_energy:.3}; registers and instructions per rectangle: {compiler}"
        )
    }
}

fn line(name: &str, cells: [String; 8]) -> String {
    format!("{name:22}{}\n", cells.map(|cell| format!("{cell:>13}")).concat())
}

/// Whether a recipe's table represents model `ltc`: it has the base's resolution and precision, and the effort of
/// preset `paper`. A family has such a table for the base's layout, and a full family has one for each of its layouts.
#[must_use]
pub fn represents_ltc(base: &Recipe, recipe: &Recipe) -> bool {
    let effort = |fit: &FitSettings| (fit.samples, fit.directions, fit.steps);
    let is_paper = effort(&recipe.fit) == effort(&Preset::Paper.fit());
    is_paper && (recipe.resolution, recipe.precision) == (base.resolution, base.precision)
}

/// The recipes for tables of Gaussians. Each is `base` with the effort of preset `paper` and a Gaussian lobe model that
/// the layout can store.
#[must_use]
pub fn fitted_gaussians(base: &Recipe) -> Vec<Recipe> {
    let lobes = LobeModel::ALL.iter().filter(|lobe| lobe.gaussian().is_some() && base.layout.stores(**lobe));
    let fit = |lobe: &LobeModel| Recipe {
        lobe: *lobe,
        fit: FitSettings { seed: base.fit.seed, ..Preset::Paper.fit() },
        terms: StoredTerms::Schlick,
        ..base.clone()
    };
    lobes.map(fit).collect()
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::tradeoff::{Size, family};
    use ltcforge_files::recipe_document::{DEFAULT_ENTRY_LIMIT, parse};
    use ltcforge_shaders::COMPILER;

    #[test]
    fn a_family_has_a_table_for_the_base_and_a_full_family_for_each_layout() {
        for document in [r#"{"preset":"draft","precision":"f16"}"#, r#"{"layout":"kt2022"}"#] {
            let base = parse(document.as_bytes(), DEFAULT_ENTRY_LIMIT).expect("a recipe");
            let layouts = |size| -> Vec<Layout> {
                let recipes = family(&base, size, DEFAULT_ENTRY_LIMIT);
                recipes.iter().filter(|recipe| represents_ltc(&base, recipe)).map(|recipe| recipe.layout).collect()
            };
            assert_eq!(layouts(Size::Quick), [base.layout]);
            let any_range = Layout::ALL.iter().filter(|of| of.only_ranges().is_none() && !of.is_of_materials());
            assert_eq!(layouts(Size::Full).len(), any_range.count());
            assert_eq!(layouts(Size::Full)[0], base.layout);
        }
    }

    #[test]
    fn gaussians_are_fitted_in_the_layouts_that_store_them() {
        let lobes = |document: &str| -> Vec<LobeModel> {
            let base = parse(document.as_bytes(), DEFAULT_ENTRY_LIMIT).expect("a recipe");
            fitted_gaussians(&base).iter().map(|recipe| recipe.lobe).collect()
        };
        assert_eq!(lobes(r#"{"preset":"draft","terms":false}"#), [LobeModel::Sg, LobeModel::Asg]);
        assert_eq!(lobes(r#"{"layout":"ltc2017"}"#), []);
    }

    pub(crate) fn rows() -> ModelRows {
        let row = |model, rule, layout, mean: f64, bytes| ModelRow {
            model,
            rule,
            layout,
            recipe_digest: layout.map(|_| Digest::of(b"")),
            light_error: Spread { mean, p95: 4.0 * mean, max: 20.0 * mean },
            gpu_cost: Some(GpuCost {
                registers: 40 + (0.02 / mean) as u32,
                instructions: (1.0 / mean) as u32,
                inverse_throughput: (2.0 / mean) as u32,
            }),
            gpu_bytes: bytes,
            file_bytes: bytes,
            shader_bytes: 20_000,
            fit_seconds: if bytes > 0 { 4.5 } else { 0.0 },
        };
        let normals = |rule, mean| row(LightModel::Normals, Some(rule), None, mean, 0);
        let rows = vec![
            row(LightModel::Ltc, None, Some(Layout::Reflected), 0.0061, 181_440),
            normals(NormalsRule::Balanced, 0.0009),
            normals(NormalsRule::Fast, 0.004),
            normals(NormalsRule::Fine, 0.0005),
            row(LightModel::Sg, None, None, 0.06, 0),
            row(LightModel::Asg, None, None, 0.03, 0),
            row(LightModel::Asg, None, Some(Layout::Reflected), 0.02, 181_440),
        ];
        ModelRows { lights: LIGHTS, mean_energy: 0.3, compiler: COMPILER, rows }
    }

    #[test]
    fn the_text_has_a_line_for_each_model() {
        let text = rows().text();
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines.len(), 1 + 7 + 1, "{text}");
        let names =
            ["ltc reflected", "normals balanced", "normals fast", "normals fine", "sg ", "asg ", "asg reflected"];
        for (line, name) in lines[1..].iter().zip(names) {
            assert!(line.starts_with(name), "{line}");
            assert_eq!(line.len(), lines[0].len(), "{line}");
        }
        assert!(lines[1].contains(" 181440 ") && lines[2].contains(" 0 "), "{text}");
        assert!(lines[8].ends_with(COMPILER), "{text}");
    }
}
