//! A table's manifest: its recipe, its size and its errors.
//!
//! Invariant: a manifest follows from the table's file alone and contains no time, host or duration.

use serde::{Deserialize, Serialize};

use super::{
    container::{self, TableFile, TableFileError},
    digest::Digest,
    recipe_document,
};
use crate::fit::{GoOn, REPORT_VERSION, Recipe, Report, Table, report, report_points, report_while};

/// Version of manifests. Raised whenever the same table gets another manifest.
pub const MANIFEST_VERSION: u32 = REPORT_VERSION;

#[derive(Debug, Serialize)]
struct Manifest {
    table: Digest,
    recipe_digest: Digest,
    recipe: serde_json::Value,
    bytes: usize,
    entries: usize,
    report: Report,
    exports: Vec<Export>,
}

/// Another file of the same table.
#[derive(Debug, Serialize)]
struct Export {
    name: String,
    digest: Digest,
    bytes: usize,
}

/// The report of a recipe's table, as in its manifest. Runs on the current rayon pool.
#[must_use]
pub fn table_report(table: &Table, recipe: &Recipe) -> Report {
    report(table, &recipe.range, report_points(recipe))
}

/// The manifest of a canonical file as JSON that ends in a newline. Measures the table on the current rayon pool.
///
/// # Errors
/// When `file_bytes` is not a canonical table file.
pub fn manifest_json(file_bytes: &[u8]) -> Result<String, TableFileError> {
    let file = container::decode(file_bytes)?;
    let report = table_report(&file.table, &file.recipe);
    json(file_bytes, &file, report)
}

/// As [`manifest_json`]; `None` as soon as `go_on` says no.
///
/// # Errors
/// As [`manifest_json`].
pub fn manifest_json_while(go_on: &GoOn, file_bytes: &[u8]) -> Result<Option<String>, TableFileError> {
    let file = container::decode(file_bytes)?;
    let report = report_while(go_on, &file.table, &file.recipe.range, report_points(&file.recipe));
    report.map(|report| json(file_bytes, &file, report)).transpose()
}

/// The mean error of a table between nodes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeanError {
    /// As a part of the lobe's width.
    pub width: f64,
    /// At how many places it was measured.
    pub places: usize,
}

impl MeanError {
    /// What a report tells.
    #[must_use]
    pub fn of(report: &Report) -> Self {
        Self { width: report.between.width.mean, places: report.between.points }
    }
}

/// The mean error between nodes that a manifest tells.
///
/// # Errors
/// When the text is no manifest.
pub fn mean_error(manifest: &str) -> Result<MeanError, serde_json::Error> {
    #[derive(Deserialize)]
    struct Measured {
        report: MeasuredReport,
    }
    #[derive(Deserialize)]
    struct MeasuredReport {
        between: Between,
    }
    #[derive(Deserialize)]
    struct Between {
        points: usize,
        width: Width,
    }
    #[derive(Deserialize)]
    struct Width {
        mean: f64,
    }
    serde_json::from_str(manifest).map(|Measured { report: MeasuredReport { between } }| MeanError {
        width: between.width.mean,
        places: between.points,
    })
}

fn json(file_bytes: &[u8], file: &TableFile, report: Report) -> Result<String, TableFileError> {
    let text = recipe_document::canonical_json(&file.recipe);
    let not_json = |error: serde_json::Error| TableFileError::Recipe(error.to_string());
    let manifest = Manifest {
        table: Digest::of(file_bytes),
        recipe_digest: Digest::of(text.as_bytes()),
        recipe: serde_json::from_str(&text).map_err(not_json)?,
        bytes: file_bytes.len(),
        entries: file.table.matrix.len(),
        report,
        exports: vec![],
    };
    let mut json = serde_json::to_string_pretty(&manifest).map_err(not_json)?;
    json.push('\n');
    Ok(json)
}
