//! `fit`: fits a table on this machine, without a server.

use std::{
    num::NonZeroU64,
    path::{Path, PathBuf},
    time::Instant,
};

use clap::Args;
use indicatif::ProgressBar;
use serde_json::json;

use super::{
    CommandFailure, Context, Exit, Interrupt, Threads, check_output_folder, failed, input, lut, progress,
    report::asymmetry_line, shown, table_file, table_file::TABLE_FOLDERS, tabulated, write_in,
};
use ltcforge_files::{
    container,
    digest::Digest,
    manifest::{manifest_of, table_report},
    recipe_document::AnyRecipe,
    tabulated::kept_name,
};
use ltcforge_fit::{Plan, Recipe, Report, Table, fit_plan};

/// `fit`.
#[derive(Debug, Args)]
pub struct FitArgs {
    /// Recipe: a file, `-` for stdin, or a preset's name
    pub recipe: PathBuf,
    /// Folder for the table and its manifest
    #[arg(short, long, value_name = "DIR", default_value = ".")]
    pub out: PathBuf,
    /// Number of threads
    #[command(flatten)]
    pub threads: Threads,
    /// Maximum entries of the table [default: 2000000]
    #[arg(long, env = "LTCFORGE_ENTRY_LIMIT", value_name = "N")]
    pub entry_limit: Option<NonZeroU64>,
}

/// Length of a short digest, `sha256:` and 12 digits. It is unique among many thousands of tables.
const SHORT_DIGEST: usize = "sha256:".len() + 12;

/// Fits a recipe and writes the table and its manifest.
pub(super) fn run(args: &FitArgs, context: &mut Context<'_>) -> Result<Exit, CommandFailure> {
    let document = input::recipe_document(&args.recipe)?;
    let (recipe, brdf_file) = match tabulated::any_recipe(&args.recipe, &document, args.entry_limit)? {
        (AnyRecipe::Ltc(recipe), brdf_file) => (*recipe, brdf_file),
        (AnyRecipe::Lut(recipe), _) => return lut::fit(&recipe, &args.out, &args.threads, context),
    };
    check_output_folder(&args.out)?;
    let pool = args.threads.pool()?;

    let started = Instant::now();
    let table = pool.install(|| fit_alone(&recipe, context.draws_progress, &context.interrupt))?;
    let fit_seconds = started.elapsed().as_secs_f64();
    // A tabulated BRDF's file is copied next to the table, because measuring the table needs it.
    if let (Some(of), Some(bytes)) = (recipe.model().file(), &brdf_file) {
        write_in(&args.out, kept_name(of.digest()), bytes)?;
    }
    let Stored { digest, bytes, paths: [table_path, manifest_path], report } =
        pool.install(|| store(&args.out, &recipe, &table))?;

    let seconds = started.elapsed().as_secs_f64();
    let (mean, p95) = (report.between.width.mean, report.between.width.p95);
    let is_searched = TABLE_FOLDERS.iter().any(|folder| args.out == Path::new(folder));
    let name = if is_searched { digest.to_string()[..SHORT_DIGEST].to_owned() } else { shown(&table_path) };
    let next = [format!("ltcforge preview {name} -o sphere.png"), format!("ltcforge report {name}")];
    let value = json!({
        "table": digest, "file": shown(&table_path), "manifest": shown(&manifest_path), "bytes": bytes,
        "seconds": seconds, "fit_seconds": fit_seconds, "error": { "mean": mean, "p95": p95 }, "next": next,
    });
    context.print(&value, &format!("{}\n{digest}", table_path.display()))?;
    if !context.json {
        let entries = recipe.entries();
        eprintln!("{entries} entries in {seconds:.1} s: {fit_seconds:.1} s to fit, the rest to measure the error");
        let (mean, p95) = (100.0 * mean, 100.0 * p95);
        eprintln!(
            "error between the nodes, in widths of the lobe: {mean:.1} % on average, {p95:.1} % at the 95th percentile"
        );
        let data = recipe.model().file().and_then(|file| file.data());
        if let Some(asymmetry) = data.and_then(|data| data.asymmetry()) {
            eprintln!("{}", asymmetry_line(&asymmetry));
        }
        eprintln!("next: {}\n      {}", next[0], next[1]);
    }
    Ok(Exit::Ok)
}

/// A table's file and its manifest, named by the table's digest.
pub(super) struct Stored {
    pub(super) digest: Digest,
    /// The length of the table's file.
    pub(super) bytes: usize,
    /// The paths of the table and of the manifest.
    pub(super) paths: [PathBuf; 2],
    pub(super) report: Report,
}

/// Measures a table on the current rayon pool, and writes it and its manifest to the folder `out`.
pub(super) fn store(out: &Path, recipe: &Recipe, table: &Table) -> Result<Stored, CommandFailure> {
    let file = container::encode(recipe, table).map_err(failed)?;
    let report = table_report(table, recipe);
    let manifest = manifest_of(&file, table, recipe, &report).map_err(failed)?;
    let (digest, paths) = table_file::replace(out, &file, &manifest)?;
    Ok(Stored { digest, bytes: file.len(), paths, report })
}

/// Fits a recipe on the current rayon pool, with its own progress bar.
///
/// # Errors
/// When the user stops the fit.
pub(super) fn fit_alone(recipe: &Recipe, draws: bool, interrupt: &Interrupt) -> Result<Table, CommandFailure> {
    let bar = progress::bar(draws, recipe.entries());
    let table = fit(&Plan::new(recipe), &bar, interrupt);
    bar.finish_and_clear();
    table.ok_or_else(CommandFailure::interrupted)
}

/// Fits the table of a plan. Returns `None` when the user stops the fit.
pub(super) fn fit(plan: &Plan, bar: &ProgressBar, interrupt: &Interrupt) -> Option<Table> {
    fit_plan(plan, &|done| progress::follow(done, bar, interrupt))
}
