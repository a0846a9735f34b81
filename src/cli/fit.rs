//! `fit`: a table without a server.

use std::{ops::ControlFlow, path::Path, time::Instant};

use indicatif::ProgressBar;
use serde::Serialize;
use serde_json::json;

use super::{
    CommandFailure, Context, Exit, Interrupt, args::FitArgs, file_failure, input, output::check_output_folder, print,
    progress, report::asymmetry_line, shown, table_file::TABLE_FOLDERS, tabulated,
};
use ltcforge_files::{
    container::{self, TableFileError},
    digest::Digest,
    manifest::{manifest_of, table_report},
    replace::{PairError, replace_file, replace_pair},
    tabulated::kept_name,
};
use ltcforge_fit::{Plan, Report, Table, fit_plan};

/// The length of a digest's beginning that tells a table from many thousands: `sha256:` and 12 digits.
const SHORT_DIGEST: usize = "sha256:".len() + 12;

/// Fits a recipe and writes the table and its manifest.
pub(super) fn run(args: &FitArgs, json: bool, context: &mut Context<'_>) -> Result<Exit, CommandFailure> {
    let document = input::recipe_document(&args.recipe)?;
    let (recipe, brdf_file) = tabulated::recipe(&args.recipe, &document, args.entry_limit)?;
    check_output_folder(&args.out)?;
    let pool = args.threads.pool()?;

    let started = Instant::now();
    let plan = Plan::new(&recipe);
    let bar = progress::bar(context.draws_progress, recipe.entries());
    let fitted = pool.install(|| fit(&plan, &bar, &context.interrupt));
    bar.finish_and_clear();
    let table = fitted.ok_or_else(CommandFailure::interrupted)?;
    let fit_seconds = started.elapsed().as_secs_f64();
    let failed = |error: TableFileError| CommandFailure::new(Exit::Failed, error.to_string());
    let file = container::encode(&recipe, &table).map_err(failed)?;
    let digest = Digest::of(&file);
    let report = pool.install(|| table_report(&table, &recipe));
    let manifest = manifest_of(&file, &table, &recipe, &report).map_err(failed)?;

    // The file of a tabulated BRDF is kept beside the table, because measuring the table needs it.
    if let (Some(of), Some(bytes)) = (recipe.model().file(), &brdf_file) {
        let path = args.out.join(kept_name(of.digest()));
        replace_file(&path, bytes).map_err(|error| file_failure(&path, &error))?;
    }
    // The table is written first: if the process ends in between, there is no manifest without its table.
    let manifest_path = args.out.join(format!("{}.manifest.json", digest.hex()));
    let table_path = args.out.join(format!("{}.safetensors", digest.hex()));
    replace_pair((&table_path, &file), (&manifest_path, manifest.as_bytes()))
        .map_err(|PairError { path, source }| file_failure(&path, &source))?;

    let seconds = started.elapsed().as_secs_f64();
    let error = Headline::of(&report);
    let name =
        if finds_digests_in(&args.out) { digest.to_string()[..SHORT_DIGEST].to_owned() } else { shown(&table_path) };
    let next = [format!("ltcforge preview {name} -o sphere.png"), format!("ltcforge report {name}")];
    let value = json!({
        "table": digest, "file": shown(&table_path), "manifest": shown(&manifest_path), "bytes": file.len(),
        "seconds": seconds, "fit_seconds": fit_seconds, "error": error, "next": next,
    });
    print(context.stdout, json, &value, &format!("{}\n{digest}", table_path.display()))?;
    if !json {
        let entries = recipe.entries();
        eprintln!("{entries} entries in {seconds:.1} s: {fit_seconds:.1} s to fit, the rest to measure the error");
        let (mean, p95) = (100.0 * error.mean, 100.0 * error.p95);
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

/// A table's error in one line: how far its lobes between the nodes are from the BRDF's, in widths of the lobe.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
struct Headline {
    mean: f64,
    p95: f64,
}

impl Headline {
    fn of(report: &Report) -> Self {
        let width = &report.between.width;
        Self { mean: width.mean, p95: width.p95 }
    }
}

/// Whether a digest alone finds the tables in `folder`.
fn finds_digests_in(folder: &Path) -> bool {
    TABLE_FOLDERS.iter().any(|searched| folder == Path::new(searched))
}

/// The table of a plan, or `None` when the user stops the fit.
pub(super) fn fit(plan: &Plan, bar: &ProgressBar, interrupt: &Interrupt) -> Option<Table> {
    fit_plan(plan, &|done| {
        // Threads may report out of order. The bar never goes back.
        bar.update(|bar| bar.set_pos(bar.pos().max(done)));
        if interrupt.is_set() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    })
}
