//! Why a lock file cannot be used.

use std::io;

use ltcforge_files::{digest::Digest, recipe_document::RecipeError};

/// The version of the format that is written.
pub(super) const VERSION: u32 = 2;

/// Why a lock file cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum LockFileError {
    /// It cannot be read.
    #[error("{source}")]
    Read {
        /// The system's error.
        source: io::Error,
    },
    /// It is not TOML, or not a lock file.
    #[error("{}", .0.trim_end())]
    Syntax(String),
    /// It has another version of the format.
    #[error("the lock file has version {0}; this program reads versions 1 to {VERSION}")]
    Version(i64),
    /// A name is empty or has characters that do not print.
    #[error("the name «{}» is not allowed: a name has one character or more, and none that does not print", .0.escape_debug())]
    Name(String),
    /// Two tables share a name, or two files a path.
    #[error("two {owners} have the {what} «{value}»")]
    Twice {
        /// `tables` or `files`.
        owners: &'static str,
        /// `name` or `path`.
        what: &'static str,
        /// The value they share.
        value: String,
    },
    /// A path leads out of the lock file's folder, into what version control keeps, or is none on some system.
    #[error("the path «{}» is not allowed: {reason}", .path.escape_debug())]
    Path {
        /// The path.
        path: String,
        /// What is wrong with it.
        reason: &'static str,
    },
    /// A path cannot be written in a file of text.
    #[error("the path «{0}» is not UTF-8 and cannot be written into a lock file")]
    NotText(String),
    /// A number is greater than TOML allows.
    #[error("a file of {0} bytes is too long for a lock file")]
    Bytes(u64),
    /// A pin's recipe is none.
    #[error("table «{name}»: recipe: {source}")]
    Recipe {
        /// The table.
        name: String,
        /// What is wrong with it.
        source: RecipeError,
    },
    /// A pin's recipe has another digest than the pin says.
    #[error("table «{name}»: the recipe hashes to {actual}, {stated} is pinned")]
    RecipeDigest {
        /// The table.
        name: String,
        /// What the pin says.
        stated: Digest,
        /// What it is.
        actual: Digest,
    },
    /// A pin lacks what `lock` writes.
    #[error("table «{name}» has no {field}; `ltcforge lock` writes it")]
    Incomplete {
        /// The table.
        name: String,
        /// The field.
        field: &'static str,
    },
}

/// The error of a text that is no lock file.
pub(super) fn syntax(error: impl std::fmt::Display) -> LockFileError {
    LockFileError::Syntax(error.to_string())
}
