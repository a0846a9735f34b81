//! `tradeoff`: measures accuracy against fitting time and size.

use std::{
    fmt::Write as _,
    path::{Path, PathBuf},
    time::Instant,
};

use clap::Args;
use indicatif::ProgressBar;
use serde_json::json;

use super::{
    CommandFailure, Context, Exit, Interrupt, Threads, check_output_folder, fit, input, progress, shown, tabulated,
    tradeoff_models, usage, write_in,
};
use ltcforge_files::{compact, recipe_document::DEFAULT_ENTRY_LIMIT};
use ltcforge_fit::{BrdfKind, Plan, Recipe, Table, report};
use ltcforge_light::{LightModel, Lighting, RandomLights};
use ltcforge_view::tradeoff::{
    FittedRecipe, Measurement, POINTS, Size, csv, family, fitted_gaussians, json as rows_json, off_by, picture,
    represents_ltc, rows,
};

/// `tradeoff`.
#[derive(Debug, Args)]
pub struct TradeoffArgs {
    /// Recipe to vary: a file, `-`, or a preset's name [default: paper]
    ///
    /// The family of recipes shares its ranges, terms, seed and solver, and varies layout, resolution and precision
    #[arg(long, value_name = "RECIPE")]
    pub recipe: Option<PathBuf>,
    /// Fit only the presets and a few recipes around them
    #[arg(long)]
    pub quick: bool,
    /// Folder for `tradeoff.csv`, `tradeoff.json` and `tradeoff.svg`
    #[arg(short, long, value_name = "DIR", default_value = ".")]
    pub out: PathBuf,
    /// Threads.
    #[command(flatten)]
    pub threads: Threads,
}

/// The default recipe, which the family varies.
const DEFAULT_RECIPE: &str = "paper";

/// Fits a family of recipes one after the other, measures each table and the models of light, and writes the three
/// files.
pub(super) fn run(args: &TradeoffArgs, context: &mut Context<'_>) -> Result<Exit, CommandFailure> {
    let name = args.recipe.as_deref().unwrap_or(Path::new(DEFAULT_RECIPE));
    let document = input::recipe_document(name)?;
    let (base, _) = tabulated::recipe(name, &document, None)?;
    let fault = if base.brdf() != BrdfKind::Ggx {
        let models = LightModel::names_of(|model| !model.needs_table());
        let brdf = base.brdf();
        Some(format!("/brdf: the models {models} need brdf ggx, got {brdf}"))
    } else if base.lobe().gaussian().is_some() {
        let what = "/lobe: the family already has lobes sg and asg: remove the field";
        Some(what.to_owned())
    } else {
        let what = "/nodes: the family varies the number of nodes: remove the field";
        (!base.given().is_none()).then(|| what.to_owned())
    };
    if let Some(fault) = fault {
        return Err(usage(format!("{}: {fault}", name.display())));
    }
    check_output_folder(&args.out)?;
    let (threads, pool) = (args.threads.count().get(), args.threads.pool()?);

    let size = if args.quick { Size::Quick } else { Size::Full };
    let recipes = family(&base, size, DEFAULT_ENTRY_LIMIT);
    let interrupt = context.interrupt.clone();
    let lights = pool.install(|| tradeoff_models::lights(&base))?;
    let gaussians = fitted_gaussians(&base);
    let bar = progress::bar(context.draws_progress, recipes.iter().chain(&gaussians).map(Recipe::entries).sum());
    let mut fitted = Vec::with_capacity(recipes.len());
    let mut tables = Vec::new();
    for recipe in recipes {
        let (measured, table) = pool.install(|| measure(&recipe, &lights, &bar, &interrupt))?;
        if represents_ltc(&base, &recipe) {
            let fit_seconds = measured.processor_seconds / threads as f64;
            tables.push(tradeoff_models::FittedTable { recipe: recipe.clone(), table, fit_seconds });
        }
        fitted.push((recipe, measured));
    }
    for recipe in gaussians {
        let (table, seconds) = pool.install(|| {
            let started = processor_seconds();
            let table = fit::fit(&Plan::new(&recipe), &bar, &interrupt).ok_or_else(CommandFailure::interrupted)?;
            Ok::<_, CommandFailure>((table, processor_seconds() - started))
        })?;
        tables.push(tradeoff_models::FittedTable { recipe, table, fit_seconds: seconds / threads as f64 });
    }
    bar.finish_and_clear();

    let rows = rows(&base, &fitted, threads);
    let models = pool.install(|| tradeoff_models::measure(&tables, &lights))?;
    let files = [
        ("tradeoff.csv", csv(&rows)),
        ("tradeoff.json", rows_json(&rows, &models, threads)),
        ("tradeoff.svg", picture(&rows, &models)),
    ];
    let mut paths = Vec::new();
    for (name, text) in files {
        paths.push(shown(&write_in(&args.out, name, text.as_bytes())?));
    }
    let value = json!({ "files": paths, "recipes": rows.len(), "predicted": off_by(&rows), "models": models });
    context.print(&value, &format!("{}\n\n{}\n{}", summary(&rows), models.text(), paths.join("\n")))
}

/// Fits and measures one table.
fn measure(
    recipe: &Recipe,
    lights: &RandomLights,
    bar: &ProgressBar,
    interrupt: &Interrupt,
) -> Result<(Measurement, Table), CommandFailure> {
    let (started, processor_started) = (Instant::now(), processor_seconds());
    let table = fit::fit(&Plan::new(recipe), bar, interrupt).ok_or_else(CommandFailure::interrupted)?;
    let (wall_seconds, processor_seconds) = (started.elapsed().as_secs_f64(), processor_seconds() - processor_started);
    let between = report(&table, &recipe.range, POINTS).between;
    let light = tradeoff_models::error(Lighting::by(&table), lights)?;
    let compact_bytes =
        compact::encode_lobes(&table).ok().map(|lobes| lobes.iter().map(|lobe| lobe.bytes.len() as u64).sum());
    let (width, sw1) = (between.width, between.sw1);
    Ok((Measurement { processor_seconds, wall_seconds, width, sw1, light, compact_bytes }, table))
}

/// Processor time of all threads of this process. Other processes do not count.
#[cfg(unix)]
pub(super) fn processor_seconds() -> f64 {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64
}

/// Wall time multiplied by the number of threads, because the system reports no processor time. It includes idle
/// threads and other processes.
#[cfg(not(unix))]
pub(super) fn processor_seconds() -> f64 {
    static START: std::sync::LazyLock<Instant> = std::sync::LazyLock::new(Instant::now);
    START.elapsed().as_secs_f64() * rayon::current_num_threads() as f64
}

/// The presets, whether each is on the front, and how far predictions were off.
fn summary(rows: &[FittedRecipe]) -> String {
    let mut out = format!("{:10}{:>20}{:>10}{:>10}{:>10}  on the front\n", "preset", "fit", "seconds", "error", "p95");
    for row in rows {
        let Some(preset) = row.preset else { continue };
        let fit = format!("{} x {} x {}", row.samples, row.directions, row.steps);
        let on_front = if row.on_front.base { "yes" } else { "no" };
        // Writing to a String cannot fail.
        let _ = writeln!(
            out,
            "{preset:10}{fit:>20}{:>10.2}{:>10.4}{:>10.4}  {on_front}",
            row.seconds, row.error_mean, row.error_p95
        );
    }
    let off = off_by(rows);
    let three = |of: [f64; 3]| of.map(|x| format!("{x:.2}")).join(" ");
    let (seconds, error, count) = (three(off.seconds), three(off.error), rows.len());
    out + &format!(
        "measured over predicted, {count} recipes (least, median, greatest): seconds {seconds}, error {error}"
    )
}
