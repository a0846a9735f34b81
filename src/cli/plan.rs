//! `plan`: the recipe that a scene needs, within a budget.

use std::{
    ffi::OsStr,
    fs, io,
    path::{Path, PathBuf},
};

use clap::{ArgGroup, Args};
use serde_json::json;

use super::{
    AnyTable, CommandFailure, Context, Exit, Interrupt, TableFolder, Threads, check_output_folder, export,
    file_failure, fit, named, shown, tradeoff::processor_seconds, usage, write_in,
};
use ltcforge_files::{bounded::read_named, compact, digest::Digest, recipe_document::canonical_json};
use ltcforge_fit::{GoOn, Layout, Recipe, Table};
use ltcforge_plan::{
    Budget, Form, GpuLimit, Needs, Scene, SceneError, TablePlan, document, left_out, of_other_models,
    other_reflectances, outside, picture, words,
};
use ltcforge_textures::{About, CompactContainer, Engine, Export, TextureLayout};

/// `plan`.
#[derive(Debug, Args)]
#[command(group(ArgGroup::new("budget").args(["error", "bytes", "seconds"])))]
#[expect(clippy::struct_excessive_bools, reason = "a flag each")]
pub struct PlanArgs {
    /// Scene (`.glb`, `.gltf`) or list of materials (`.json`)
    pub scene: PathBuf,
    /// Table to check, with --check: a file, or the first digits of a digest
    #[arg(requires = "check")]
    pub table: Option<PathBuf>,
    /// Find the smallest table with at most this mean error on the scene
    #[arg(long, value_name = "E", value_parser = positive)]
    pub error: Option<f64>,
    /// Find the best table of at most this many bytes
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    pub bytes: Option<u64>,
    /// Find the best table that one core fits in this many seconds
    #[arg(long, value_name = "S", value_parser = positive)]
    pub seconds: Option<f64>,
    /// Plan for this engine; with --fit, write its files
    #[arg(long = "for", value_name = "ENGINE", value_parser = named(Engine::ALL, Engine::name))]
    pub engine: Option<Engine>,
    /// Allow uneven nodes; `shader --nodes TABLE` writes the shader for them
    #[arg(long, conflicts_with = "engine")]
    pub any_nodes: bool,
    /// Plan tables without amplitude and Fresnel term
    #[arg(long, conflicts_with = "engine")]
    pub no_terms: bool,
    /// Ship the compact form: --bytes counts it, and --fit writes it
    #[arg(long, conflicts_with_all = ["engine", "any_nodes"])]
    pub ship: bool,
    /// Maximum number of vector registers that the shader may use
    #[arg(long, value_name = "R", value_parser = clap::value_parser!(u32).range(1..))]
    pub registers: Option<u32>,
    /// Maximum number of instructions of the shader
    #[arg(long, value_name = "I", value_parser = clap::value_parser!(u32).range(1..))]
    pub instructions: Option<u32>,
    /// Folder for the recipe, `plan.json` and `plan.svg`
    #[arg(short, long, value_name = "DIR", default_value = ".")]
    pub out: PathBuf,
    /// Fit the table, measure it, and correct the plan once if needed
    #[arg(long)]
    pub fit: bool,
    /// Write nothing; exit with 3 if TABLE does not cover all materials
    #[arg(long, requires = "table", conflicts_with_all = ["budget", "engine", "fit", "ship"])]
    pub check: bool,
    /// The folder of tables.
    #[command(flatten)]
    pub folder: TableFolder,
    /// Threads.
    #[command(flatten)]
    pub threads: Threads,
}

/// A number above zero.
fn positive(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|number: &f64| number.is_finite() && *number > 0.0);
    number.ok_or_else(|| "use a number above 0".to_owned())
}

/// Maximum size of a list of materials.
const LIST_LIMIT_BYTES: u64 = 1 << 20;

/// Reads a scene, plans its tables and writes the plan. With `--fit`, also fits the tables.
pub(super) fn run(args: &PlanArgs, context: &mut Context<'_>) -> Result<Exit, CommandFailure> {
    let interrupt = context.interrupt.clone();
    let go_on = || !interrupt.is_set();
    let pool = args.threads.pool()?;
    let mut scene = pool.install(|| read(&args.scene, &go_on))?;
    if let Some(table) = &args.table {
        return check(&scene, &AnyTable::named(table, &args.folder)?, context);
    }
    check_output_folder(&args.out)?;
    let layout = args.engine.and_then(engine_layout);
    let gpu = GpuLimit { registers: args.registers, instructions: args.instructions };
    let form = Form { layout, any_nodes: args.any_nodes, no_terms: args.no_terms, ship: args.ship, gpu };
    let engine = args.engine.filter(|_| layout.is_some());
    if let Some(engine) = engine.filter(|_| Needs::of(&scene, true).is_some()) {
        scene.notes.push(format!(
            "sheen: files for {engine} hold one scattering model; plan without --for to get a table of sheen"
        ));
    }
    let budget = args.error.map(Budget::Error).or(args.bytes.map(Budget::Bytes));
    let budget = budget.or(args.seconds.map(Budget::Seconds)).unwrap_or(Budget::Knee);
    let mut plans = Vec::new();
    for (sheen, name) in [(false, "recipe"), (true, "recipe-sheen")] {
        // An engine reads tables of only one scattering model.
        let Some(needs) = Needs::of(&scene, sheen).filter(|_| !sheen || layout.is_none()) else { continue };
        let plan = pool.install(|| TablePlan::new(needs, budget, form, &go_on));
        plans.push((name, plan.map_err(|_| CommandFailure::interrupted())?));
    }
    if let Some(engine) = engine.filter(|_| plans.is_empty()) {
        let why = format!(
            "{}: all materials are sheen, which files for {engine} cannot hold: plan without --for",
            args.scene.display()
        );
        return Err(usage(why));
    }
    let mut tables = Vec::new();
    if args.fit {
        let draws = context.draws_progress;
        for (_, plan) in &mut plans {
            tables.push(pool.install(|| fitted(plan, draws, &interrupt))?);
        }
    }
    // Delete recipes of an earlier plan that this plan does not have.
    for name in ["recipe", "recipe-sheen"].iter().filter(|name| plans.iter().all(|(of, _)| of != *name)) {
        let path = args.out.join(format!("{name}.json"));
        if let Err(error) = fs::remove_file(&path)
            && error.kind() != io::ErrorKind::NotFound
        {
            return Err(file_failure(&path, &error));
        }
    }
    let mut files = Vec::new();
    let mut write = |name: &str, bytes: &[u8]| {
        files.push(shown(&write_in(&args.out, name, bytes)?));
        Ok::<_, CommandFailure>(())
    };
    for (name, plan) in &plans {
        write(&format!("{name}.json"), format!("{}\n", canonical_json(&plan.chosen.recipe)).as_bytes())?;
    }
    let is_met = plans.iter().all(|(_, plan)| plan.is_met);
    let plans: Vec<TablePlan<'_>> = plans.into_iter().map(|(_, plan)| plan).collect();
    let plan_json = document(&scene, &plans);
    write("plan.json", format!("{plan_json:#}\n").as_bytes())?;
    write("plan.svg", picture(&plans).as_bytes())?;
    let mut digests = Vec::new();
    for (table, plan) in tables.iter().zip(&plans) {
        digests.push(pool.install(|| write_table(args, &plan.chosen.recipe, table, &mut files))?);
    }
    let lines = words(&scene, &plans);
    let value = json!({ "files": files, "tables": digests, "met": is_met, "plan": plan_json });
    context.print(&value, &[lines, files].concat().join("\n"))?;
    Ok(if is_met { Exit::Ok } else { Exit::Failed })
}

/// Reads a scene file.
fn read(path: &Path, go_on: &GoOn<'_>) -> Result<Scene, CommandFailure> {
    let is_list =
        path.extension().and_then(OsStr::to_str).is_some_and(|extension| extension.eq_ignore_ascii_case("json"));
    let scene = if is_list {
        let bytes = read_named(path, LIST_LIMIT_BYTES).map_err(|error| file_failure(path, &error))?;
        Scene::from_list(&bytes)
    } else {
        Scene::open(path, go_on)
    };
    scene.map_err(|error| {
        if matches!(error, SceneError::Stopped) {
            return CommandFailure::interrupted();
        }
        let lines: Vec<String> = error.to_string().lines().map(|line| format!("{}: {line}", path.display())).collect();
        let exit = if matches!(error, SceneError::Open { .. }) { Exit::Failed } else { Exit::Usage };
        CommandFailure::new(exit, lines.join("\n"))
    })
}

/// The layout of an engine's tables; `None` for an engine that reads tables of any layout.
fn engine_layout(engine: Engine) -> Option<Layout> {
    let textures = engine.layout().and_then(|name| TextureLayout::named(name).ok());
    textures.map(|textures| textures.sampling().table)
}

/// Fits the table of a plan and measures it. If this changes the choice, does the same for the new choice.
fn fitted(plan: &mut TablePlan<'_>, draws_progress: bool, interrupt: &Interrupt) -> Result<Table, CommandFailure> {
    let timed = |recipe: &Recipe| {
        let started = processor_seconds();
        let table = fit::fit_alone(recipe, draws_progress, interrupt)?;
        Ok::<_, CommandFailure>((table, processor_seconds() - started))
    };
    let (whole, seconds) = timed(&plan.whole.recipe)?;
    plan.time_whole(seconds);
    let (mut table, mut seconds) = timed(&plan.chosen.recipe)?;
    plan.measure(&table, Some(&whole), Some(seconds));
    while !plan.is_measured() {
        (table, seconds) = timed(&plan.chosen.recipe)?;
        plan.measure(&table, None, Some(seconds));
    }
    Ok(table)
}

/// Writes a table and its manifest, and with `--for` an engine's files.
fn write_table(
    args: &PlanArgs,
    recipe: &Recipe,
    table: &Table,
    files: &mut Vec<String>,
) -> Result<Digest, CommandFailure> {
    let fit::Stored { digest, paths, .. } = fit::store(&args.out, recipe, table)?;
    files.extend(paths.iter().map(|path| shown(path)));
    // Sheen tables have no compact form.
    let shipped = args.ship && compact::check_lobes(table).is_ok();
    let compact = shipped.then_some(Export::Compact(CompactContainer::Bytes));
    if let Some(export) = args.engine.map(Export::Engine).or(compact) {
        let error = export::measured(table, Some(recipe));
        for file in export.bundle(table, About::of_table(digest, Some(recipe), error)).map_err(usage)?.files {
            files.push(shown(&write_in(&args.out, &file.path, &file.bytes)?));
        }
    }
    Ok(digest)
}

/// Lists the materials that a table does not cover.
fn check(scene: &Scene, of: &AnyTable, context: &mut Context<'_>) -> Result<Exit, CommandFailure> {
    let outside = outside(scene, &of.table);
    let line = |material: &ltcforge_plan::Outside| {
        let axes = material.axes.iter().map(|axis| {
            let ([low, high], [first, last]) = (axis.scene, axis.table);
            format!("{} {low:.4} to {high:.4}, table {first:.4} to {last:.4}", axis.axis)
        });
        format!("{}: {}", material.material, axes.collect::<Vec<_>>().join("; "))
    };
    let mut lines: Vec<String> = outside.iter().map(line).collect();
    if lines.is_empty() {
        lines.push("the table covers every lobe of its scattering model".to_owned());
    }
    let others = of_other_models(scene, &of.table);
    let other = |(material, kind): &(String, _)| {
        format!("{material}: {} needs a table of another scattering model", json!(kind).as_str().unwrap_or("lobe"))
    };
    let mut left: Vec<String> = others.iter().map(other).collect();
    left.extend(other_reflectances(scene, &of.table).map(|[found, fitted]| {
        let [found, fitted] = [found, fitted]
            .map(|[low, high]| if low == high { format!("{low:.2}") } else { format!("{low:.2} to {high:.2}") });
        format!("reflectance: the materials have F0 {found}; the table was fitted for {fitted}")
    }));
    left.extend(left_out(scene));
    let value = json!({ "table": of.digest, "outside": outside, "not_checked": left });
    lines.extend(left);
    context.print(&value, &lines.join("\n"))?;
    Ok(if outside.is_empty() { Exit::Ok } else { Exit::Mismatch })
}
