//! Measuring models of light for `tradeoff`: errors and bytes.

use super::{CommandFailure, failed};
use ltcforge_files::{container, recipe_document};
use ltcforge_fit::{Precision, Recipe, Spread, Table};
use ltcforge_light::{ClosedForm, LightModel, Lighting, NormalsRule, RandomLights, light_error};
use ltcforge_shaders::{COMPILER, GpuCost, LitBy, wgsl};
use ltcforge_view::{
    preview::{ShaderTable, TexelFormat},
    tradeoff::{LIGHTS, ModelRow, ModelRows},
};

/// A table that represents model `ltc` or fitted Gaussians.
pub(super) struct FittedTable {
    pub(super) recipe: Recipe,
    pub(super) table: Table,
    /// Processor time of the fit, divided by the number of threads.
    pub(super) fit_seconds: f64,
}

/// The random lights that measure tables and models, within the ranges of a family. Runs on the current rayon pool.
pub(super) fn lights(base: &Recipe) -> Result<RandomLights, CommandFailure> {
    RandomLights::draw(&base.brdf, &base.range, LIGHTS).map_err(failed)
}

/// The error of a model's light.
pub(super) fn error(model: Lighting<'_>, lights: &RandomLights) -> Result<Spread, CommandFailure> {
    light_error(model, lights).map_err(failed)
}

/// Measures the models with the same lights. Runs on the current rayon pool.
pub(super) fn measure(tables: &[FittedTable], lights: &RandomLights) -> Result<ModelRows, CommandFailure> {
    // Rules without a shader have no known costs.
    let has_shader = |form: &ClosedForm| form.chosen_rule().is_none_or(|rule| NormalsRule::SHADED.contains(&rule));
    let forms = LightModel::ALL.iter().flat_map(|model| model.closed_forms()).filter(has_shader);
    let by_table = tables.iter().map(|fitted| by_table(fitted, lights));
    let rows = by_table.chain(forms.map(|form| by_formula(form, lights))).collect::<Result<_, _>>()?;
    Ok(ModelRows { lights: lights.len(), mean_energy: lights.mean_energy(), compiler: COMPILER, rows })
}

fn by_table(fitted: &FittedTable, lights: &RandomLights) -> Result<ModelRow, CommandFailure> {
    let FittedTable { recipe, table, fit_seconds } = fitted;
    let file = container::encode(recipe, table).map_err(failed)?;
    let format = match recipe.precision {
        Precision::F32 => TexelFormat::F32,
        Precision::F16 => TexelFormat::F16,
    };
    let model = LightModel::of_lobe(table.lobe());
    let lit_by = LitBy::new(model, Some(recipe.layout)).map_err(failed)?;
    Ok(ModelRow {
        rule: None,
        layout: Some(recipe.layout),
        recipe_digest: Some(recipe_document::digest(recipe)),
        gpu_bytes: ShaderTable::new(table, format).gpu_bytes(),
        file_bytes: file.len() as u64,
        fit_seconds: *fit_seconds,
        ..row(lit_by, error(Lighting::by(table), lights)?)
    })
}

fn by_formula(form: ClosedForm, lights: &RandomLights) -> Result<ModelRow, CommandFailure> {
    let lit_by = LitBy::new(form.model(), None).and_then(|lit_by| lit_by.by_rule(form.chosen_rule()));
    let light_error = error(Lighting::ClosedForm(form), lights)?;
    Ok(ModelRow { rule: form.chosen_rule(), ..row(lit_by.map_err(failed)?, light_error) })
}

/// The row of a model without a table.
fn row(lit_by: LitBy, light_error: Spread) -> ModelRow {
    ModelRow {
        model: lit_by.model(),
        rule: None,
        layout: None,
        recipe_digest: None,
        light_error,
        gpu_cost: GpuCost::of(&lit_by.name()),
        gpu_bytes: 0,
        file_bytes: 0,
        shader_bytes: wgsl(lit_by).len() as u64,
        fit_seconds: 0.0,
    }
}
