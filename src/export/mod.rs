//! Tables as files.

use crate::{fit::Recipe, ltc::Table};

/// A canonical file that was read back.
#[derive(Debug, Clone, PartialEq)]
pub struct TableFile {
    /// What was fitted.
    pub recipe: Recipe,
    /// What came out.
    pub table: Table,
}

/// Why bytes are not a canonical table file.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("not a table: {0}")]
pub struct TableFileError(pub String);

/// The canonical safetensors file of a table.
#[must_use]
pub fn encode(_recipe: &Recipe, _table: &Table) -> Vec<u8> {
    todo!()
}

/// Reads a canonical file; hostile bytes give an error, never a panic.
///
/// # Errors
/// Names what is wrong: header, tensor, shape, a number that is not finite.
pub fn decode(_bytes: &[u8]) -> Result<TableFile, TableFileError> {
    todo!()
}
