//! `ltcforge.lock`: the tables that a project uses, by hash. `ltcforge lock` writes it; comments are preserved.
//!
//! ```toml
//! version = 2
//! sources = ["https://ltc.example.org", "../tables"] # optional: asked in this order
//!
//! [[table]]
//! name = "metal"
//! path = "assets/metal.safetensors"
//! digest = "sha256:ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"
//! bytes = 77880
//! recipe_digest = "sha256:cb8379ac2098aa165029e3938a51da0bcecfc008fd6795f401178647f96c5b34"
//! recipe = '{"brdf":"ggx", ...}' # canonical JSON
//! sources = ["https://other.example.org"] # optional: asked before the project's
//!
//! [[table.export]]
//! for = "wgpu" # or layout, container and precision
//! to = "assets/ltc"
//! file = [
//!     { path = "assets/ltc/ltc_matrix_a.ktx2", bytes = 1352, digest = "sha256:..." },
//! ]
//! ```
//!
//! Version 1 had neither recipes nor exports, and `server` in place of a table's sources. It is read.

use std::{
    collections::BTreeSet,
    io,
    path::{Component, Path, PathBuf},
};

use serde::Deserialize;

use super::Source;
use crate::files::{
    bounded::read_file,
    digest::Digest,
    recipe_document::{self, RecipeError},
};

/// The version of the format that is written.
pub(super) const VERSION: u32 = 2;

/// Longest lock file that is read: some thousand pins.
const LIMIT_BYTES: u64 = 4 << 20;

/// One table that a project uses.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Pin {
    /// Its name in the project.
    pub name: String,
    /// Where its file is: relative to the lock file's folder, and below it.
    pub path: PathBuf,
    /// Its digest.
    pub digest: Digest,
    /// Its size: a longer file is not taken. A pin of version 1 may lack it.
    pub bytes: Option<u64>,
    /// The recipe's document, of which it can be fitted again. A pin of version 1 lacks it.
    pub recipe: Option<String>,
    /// Where it is looked for before the sources of the project.
    pub sources: Vec<Source>,
    /// The files that are made of it.
    pub exports: Vec<ExportPin>,
}

/// Files that are made of a table: which, where, and what they hash to. The first four fields are arguments of
/// `ltcforge export`, as text.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ExportPin {
    /// The engine whose files they are.
    #[serde(default, rename = "for")]
    pub engine: Option<String>,
    /// Without an engine: the layout of the textures.
    #[serde(default)]
    pub layout: Option<String>,
    /// And their format.
    #[serde(default)]
    pub container: Option<String>,
    /// And their numbers, as in recipes.
    #[serde(default)]
    pub precision: Option<String>,
    /// Their folder, relative to the lock file's and below it.
    pub to: PathBuf,
    /// The files.
    pub file: Vec<FilePin>,
}

/// A file that is made of a table.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FilePin {
    /// Where it is: relative to the lock file's folder, and below it.
    pub path: PathBuf,
    /// Its size.
    pub bytes: u64,
    /// The SHA-256 of its bytes.
    pub digest: Digest,
}

impl ExportPin {
    /// Whether `other` asks for the same files.
    #[must_use]
    pub fn asks_as(&self, other: &Self) -> bool {
        let request = |pin: &Self| {
            let Self { engine, layout, container, precision, to, .. } = pin.clone();
            (engine, layout, container, precision, to)
        };
        request(self) == request(other)
    }
}

/// A project's pins.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct LockFile {
    /// In the order of the file; no two have the same name or path.
    pub pins: Vec<Pin>,
    /// Where tables are looked for.
    pub sources: Vec<Source>,
    /// The folder that paths are relative to.
    pub folder: PathBuf,
}

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
    /// A path leads out of the lock file's folder.
    #[error(
        "the path «{}» is not allowed: paths are relative, stay below the lock file's folder and have no control characters",
        .0.escape_debug()
    )]
    Path(String),
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

/// The part of each version that tells which it is.
#[derive(Debug, Deserialize)]
struct Head {
    version: i64,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Document<T> {
    #[serde(rename = "version")]
    _version: i64,
    #[serde(default)]
    sources: Vec<Source>,
    #[serde(default = "Vec::new")]
    table: Vec<T>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct OldTable {
    name: String,
    digest: Digest,
    path: PathBuf,
    #[serde(default)]
    bytes: Option<u64>,
    #[serde(default)]
    server: Option<String>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct NewTable {
    name: String,
    path: PathBuf,
    digest: Digest,
    bytes: u64,
    recipe_digest: Digest,
    recipe: String,
    #[serde(default)]
    sources: Vec<Source>,
    #[serde(default)]
    export: Vec<ExportPin>,
}

impl LockFile {
    /// Reads the lock file at `path`.
    ///
    /// # Errors
    /// When it cannot be read or is not a lock file.
    pub fn read(path: &Path) -> Result<Self, LockFileError> {
        Self::parse(&read_text(path)?, path)
    }

    /// The lock file at `path` whose text this is.
    ///
    /// # Errors
    /// When the text is no lock file, or pins the file at `path` itself.
    pub fn parse(text: &str, path: &Path) -> Result<Self, LockFileError> {
        let (pins, sources) = parse(text)?;
        let lock = Self { pins, sources, folder: path.parent().map(Path::to_owned).unwrap_or_default() };
        if let Some(name) = path.file_name()
            && let Some(pinned) = lock.paths().find(|pinned| plain(pinned) == Path::new(name))
        {
            return Err(LockFileError::Path(pinned.display().to_string()));
        }
        Ok(lock)
    }

    fn paths(&self) -> impl Iterator<Item = &Path> {
        paths(&self.pins)
    }
}

/// The text of the lock file at `path`.
///
/// # Errors
/// When it cannot be read, is longer than 4 MiB or not UTF-8.
pub fn read_text(path: &Path) -> Result<String, LockFileError> {
    let bytes = read_file(path, LIMIT_BYTES).map_err(|source| LockFileError::Read { source })?;
    String::from_utf8(bytes).map_err(|error| LockFileError::Syntax(format!("not UTF-8: {}", error.utf8_error())))
}

/// The pins and the project's sources in the text of a lock file.
pub(super) fn parse(text: &str) -> Result<(Vec<Pin>, Vec<Source>), LockFileError> {
    // The version first: what another version has may look like a fault.
    let Head { version } = toml_edit::de::from_str(text).map_err(syntax)?;
    let (pins, sources): (Vec<Pin>, _) = match version {
        1 => {
            let Document::<OldTable> { table, sources, .. } = toml_edit::de::from_str(text).map_err(syntax)?;
            (table.into_iter().map(old_pin).collect::<Result<_, _>>()?, sources)
        }
        version if version == i64::from(VERSION) => {
            let Document::<NewTable> { table, sources, .. } = toml_edit::de::from_str(text).map_err(syntax)?;
            (table.into_iter().map(new_pin).collect::<Result<_, _>>()?, sources)
        }
        other => return Err(LockFileError::Version(other)),
    };
    check_pins(&pins)?;
    Ok((pins, sources))
}

fn old_pin(OldTable { name, digest, path, bytes, server }: OldTable) -> Result<Pin, LockFileError> {
    let sources = server.as_deref().map(Source::server).transpose().map_err(syntax)?;
    Ok(Pin { name, path, digest, bytes, recipe: None, sources: sources.into_iter().collect(), exports: vec![] })
}

fn new_pin(table: NewTable) -> Result<Pin, LockFileError> {
    let NewTable { name, path, digest, bytes, recipe_digest: stated, recipe, sources, export } = table;
    let read = recipe_document::parse_stored(recipe.as_bytes())
        .map_err(|source| LockFileError::Recipe { name: name.clone(), source })?;
    let actual = recipe_document::digest(&read);
    if actual != stated {
        return Err(LockFileError::RecipeDigest { name, stated, actual });
    }
    Ok(Pin { name, path, digest, bytes: Some(bytes), recipe: Some(recipe), sources, exports: export })
}

/// Checks the names and paths of pins, before anything is done with them.
///
/// # Errors
/// A name or path that is not allowed, or that two pins share.
pub fn check_pins(pins: &[Pin]) -> Result<(), LockFileError> {
    let mut names = BTreeSet::new();
    for pin in pins {
        if pin.name.is_empty() || pin.name.contains(char::is_control) {
            return Err(LockFileError::Name(pin.name.clone()));
        }
        if !names.insert(&pin.name) {
            return Err(LockFileError::Twice { owners: "tables", what: "name", value: pin.name.clone() });
        }
        for export in &pin.exports {
            check_path(&export.to, true)?;
        }
    }
    let mut seen = BTreeSet::new();
    for path in paths(pins) {
        check_path(path, false)?;
        if !seen.insert(plain(path)) {
            return Err(LockFileError::Twice { owners: "files", what: "path", value: path.display().to_string() });
        }
    }
    Ok(())
}

/// Each file that is pinned.
fn paths(pins: &[Pin]) -> impl Iterator<Item = &Path> {
    pins.iter().flat_map(|pin| {
        let files = pin.exports.iter().flat_map(|export| &export.file).map(|file| file.path.as_path());
        std::iter::once(pin.path.as_path()).chain(files)
    })
}

/// A path without `.` in it.
fn plain(path: &Path) -> PathBuf {
    path.components().filter(|part| *part != Component::CurDir).collect()
}

/// A lock file comes with a checkout, so it must not cause writes outside of it.
fn check_path(path: &Path, is_folder: bool) -> Result<(), LockFileError> {
    let Some(text) = path.to_str() else { return Err(LockFileError::NotText(path.display().to_string())) };
    let stays = path.components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir));
    let is_named = is_folder && path.components().next().is_some() || path.file_name().is_some();
    let prints = !text.contains(char::is_control);
    if stays && is_named && prints { Ok(()) } else { Err(LockFileError::Path(text.to_owned())) }
}

pub(super) fn syntax(error: impl std::fmt::Display) -> LockFileError {
    LockFileError::Syntax(error.to_string())
}

#[cfg(test)]
mod tests;
