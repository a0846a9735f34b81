//! Errors of documents.

/// An error of a recipe document.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Fault {
    /// The RFC 6901 pointer to the field.
    pub pointer: String,
    /// The description: the value, and the allowed values.
    pub detail: String,
}
