//! The errors of lock files.

use std::io;

use super::error::without_passwords;
use ltcforge_files::{digest::Digest, recipe_document::RecipeError};

/// The format version that this program writes.
pub(super) const VERSION: u32 = 2;

/// Why a lock file cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum LockFileError {
    /// The file cannot be read.
    #[error("{source}")]
    Read {
        /// The system's error.
        source: io::Error,
    },
    /// The file is not TOML, or not a lock file.
    #[error("{}", .0.trim_end())]
    Syntax(String),
    /// This program cannot read the file's version of the format.
    #[error("the lock file has version {0}; this program reads versions 1 to {VERSION}")]
    Version(i64),
    /// A name is empty or contains characters that do not print.
    #[error("the name «{}» is not allowed: use one or more printable characters", .0.escape_debug())]
    Name(String),
    /// Two tables share a name, or two files share a path.
    #[error("two {owners} have the {what} «{value}»")]
    Twice {
        /// `tables` or `files`.
        owners: &'static str,
        /// `name` or `path`.
        what: &'static str,
        /// The value they share.
        value: String,
    },
    /// Two names or paths differ only in case or Unicode form, which some systems ignore.
    #[error(
        "two {owners} have the {what}s «{value}» and «{other}», which differ only in case or Unicode form, which some systems ignore: rename one"
    )]
    Alike {
        /// `tables` or `files`.
        owners: &'static str,
        /// `name` or `path`.
        what: &'static str,
        /// The first name or path.
        value: String,
        /// The second name or path.
        other: String,
    },
    /// A path leads out of the lock file's folder or into the files of version control, or is not valid on all systems.
    #[error("the path «{}» is not allowed: {reason}", .path.escape_debug())]
    Path {
        /// The path.
        path: String,
        /// Why the path is not allowed.
        reason: &'static str,
    },
    /// A path is not text, so it cannot be written to a lock file.
    #[error("the path «{0}» is not UTF-8 and cannot be written into a lock file")]
    NotText(String),
    /// A length is too large for a TOML number.
    #[error("a file of {0} bytes is too long for a lock file")]
    Bytes(u64),
    /// The recipe of a pin is invalid.
    #[error("table «{name}»: recipe: {source}")]
    Recipe {
        /// The table.
        name: String,
        /// The error of the recipe.
        source: RecipeError,
    },
    /// The digest of a pin's recipe differs from the digest that the pin states.
    #[error("table «{name}»: the recipe hashes to {actual}, but {stated} is pinned")]
    RecipeDigest {
        /// The table.
        name: String,
        /// The digest that the pin states.
        stated: Digest,
        /// The digest of the recipe.
        actual: Digest,
    },
    /// A pin lacks a field that `lock` writes.
    #[error("table «{name}» has no {field}; run `ltcforge lock` to add it")]
    Incomplete {
        /// The table.
        name: String,
        /// The field.
        field: &'static str,
    },
}

/// The error for a text that is not a lock file. The error may quote a line.
pub(super) fn syntax(error: impl std::fmt::Display) -> LockFileError {
    LockFileError::Syntax(without_passwords(&error.to_string()))
}
