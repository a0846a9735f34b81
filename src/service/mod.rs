//! The use cases: submit, work, download.

mod api;

pub use api::*;

/// The manifest of a canonical table file.
///
/// # Errors
/// When the bytes are no table.
pub fn manifest_json(_file: &[u8]) -> Result<Vec<u8>, crate::export::TableFileError> {
    todo!()
}
