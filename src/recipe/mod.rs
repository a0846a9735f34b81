//! Recipe documents: JSON in, a complete [`Recipe`] or every fault at once out; canonical form and digest.

use crate::{digest::Digest, fit::Recipe};

/// One fault of a recipe document.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Fault {
    /// RFC 6901 pointer to the field.
    pub pointer: String,
    /// What is wrong with it: the value, and what is allowed.
    pub detail: String,
}

/// Why a document is not a recipe.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum RecipeError {
    /// Not JSON at all.
    #[error("not JSON: {0}")]
    Json(String),
    /// JSON, but not a recipe: every fault, in document order.
    #[error("{} fault(s) in the recipe, the first at {}: {}", .0.len(), .0[0].pointer, .0[0].detail)]
    Faults(Vec<Fault>),
}

/// Entries a table may have unless the caller raises it.
pub const DEFAULT_ENTRY_LIMIT: u64 = 2_000_000;

/// Reads a recipe document, fills in its preset and the defaults, and checks it.
///
/// # Errors
/// Every fault of the document at once.
pub fn parse(_json: &[u8], _entry_limit: u64) -> Result<Recipe, RecipeError> {
    todo!()
}

/// The canonical JSON (RFC 8785) of a complete recipe.
#[must_use]
pub fn canonical_json(_recipe: &Recipe) -> String {
    todo!()
}

/// The digest of a recipe: SHA-256 of its canonical JSON.
#[must_use]
pub fn digest(recipe: &Recipe) -> Digest {
    Digest::of(canonical_json(recipe).as_bytes())
}
