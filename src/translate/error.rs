//! The error of a translation.

use ltcforge_shaders::Language;

/// The shader has no translation: the language has no such text ([`Language::has_programs`],
/// [`Language::has_includes`]), or the shader or naga has a defect.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{}: {reason}", language.name())]
pub struct PortError {
    /// The requested language.
    pub language: Language,
    /// The message of naga, or of the printer with line and column.
    pub reason: String,
}
