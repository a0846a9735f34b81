//! The errors of lock files.

use std::io;

use super::error::without_passwords;
use ltcforge_files::{digest::Digest, recipe_document::RecipeError};

/// The version of the format that is written.
pub(super) const VERSION: u32 = 2;

/// The reason that a lock file cannot be used.
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
    #[error("the name «{}» is not allowed: a name has at least one character, and all of them print", .0.escape_debug())]
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
    /// Two names or paths differ by case or by Unicode form, so that some systems take them for one.
    #[error(
        "two {owners} have the {what}s «{value}» and «{other}», which differ by case or by Unicode form alone: some systems take them for one"
    )]
    Alike {
        /// `tables` or `files`.
        owners: &'static str,
        /// `name` or `path`.
        what: &'static str,
        /// The first.
        value: String,
        /// The second.
        other: String,
    },
    /// A path leads out of the lock file's folder or into the files of version control, or some system does not allow
    /// it.
    #[error("the path «{}» is not allowed: {reason}", .path.escape_debug())]
    Path {
        /// The path.
        path: String,
        /// Its fault.
        reason: &'static str,
    },
    /// A path is not text, so it cannot be written to a lock file.
    #[error("the path «{0}» is not UTF-8 and cannot be written into a lock file")]
    NotText(String),
    /// A length is greater than the numbers of TOML.
    #[error("a file of {0} bytes is too long for a lock file")]
    Bytes(u64),
    /// The recipe of a pin is invalid.
    #[error("table «{name}»: recipe: {source}")]
    Recipe {
        /// The table.
        name: String,
        /// Its fault.
        source: RecipeError,
    },
    /// The recipe of a pin has another digest than the pin states.
    #[error("table «{name}»: the recipe hashes to {actual}, {stated} is pinned")]
    RecipeDigest {
        /// The table.
        name: String,
        /// The digest that the pin states.
        stated: Digest,
        /// The digest of the recipe.
        actual: Digest,
    },
    /// A pin lacks a field that `lock` writes.
    #[error("table «{name}» has no {field}; `ltcforge lock` writes it")]
    Incomplete {
        /// The table.
        name: String,
        /// The field.
        field: &'static str,
    },
}

/// The error of a text that is not a lock file. It may quote a line.
pub(super) fn syntax(error: impl std::fmt::Display) -> LockFileError {
    LockFileError::Syntax(without_passwords(&error.to_string()))
}
