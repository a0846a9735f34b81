//! `plan`: the recipe that a scene needs, within a budget.

use std::{
    ffi::OsStr,
    fs, io,
    path::{Path, PathBuf},
};

use clap::{ArgGroup, Args};
use serde_json::{Value, json};

use super::{
    AnyTable, CommandFailure, Context, Exit, Interrupt, TableFolder, Threads, check_output_folder,
    csv::BYTE_ORDER_MARK, export, file_failure, fit, light_case::CaseFormat, named, shown, usage, write_in,
};
use ltcforge_files::{
    bounded::read_named,
    compact,
    digest::Digest,
    recipe_document::{canonical_json, digest as digest_of},
};
use ltcforge_fit::{BrdfKind, GoOn, Recipe, Table};
use ltcforge_light::LightShape;
use ltcforge_plan::{
    Budget, Figure, Form, GpuLimit, Needs, Scene, SceneError, SceneLight, TablePlan, check as figures_of, document,
    left_out, of_other_models, words,
};
use ltcforge_textures::{About, CompactContainer, Engine, Export};
use ltcforge_view::plan::plan_picture;

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
    /// Find the smallest table with this mean error; limit of --check
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
    /// Fit the table, measure it, and correct the plan if needed
    #[arg(long)]
    pub fit: bool,
    /// Replace the scene's area lights with those in FILE (CSV)
    #[arg(long, value_name = "FILE")]
    pub lights: Option<PathBuf>,
    /// Exit with 3 if an error exceeds --error (default: 1.5x its plan)
    #[arg(long, requires = "table", conflicts_with_all = ["bytes", "seconds", "engine", "fit", "ship"])]
    pub check: bool,
    /// Also print nodes and registers
    #[arg(short, long)]
    pub verbose: bool,
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

/// A table may have this factor of the error that its plan stated, before `--check` fails.
const MOST_GROWN: f64 = 1.5;
/// Maximum size of a `plan.json`.
const PLAN_LIMIT_BYTES: u64 = 64 << 20;
/// Maximum number of lights in a file.
const MOST_LIGHTS: usize = 32;
/// Maximum size of a list of materials, and of a file of lights.
const LIST_LIMIT_BYTES: u64 = 1 << 20;

/// Reads a scene, plans its tables and writes the plan. With `--fit`, also fits the tables.
pub(super) fn run(args: &PlanArgs, context: &mut Context<'_>) -> Result<Exit, CommandFailure> {
    let interrupt = context.interrupt.clone();
    let go_on = || !interrupt.is_set();
    let pool = args.threads.pool()?;
    let lights = args.lights.as_deref().map(lights).transpose()?.unwrap_or_default();
    let mut scene = pool.install(|| read(&args.scene, lights, &go_on))?;
    if let Some(table) = &args.table {
        let table = AnyTable::named(table, &args.folder)?;
        return check(&scene, &table, (args, &pool), context);
    }
    check_output_folder(&args.out)?;
    let gpu = GpuLimit { registers: args.registers, instructions: args.instructions };
    let form = Form {
        any_nodes: args.any_nodes,
        no_terms: args.no_terms,
        ship: args.ship,
        gpu,
        ..Form::of_engine(args.engine)
    };
    let layout = form.layout;
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
    write("plan.svg", plan_picture(&plan_json).as_bytes())?;
    let mut digests = Vec::new();
    for (table, plan) in tables.iter().zip(&plans) {
        digests.push(pool.install(|| write_table(args, &plan.chosen.recipe, table, &mut files))?);
    }
    let mut lines = words(&scene, &plans, args.verbose);
    lines.push(next_command(args, plans.first()));
    let value = json!({ "files": files, "tables": digests, "met": is_met, "plan": plan_json });
    context.print(&value, &[lines, files].concat().join("\n"))?;
    Ok(if is_met { Exit::Ok } else { Exit::Failed })
}

/// Reads a scene file.
fn read(path: &Path, lights: Vec<SceneLight>, go_on: &GoOn<'_>) -> Result<Scene, CommandFailure> {
    let is_list =
        path.extension().and_then(OsStr::to_str).is_some_and(|extension| extension.eq_ignore_ascii_case("json"));
    let scene = if is_list {
        let bytes = read_named(path, LIST_LIMIT_BYTES).map_err(|error| file_failure(path, &error))?;
        Scene::from_list(&bytes).map(|mut scene| {
            scene.lights = lights;
            scene
        })
    } else {
        Scene::open(path, lights, go_on)
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

/// Reads lights of one shape. Their surfaces and views are ignored, because the scene has its own.
fn lights(path: &Path) -> Result<Vec<SceneLight>, CommandFailure> {
    let bytes = read_named(path, LIST_LIMIT_BYTES).map_err(|error| file_failure(path, &error))?;
    let text = str::from_utf8(&bytes).map_err(|_| usage(format!("{}: the file is not UTF-8", path.display())))?;
    let text = text.trim_start_matches(BYTE_ORDER_MARK);
    let of_shape = |shape: &LightShape| CaseFormat { shape: *shape, material: None };
    let is_of_shape = |shape: &&LightShape| text.lines().next().is_some_and(|line| of_shape(shape).is_header(line));
    let format = of_shape(LightShape::ALL.iter().find(is_of_shape).unwrap_or(&LightShape::Polygon));
    let mut lights = Vec::new();
    for (index, line) in text.lines().enumerate().filter(|(_, line)| !format.is_header(line)) {
        let number = index + 1;
        let placed = format.placed(line).map_err(|why| usage(format!("{}, line {number}: {why}", path.display())))?;
        let name = format!("line {number} of {}", path.display());
        let light = |(_, shape)| SceneLight::new(name, vec![shape], [1.0; 3]);
        lights.extend(placed.map(light));
    }
    if lights.is_empty() || lights.len() > MOST_LIGHTS {
        return Err(usage(format!("{}: {} lights; use 1 to {MOST_LIGHTS}", path.display(), lights.len())));
    }
    Ok(lights)
}

/// Fits the table of a plan and measures it. If this changes the choice, does the same for the new choice.
fn fitted(plan: &mut TablePlan<'_>, draws_progress: bool, interrupt: &Interrupt) -> Result<Table, CommandFailure> {
    let fit = |recipe: &Recipe| fit::fit_alone(recipe, draws_progress, interrupt);
    let whole = fit(&plan.whole.recipe)?;
    let mut table = fit(&plan.chosen.recipe)?;
    plan.measure(&table, Some(&whole));
    while plan.measured().is_none() {
        table = fit(&plan.chosen.recipe)?;
        plan.measure(&table, None);
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
    if let Some(export) = Form::of_engine(args.engine).engine.map(Export::Engine).or(compact) {
        let error = export::measured(table, Some(recipe));
        for file in export.bundle(table, About::of_table(digest, Some(recipe), error)).map_err(usage)?.files {
            // A scene may have a table of each scattering model.
            let folder = if recipe.brdf() == BrdfKind::Ggx { args.out.clone() } else { args.out.join("sheen") };
            files.push(shown(&write_in(&folder, &file.path, &file.bytes)?));
        }
    }
    Ok(digest)
}

/// The command that a user runs after this one.
fn next_command(args: &PlanArgs, plan: Option<&TablePlan<'_>>) -> String {
    let (scene, out) = (args.scene.display(), args.out.display());
    if let Some((form, _)) = plan.and_then(TablePlan::form_first) {
        let rule = form.rule.map_or_else(String::new, |rule| format!(" --rule {rule}"));
        let table = if args.fit { "" } else { "; for the table, add --fit to this command" };
        return format!("next: ltcforge shader --model {}{rule} --language glsl -o light.glsl{table}", form.model);
    }
    let shader = plan.map_or_else(String::new, |plan| {
        let recipe = &plan.chosen.recipe;
        let lobes = if recipe.brdf.fresnel().second().is_some() { " --two-lobes" } else { "" };
        let nodes = if args.any_nodes { " --nodes TABLE" } else { "" };
        format!(" --layout {}{lobes}{nodes}", recipe.layout)
    });
    let lights = args.lights.as_ref().map_or_else(String::new, |lights| format!(" --lights {}", lights.display()));
    match (args.fit, args.engine) {
        (false, _) => format!("next: ltcforge lock NAME --plan {out}, or fit the table: add --fit to this command"),
        (true, Some(engine)) if engine.layout().is_some() => format!("next: copy the files below into {engine}"),
        (true, _) => format!(
            "next: ltcforge shader{shader} --language glsl; in CI: ltcforge plan {scene}{lights} TABLE --check -o {out}"
        ),
    }
}

/// The largest error of a lobe that the plan of a table stated: in `plan.json` next to the table, or in the folder of
/// `--out`.
fn promised(scene: &Scene, args: &PlanArgs, of: &AnyTable) -> Option<f64> {
    let unit = if scene.lights.is_empty() { "lobe" } else { "light" };
    let recipe = digest_of(of.origin.recipe()?).to_string();
    let beside = of.path.parent().map(Path::to_path_buf);
    [beside, Some(args.out.clone())].into_iter().flatten().find_map(|folder| {
        let plan = read_named(&folder.join("plan.json"), PLAN_LIMIT_BYTES).ok()?;
        let plan: Value = serde_json::from_slice(&plan).ok()?;
        let tables = plan["tables"].as_array()?.iter();
        let is_own = |table: &&Value| table["recipe_digest"] == json!(recipe) && table["error_of"] == json!(unit);
        tables.filter(is_own).find_map(|table| table["worst"].as_f64())
    })
}

/// Predicts a table's error on each material, and lists the materials on which it is too large.
fn check(
    scene: &Scene,
    of: &AnyTable,
    (args, pool): (&PlanArgs, &rayon::ThreadPool),
    context: &mut Context<'_>,
) -> Result<Exit, CommandFailure> {
    let most = match args.error.or_else(|| Some(MOST_GROWN * promised(scene, args, of)?)) {
        Some(most) => most,
        None => MOST_GROWN * pool.install(|| own_worst(scene, of))?,
    };
    let figures = pool.install(|| figures_of(scene, &of.table)).unwrap_or_default();
    let above = figures.iter().filter(|figure| figure.error > most).count();
    let line = |figure: &Figure| {
        let (name, error) = (figure.name(scene), figure.error);
        let word = if error > most { "above" } else { "the largest, within the limit" };
        let of = if scene.lights.is_empty() { "the lobe's width" } else { "the light" };
        format!("{name}: error {error:.4} of {of}, {word} {most:.4}")
    };
    let mut lines: Vec<String> = figures.iter().take(above.max(1)).map(line).collect();
    let other = |(material, kind): &(String, _)| {
        format!("{material}: {} needs a table of another scattering model", json!(kind).as_str().unwrap_or("lobe"))
    };
    let mut left: Vec<String> = of_other_models(scene, &of.table).iter().map(other).collect();
    left.extend(left_out(scene));
    let value = json!({ "table": of.digest, "most": most, "errors": figures, "not_checked": left });
    lines.extend(left);
    if above > 0 {
        let lights = args.lights.as_ref().map_or_else(String::new, |lights| format!(" --lights {}", lights.display()));
        lines.push(format!("next: ltcforge plan {}{lights} -o {}", args.scene.display(), args.out.display()));
    }
    context.print(&value, &lines.join("\n"))?;
    Ok(if above == 0 { Exit::Ok } else { Exit::Mismatch })
}

/// The largest error of a lobe in a plan of the scene with the bytes of a table.
fn own_worst(scene: &Scene, of: &AnyTable) -> Result<f64, CommandFailure> {
    let Some(needs) = Needs::of(scene, of.table.brdf() != BrdfKind::Ggx) else { return Ok(0.0) };
    let second = of.table.second_matrices().map_or(0, <[_]>::len);
    let numbers =
        9 * (of.table.matrices().len() + second) + of.table.terms().map_or(0, |terms| 2 * terms.amplitude().len());
    let form = Form { no_terms: of.table.terms().is_none(), ..Form::default() };
    let plan = TablePlan::new(needs, Budget::Bytes(2 * numbers as u64), form, &|| true);
    let plan = plan.map_err(|_| CommandFailure::interrupted())?;
    Ok(plan.figures.iter().map(|figure| figure.error).fold(0.0, f64::max))
}
