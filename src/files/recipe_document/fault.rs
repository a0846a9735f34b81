//! The faults of documents.

/// One fault of a recipe document.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Fault {
    /// RFC 6901 pointer to the field.
    pub pointer: String,
    /// The fault: the value, and what is allowed.
    pub detail: String,
}
