//! Measuring models of light for `tradeoff`: errors, times of frames, bytes.

use std::{sync::Arc, time::Instant};

use serde_json::json;

use super::{CommandFailure, Exit, Interrupt};
use ltcforge_files::{
    container::{self, TableFileError},
    recipe_document::{self, DEFAULT_ENTRY_LIMIT, Preset},
};
use ltcforge_fit::{Configuration, Layout, Precision, Recipe, Spread, Table};
use ltcforge_light::{
    ClosedForm, LightError, LightModel, Lighting, NormalsRule, PolygonLight, RandomLights, ReflectedLight,
    engines::EngineWay, light_error, light_error_by,
};
use ltcforge_shaders::{COMPILER, GpuCost, LitBy, wgsl};
use ltcforge_view::{
    preview::{Adapter, Material, Preview, PreviewError, Scene, ShaderTable, TexelFormat},
    tradeoff::{EngineRow, FRAME_SIZE, GPU_FRAME_SIZE, LIGHTS, ModelRow, ModelRows, Size, median},
};

/// A table that stands for model `ltc`, or for fitted Gaussians.
pub(super) struct FittedTable {
    pub(super) recipe: Recipe,
    pub(super) table: Table,
    /// Processor time of the fit over the number of threads.
    pub(super) fit_seconds: f64,
}

/// A model, and the scene and table that it renders.
struct Candidate {
    scene: Scene,
    table: Arc<ShaderTable>,
    row: ModelRow,
}

/// The lights by which tables and models are measured, within the ranges of a family. Runs on the current rayon pool.
pub(super) fn lights(base: &Recipe) -> Result<RandomLights, CommandFailure> {
    RandomLights::draw(&base.brdf, &base.range, LIGHTS).map_err(|error| no_light(&error))
}

/// The error of a model's light.
pub(super) fn error(model: Lighting<'_>, lights: &RandomLights) -> Result<Spread, CommandFailure> {
    light_error(model, lights).map_err(|error| no_light(&error))
}

/// The models, each by the same lights and the same scene. Runs on the current rayon pool.
pub(super) fn measure(
    tables: &[FittedTable],
    of_engines: &[(Recipe, Table)],
    lights: &RandomLights,
    size: Size,
    interrupt: &Interrupt,
) -> Result<ModelRows, CommandFailure> {
    let mut preview = Preview::new(Adapter::Any);
    let is_software = preview.is_software().map_err(|error| failure(&error))?;
    let frame_size = if is_software { FRAME_SIZE } else { GPU_FRAME_SIZE };
    let mut candidates = Vec::new();
    for fitted in tables {
        candidates.push(by_table(fitted, lights)?);
    }
    let none = Arc::new(ShaderTable::none());
    // Rules without a shader have no frame.
    let has_shader = |form: &ClosedForm| form.chosen_rule().is_none_or(|rule| NormalsRule::SHADED.contains(&rule));
    for form in LightModel::ALL.iter().flat_map(|model| model.closed_forms()).filter(has_shader) {
        candidates.push(by_formula(form, &none, lights)?);
    }

    for candidate in &mut candidates {
        candidate.scene.size = frame_size;
    }
    let times = frame_times(&mut preview, &candidates, rounds(size), interrupt)?;
    let rows = candidates
        .into_iter()
        .zip(times)
        .map(|(candidate, times)| ModelRow { frame_milliseconds: median(times), ..candidate.row });
    Ok(ModelRows {
        lights: lights.len(),
        mean_energy: lights.mean_energy(),
        frame_size,
        adapter: preview.adapter_name().map_err(|error| failure(&error))?,
        compiler: COMPILER,
        rows: rows.collect(),
        engines: engines(of_engines, lights)?,
    })
}

/// The recipes of the tables by which engines light: the whole domain, as engines have it.
pub(super) fn engine_recipes(size: Size) -> Result<Vec<Recipe>, CommandFailure> {
    let preset = match size {
        Size::Quick => Preset::Draft,
        Size::Full => Preset::Paper,
    };
    let is_theirs = |layout: &&Layout| EngineWay::ALL.iter().any(|way| way.layout() == Some(**layout));
    let recipe = |layout: &Layout| {
        let document = json!({ "preset": preset.name(), "layout": layout }).to_string();
        recipe_document::parse(document.as_bytes(), DEFAULT_ENTRY_LIMIT)
            .map_err(|error| CommandFailure::new(Exit::Failed, error.to_string()))
    };
    Layout::ALL.iter().filter(is_theirs).map(recipe).collect()
}

/// Engines' ways, by tables of [`engine_recipes`].
fn engines(tables: &[(Recipe, Table)], lights: &RandomLights) -> Result<Vec<EngineRow>, CommandFailure> {
    let row = |way: &EngineWay| {
        let own = tables.iter().find(|(recipe, _)| Some(recipe.layout) == way.layout());
        let table = own.map(|(_, table)| table);
        let reflected = |at: &Configuration, light: &PolygonLight| {
            Ok(ReflectedLight { energy: way.reflected(table, at, light)?, fresnel: 0.0 })
        };
        Ok(EngineRow {
            way: *way,
            recipe_digest: own.map(|(recipe, _)| recipe_document::digest(recipe)),
            light_error: light_error_by(reflected, lights).map_err(|error| no_light(&error))?,
            gpu_cost: GpuCost::of(way.name()),
        })
    };
    EngineWay::ALL.iter().map(row).collect()
}

fn rounds(size: Size) -> usize {
    match size {
        Size::Quick => 5,
        Size::Full => 21,
    }
}

fn scene(model: LightModel, rule: NormalsRule) -> Scene {
    let materials = vec![Material { alpha_x: 0.3, alpha_y: 0.08, rotation: 0.4 }];
    Scene { materials, model, rule, ..Scene::default() }
}

fn by_table(fitted: &FittedTable, lights: &RandomLights) -> Result<Candidate, CommandFailure> {
    let FittedTable { recipe, table, fit_seconds } = fitted;
    let failed = |error: TableFileError| CommandFailure::new(Exit::Failed, error.to_string());
    let file = container::encode(recipe, table).map_err(failed)?;
    let format = match recipe.precision {
        Precision::F32 => TexelFormat::F32,
        Precision::F16 => TexelFormat::F16,
    };
    let shader_table = Arc::new(ShaderTable::new(table, format));
    let lit_by = lit_by(LightModel::of_lobe(table.lobe()), Some(recipe.layout))?;
    let row = ModelRow {
        model: lit_by.model(),
        rule: None,
        layout: Some(recipe.layout),
        recipe_digest: Some(recipe_document::digest(recipe)),
        light_error: error(Lighting::by(table), lights)?,
        gpu_cost: GpuCost::of(&lit_by.name()),
        frame_milliseconds: 0.0,
        gpu_bytes: shader_table.gpu_bytes(),
        file_bytes: file.len() as u64,
        shader_bytes: wgsl(lit_by).len() as u64,
        fit_seconds: *fit_seconds,
    };
    Ok(Candidate { scene: scene(LightModel::Ltc, NormalsRule::Balanced), table: shader_table, row })
}

fn by_formula(form: ClosedForm, none: &Arc<ShaderTable>, lights: &RandomLights) -> Result<Candidate, CommandFailure> {
    let by_rule = lit_by(form.model(), None)?
        .by_rule(form.chosen_rule())
        .map_err(|error| CommandFailure::new(Exit::Failed, error.to_string()))?;
    let row = ModelRow {
        model: form.model(),
        rule: form.chosen_rule(),
        layout: None,
        recipe_digest: None,
        light_error: error(Lighting::ClosedForm(form), lights)?,
        gpu_cost: GpuCost::of(&by_rule.name()),
        frame_milliseconds: 0.0,
        gpu_bytes: 0,
        file_bytes: 0,
        shader_bytes: wgsl(by_rule).len() as u64,
        fit_seconds: 0.0,
    };
    Ok(Candidate { scene: scene(form.model(), form.rule()), table: Arc::clone(none), row })
}

fn lit_by(model: LightModel, layout: Option<Layout>) -> Result<LitBy, CommandFailure> {
    LitBy::new(model, layout).map_err(|error| CommandFailure::new(Exit::Failed, error.to_string()))
}

/// Milliseconds of each candidate's frames. The candidates alternate, so that a busy machine slows all of them. A frame
/// that is not timed comes before each timed one and loads the table.
fn frame_times(
    preview: &mut Preview,
    candidates: &[Candidate],
    rounds: usize,
    interrupt: &Interrupt,
) -> Result<Vec<Vec<f64>>, CommandFailure> {
    let mut frame = |candidate: &Candidate| {
        let started = Instant::now();
        match preview.render(&candidate.table, &candidate.scene, &|| interrupt.is_set()) {
            Ok(_) => Ok(1e3 * started.elapsed().as_secs_f64()),
            Err(PreviewError::Stopped) => Err(CommandFailure::interrupted()),
            Err(error) => Err(failure(&error)),
        }
    };
    let mut times = vec![Vec::with_capacity(rounds); candidates.len()];
    for _ in 0..rounds {
        for (times, candidate) in times.iter_mut().zip(candidates) {
            frame(candidate)?;
            times.push(frame(candidate)?);
        }
    }
    Ok(times)
}

fn no_light(error: &LightError) -> CommandFailure {
    CommandFailure::new(Exit::Failed, error.to_string())
}

fn failure(error: &PreviewError) -> CommandFailure {
    CommandFailure::new(Exit::Failed, error.to_string())
}
