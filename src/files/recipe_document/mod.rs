//! Recipe documents: reads JSON into a complete [`Recipe`] or a list of all errors. Also a recipe's canonical form and
//! digest.

mod axes;
mod document;
mod fault;
mod fresnel;
mod lut;
mod materials;
mod preset;
mod reader;
mod schema;
mod terms;

use std::ops::RangeInclusive;

use crate::{
    digest::Digest,
    json_size::JsonLimits,
    strict::Strict,
    tabulated::{FindBrdf, no_files},
    text::{other_form, without_mark},
};
use ltcforge_fit::{FITTER_VERSION, Recipe, TabulatedFile, albedo::LutRecipe};
use serde::Serialize;

pub use document::DEFAULT_ENTRY_LIMIT;
pub use fault::Fault;
pub use preset::Preset;
pub use schema::schema;

/// The size limits of a document: twice the nodes of four full axes.
const LIMITS: JsonLimits = JsonLimits { items: 1 << 12, values: 1 << 17 };

/// The document is not a recipe.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum RecipeError {
    /// The text is not JSON, or repeats a field.
    #[error("not JSON: {0}")]
    Json(String),
    /// The document is JSON, but not a recipe. Lists every error, in the order in which fields are read.
    #[error("the recipe has {} fault(s): {}", .0.len(), list(.0))]
    Faults(Vec<Fault>),
}

/// A recipe of either kind.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum AnyRecipe {
    /// The recipe of a table of linearly transformed cosines.
    Ltc(Box<Recipe>),
    /// The recipe of a lookup table.
    Lut(LutRecipe),
}

impl AnyRecipe {
    /// The recipe of a table of linearly transformed cosines.
    ///
    /// # Errors
    /// The recipe is that of a lookup table.
    pub fn only_ltc(self) -> Result<Recipe, RecipeError> {
        match self {
            Self::Ltc(recipe) => Ok(*recipe),
            Self::Lut(LutRecipe { table, .. }) => {
                let detail = format!("\"{table}\" is a lookup table; allowed here: \"ltc\"");
                Err(RecipeError::Faults(vec![Fault { pointer: "/table".to_owned(), detail }]))
            }
        }
    }
}

fn list(faults: &[Fault]) -> String {
    faults.iter().map(|fault| format!("{}: {}", fault.pointer, fault.detail)).collect::<Vec<_>>().join("; ")
}

/// Reads a recipe document for fitting, fills in its preset and defaults, and checks it.
///
/// # Errors
/// Every error of the document at once. The version of another fitter is an error. A tabulated BRDF is an
/// error too; use [`parse_with`] to find its file.
pub fn parse(json: &[u8], entry_limit: u64) -> Result<Recipe, RecipeError> {
    parse_with(json, entry_limit, &no_files)
}

/// Like [`parse`], for documents that may name the file of a tabulated BRDF.
///
/// # Errors
/// Like [`parse`]; errors of the file belong to the field `tabulated`.
pub fn parse_with(json: &[u8], entry_limit: u64, find: &FindBrdf<'_>) -> Result<Recipe, RecipeError> {
    parse_any(json, entry_limit, find)?.only_ltc()
}

/// Like [`parse_with`], for recipes of both kinds.
///
/// # Errors
/// Like [`parse_with`].
pub fn parse_any(json: &[u8], entry_limit: u64, find: &FindBrdf<'_>) -> Result<AnyRecipe, RecipeError> {
    read(json, entry_limit, FITTER_VERSION..=FITTER_VERSION, find)
}

/// Reads the recipe of a stored table, which may come from an older fitter. The file of a tabulated BRDF is not read.
///
/// # Errors
/// Like [`parse`].
pub fn parse_stored(json: &[u8]) -> Result<Recipe, RecipeError> {
    parse_any_stored(json)?.only_ltc()
}

/// Like [`parse_stored`], for recipes of both kinds.
///
/// # Errors
/// Like [`parse`].
pub fn parse_any_stored(json: &[u8]) -> Result<AnyRecipe, RecipeError> {
    let unread = |name: &str| match name.parse::<Digest>() {
        Ok(digest) => Ok(TabulatedFile::unread(*digest.as_bytes())),
        Err(error) => Err(vec![error.to_string()]),
    };
    read(json, u64::MAX, 1..=FITTER_VERSION, &unread)
}

fn read(
    json: &[u8],
    entry_limit: u64,
    fitters: RangeInclusive<u32>,
    find: &FindBrdf<'_>,
) -> Result<AnyRecipe, RecipeError> {
    let json = without_mark(json);
    LIMITS.check(json).map_err(|error| RecipeError::Json(error.to_string()))?;
    let Strict(document) = serde_json::from_slice(json)
        .map_err(|error| RecipeError::Json(other_form(json).unwrap_or_else(|| error.to_string())))?;
    let mut faults = reader::Faults::default();
    let kind = lut::kind(&document, &mut faults);
    if !faults.0.is_empty() {
        return Err(RecipeError::Faults(faults.0));
    }
    match kind {
        Some(kind) => lut::read(&document, kind, entry_limit, fitters).map(AnyRecipe::Lut),
        None => document::read(&document, entry_limit, fitters, find).map(|recipe| AnyRecipe::Ltc(Box::new(recipe))),
    }
    .map_err(RecipeError::Faults)
}

/// The canonical JSON (RFC 8785) of a complete recipe of any kind.
#[must_use]
pub fn canonical_json(recipe: &impl Serialize) -> String {
    // A recipe has only names and finite numbers, which always have a canonical form.
    serde_jcs::to_string(recipe).unwrap_or_default()
}

/// The digest of a recipe: SHA-256 of its canonical JSON.
#[must_use]
pub fn digest(recipe: &impl Serialize) -> Digest {
    Digest::of(canonical_json(recipe).as_bytes())
}

#[cfg(test)]
mod tests;
