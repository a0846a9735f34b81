//! The faults of documents.

/// One fault of a recipe document.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Fault {
    /// RFC 6901 pointer to the field.
    pub pointer: String,
    /// What is wrong with it: the value, and what is allowed.
    pub detail: String,
}
