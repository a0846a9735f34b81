//! A table's manifest: its recipe, its size and its errors.
//!
//! Invariant: a manifest depends only on the table's file, and contains no time, host or duration.

use serde::{Serialize, de::Error as _};

use super::{
    container::{self, TableFileError},
    digest::Digest,
    recipe_document,
    tabulated::{FindBrdf, no_files},
};
use ltcforge_fit::albedo::{LutRecipe, LutReport};
use ltcforge_fit::{Asymmetry, GoOn, REPORT_VERSION, Recipe, Report, Table, report, report_points, report_while};

/// The version of manifests, raised if a table's manifest changes.
pub const MANIFEST_VERSION: u32 = REPORT_VERSION;

#[derive(Debug, Serialize)]
struct Manifest<'a> {
    table: Digest,
    recipe_digest: Digest,
    recipe: serde_json::Value,
    bytes: usize,
    entries: usize,
    report: &'a Report,
    #[serde(skip_serializing_if = "Option::is_none")]
    tabulated: Option<Tabulated>,
    exports: Vec<ExportEntry>,
}

/// The file to which a table was fitted.
#[derive(Debug, Serialize)]
struct Tabulated {
    file: String,
    /// The asymmetry of the data when view and light are exchanged.
    #[serde(skip_serializing_if = "Option::is_none")]
    asymmetry: Option<Asymmetry>,
}

/// The table in another file format.
#[derive(Debug, Serialize)]
struct ExportEntry {
    name: String,
    digest: Digest,
    bytes: usize,
}

/// The report of a recipe's table, as in its manifest. Runs on the current rayon pool. Domain: a table with a complete
/// model.
#[must_use]
pub fn table_report(table: &Table, recipe: &Recipe) -> Report {
    report(table, &recipe.range, report_points(recipe))
}

/// The manifest of a canonical file as JSON that ends in a newline. Measures the table on the current rayon pool.
///
/// # Errors
/// `file_bytes` is not a canonical table file, or the table has a tabulated BRDF, which needs [`manifest_json_with`].
pub fn manifest_json(file_bytes: &[u8]) -> Result<String, TableFileError> {
    manifest_json_with(file_bytes, &no_files)
}

/// Like [`manifest_json`], for any table.
///
/// # Errors
/// Like [`manifest_json`], and if the file of a tabulated BRDF is not found.
pub fn manifest_json_with(file_bytes: &[u8], find: &FindBrdf<'_>) -> Result<String, TableFileError> {
    let mut file = container::decode(file_bytes)?;
    file.find_brdf(find)?;
    manifest_of(file_bytes, &file.table, &file.recipe, &table_report(&file.table, &file.recipe))
}

/// Like [`manifest_json_with`]; `None` once `go_on` returns false.
///
/// # Errors
/// Like [`manifest_json_with`].
pub fn manifest_json_while(
    go_on: &GoOn,
    file_bytes: &[u8],
    find: &FindBrdf<'_>,
) -> Result<Option<String>, TableFileError> {
    let mut file = container::decode(file_bytes)?;
    file.find_brdf(find)?;
    let report = report_while(go_on, &file.table, &file.recipe.range, report_points(&file.recipe));
    report.map(|report| manifest_of(file_bytes, &file.table, &file.recipe, &report)).transpose()
}

/// The manifest of a lookup table, from its file and its report.
///
/// # Errors
/// The report has numbers that are not finite.
pub fn lut_manifest(file_bytes: &[u8], recipe: &LutRecipe, report: &LutReport) -> Result<String, serde_json::Error> {
    let manifest = serde_json::json!({
        "table": Digest::of(file_bytes), "recipe_digest": recipe_document::digest(recipe), "recipe": recipe,
        "bytes": file_bytes.len(), "entries": recipe.entries(), "report": report, "exports": [],
    });
    Ok(serde_json::to_string_pretty(&manifest)? + "\n")
}

/// The mean error of a table between nodes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeanError {
    /// The error as a fraction of the lobe's width.
    pub width: f64,
    /// The number of places where it was measured.
    pub places: usize,
}

impl MeanError {
    /// The mean error from a report.
    #[must_use]
    pub fn of(report: &Report) -> Self {
        Self { width: report.between.width.mean, places: report.between.points }
    }
}

/// The mean error between nodes from a manifest.
///
/// # Errors
/// The text is not a manifest.
pub fn mean_error(manifest: &str) -> Result<MeanError, serde_json::Error> {
    let manifest: serde_json::Value = serde_json::from_str(manifest)?;
    let between = &manifest["report"]["between"];
    let (width, places) = (between["width"]["mean"].as_f64(), between["points"].as_u64());
    let error = width.zip(places).map(|(width, places)| MeanError { width, places: places as usize });
    error.ok_or_else(|| serde_json::Error::missing_field("report.between"))
}

/// The manifest of a canonical file, from its table and recipe and from the table's [report](table_report).
///
/// # Errors
/// The recipe has no canonical JSON. The recipe of a file always has it.
pub fn manifest_of(
    file_bytes: &[u8],
    table: &Table,
    recipe: &Recipe,
    report: &Report,
) -> Result<String, TableFileError> {
    let text = recipe_document::canonical_json(recipe);
    let not_json = |error: serde_json::Error| TableFileError::Recipe(error.to_string());
    let manifest = Manifest {
        table: Digest::of(file_bytes),
        recipe_digest: Digest::of(text.as_bytes()),
        recipe: serde_json::from_str(&text).map_err(not_json)?,
        bytes: file_bytes.len(),
        entries: table.matrix.len(),
        report,
        tabulated: table
            .model()
            .file()
            .map(|of| Tabulated { file: of.to_string(), asymmetry: of.data().and_then(|data| data.asymmetry()) }),
        exports: vec![],
    };
    let mut json = serde_json::to_string_pretty(&manifest).map_err(not_json)?;
    json.push('\n');
    Ok(json)
}
