//! The error of a translation.

use ltcforge_shaders::Language;

/// Why there is no translation: a language that has no such text ([`Language::has_programs`],
/// [`Language::has_includes`]), or a defect of the shaders or of naga.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{}: {reason}", language.name())]
pub struct PortError {
    /// The language asked for.
    pub language: Language,
    /// The message of naga, or what is not printed, with line and column.
    pub reason: String,
}
