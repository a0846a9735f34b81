//! Lookup tables in `fit`, `report` and other commands.

use std::{
    fmt::Write as _,
    path::{Path, PathBuf},
    time::Instant,
};

use serde_json::json;

use super::{
    CommandFailure, Context, Exit, Interrupt, TableChoice, Threads, check_output_folder, failed, mismatch, progress,
    shown, table_file, table_path,
};
use ltcforge_files::{
    container::{AnyFile, LutFile, decode_any, encode_lut},
    digest::Digest,
    manifest::lut_manifest,
};
use ltcforge_fit::albedo::{Lut, LutPlan, LutRecipe, LutReport, MeasuredLut, fit_lut};

/// Computes a lookup table, and writes the table and its manifest.
pub(super) fn fit(
    recipe: &LutRecipe,
    out: &Path,
    threads: &Threads,
    context: &mut Context<'_>,
) -> Result<Exit, CommandFailure> {
    check_output_folder(out)?;
    let pool = threads.pool()?;
    let started = Instant::now();
    let (draws, interrupt) = (context.draws_progress, &context.interrupt);
    let lut = pool.install(|| fit_alone(recipe, draws, interrupt))?;
    let fit_seconds = started.elapsed().as_secs_f64();
    let bytes = encode_lut(recipe, &lut).map_err(failed)?;
    let report = pool.install(|| MeasuredLut::new(recipe).report(&lut));
    let manifest = lut_manifest(&bytes, recipe, &report).map_err(failed)?;
    let (digest, [table, manifest]) = table_file::replace(out, &bytes, &manifest)?;
    let next = [format!("ltcforge report {}", shown(&table))];
    let value = json!({
        "table": digest, "file": shown(&table), "manifest": shown(&manifest), "bytes": bytes.len(),
        "seconds": started.elapsed().as_secs_f64(), "fit_seconds": fit_seconds,
        "error": report.stored, "next": next,
    });
    context.print(&value, &format!("{}\n{digest}", table.display()))?;
    if !context.json {
        eprintln!("{} texels in {fit_seconds:.2} s", recipe.entries());
        eprintln!("error after linear filtering: {}", report.stored);
        eprintln!("next: {}", next[0]);
    }
    Ok(Exit::Ok)
}

/// Computes a lookup table on the current rayon pool, with its own progress bar.
pub(super) fn fit_alone(recipe: &LutRecipe, draws: bool, interrupt: &Interrupt) -> Result<Lut, CommandFailure> {
    let bar = progress::bar(draws, recipe.entries());
    let lut = fit_lut(&LutPlan::new(recipe), &|done| progress::follow(done, &bar, interrupt));
    bar.finish_and_clear();
    lut.ok_or_else(CommandFailure::interrupted)
}

/// A lookup table, if `choice` is one.
pub(super) fn read(choice: &TableChoice) -> Result<Option<(PathBuf, Digest, LutFile)>, CommandFailure> {
    let path = table_path(&choice.table, choice.folder.tables.as_deref())?;
    let bytes = table_file::read(&path, choice.folder.limit.table_limit)?;
    // Other files have errors of their own.
    let Ok(AnyFile::Lut(file)) = decode_any(&bytes) else { return Ok(None) };
    let digest = Digest::of(&bytes);
    if let Some(expected) = table_file::digest_in_name(&path).filter(|expected| *expected != digest) {
        return Err(mismatch(&path, format!("the file has digest {digest}, expected {expected}")));
    }
    Ok(Some((path, digest, file)))
}

/// Prints the errors of a lookup table.
pub(super) fn report(
    (path, digest, file): &(PathBuf, Digest, LutFile),
    threads: &Threads,
    context: &mut Context<'_>,
) -> Result<Exit, CommandFailure> {
    let report = threads.pool()?.install(|| MeasuredLut::new(&file.recipe).report(&file.lut));
    let value = json!({
        "file": shown(path), "digest": digest, "table": file.recipe.table,
        "resolution": file.recipe.resolution, "report": report,
    });
    context.print(&value, report_text(path, &file.recipe, &report).trim_end())
}

fn report_text(path: &Path, recipe: &LutRecipe, report: &LutReport) -> String {
    let mut out = format!(
        "{}\ntable {} of {}, {} texels: {}\n\nerror after linear filtering at {} places:\n",
        path.display(),
        recipe.table,
        recipe.brdf,
        recipe.resolution,
        recipe.axis_names().join(" x "),
        report.places
    );
    // Writing to a String cannot fail.
    let _ = writeln!(out, "stored                              {}", report.stored);
    let _ = writeln!(out, "exact values in texels              {}", report.sampled);
    for (format, error) in &report.formats {
        let _ = writeln!(out, "stored texels, rounded to {format:<9} {error}");
    }
    let _ = writeln!(out, "\npicture: ltcforge plot {} error -o lut.png", path.display());
    out
}
