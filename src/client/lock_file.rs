//! `ltcforge.lock`: the tables that a project uses, pinned by hash. `ltcforge lock` writes it and keeps comments.
//!
//! ```toml
//! version = 2
//! sources = ["https://ltc.example.org", "../tables"] # optional: tried in this order
//!
//! [[table]]
//! name = "metal"
//! path = "assets/metal.safetensors"
//! digest = "sha256:ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"
//! bytes = 77880
//! recipe_digest = "sha256:cb8379ac2098aa165029e3938a51da0bcecfc008fd6795f401178647f96c5b34"
//! recipe = '{"brdf":"ggx", ...}' # canonical JSON
//! sources = ["https://other.example.org"] # optional: tried before the project's
//!
//! [[table.export]]
//! for = "wgpu" # or layout, container and precision; or container = "compact-js"
//! to = "assets/ltc"
//! file = [
//!     { path = "assets/ltc/ltc_matrix_a.ktx2", bytes = 1352, digest = "sha256:..." },
//! ]
//! ```
//!
//! Version 1 had no recipes and no exports. It had `server` instead of a table's sources. It can still be read.

use std::path::{Path, PathBuf};

use serde::Deserialize;

use super::{
    Source,
    lock_error::{LockFileError, VERSION, syntax},
    pin::{ExportPin, Pin, check_pins, paths, plain},
};
use ltcforge_files::{
    bounded::read_file,
    digest::Digest,
    recipe_document,
    text::{other_form, without_mark},
};

/// Maximum size of a lock file, enough for a few thousand pins.
const LIMIT_BYTES: u64 = 4 << 20;

/// A project's pins.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct LockFile {
    /// The pins in the order of the file. No two have the same name or path.
    pub pins: Vec<Pin>,
    /// The sources of tables.
    pub sources: Vec<Source>,
    /// The folder that paths are relative to.
    pub folder: PathBuf,
}

/// The part that every version of the lock file has.
#[derive(Debug, Deserialize)]
struct Head {
    version: i64,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Document {
    version: i64,
    #[serde(default)]
    sources: Vec<Source>,
    #[serde(default)]
    table: Vec<Table>,
}

/// A table of either version.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Table {
    name: String,
    path: PathBuf,
    digest: Digest,
    bytes: Option<u64>,
    recipe_digest: Option<Digest>,
    recipe: Option<String>,
    #[serde(default)]
    sources: Vec<Source>,
    #[serde(default)]
    export: Vec<ExportPin>,
    /// Only in version 1.
    server: Option<String>,
}

impl LockFile {
    /// Reads the lock file at `path`.
    ///
    /// # Errors
    /// When the file cannot be read or is not a lock file.
    pub fn read(path: &Path) -> Result<Self, LockFileError> {
        Self::parse(&read_text(path)?, path)
    }

    /// Every pinned file with its pin, digest and size: the table of each pin, then its exported files.
    pub fn files(&self) -> impl Iterator<Item = (&Pin, &Path, Digest, Option<u64>)> {
        self.pins.iter().flat_map(|pin| {
            let exported = pin.exports.iter().flat_map(|export| &export.file);
            let exported = exported.map(move |file| (pin, &*file.path, file.digest, Some(file.bytes)));
            std::iter::once((pin, &*pin.path, pin.digest, pin.bytes)).chain(exported)
        })
    }

    /// Reads the text of the lock file at `path`.
    ///
    /// # Errors
    /// When the text is not a lock file, or pins the file at `path` itself.
    pub fn parse(text: &str, path: &Path) -> Result<Self, LockFileError> {
        let (pins, sources) = parse(text)?;
        let lock = Self { pins, sources, folder: path.parent().map(Path::to_owned).unwrap_or_default() };
        if let Some(name) = path.file_name()
            && let Some(pinned) = paths(&lock.pins).find(|pinned| plain(pinned) == Path::new(name))
        {
            let path = pinned.display().to_string();
            return Err(LockFileError::Path { path, reason: "it is the lock file itself" });
        }
        Ok(lock)
    }
}

/// Reads the text of the lock file at `path`.
///
/// # Errors
/// When the file cannot be read, is longer than 4 MiB or not UTF-8.
pub fn read_text(path: &Path) -> Result<String, LockFileError> {
    let bytes = read_file(path, LIMIT_BYTES).map_err(|source| LockFileError::Read { source })?;
    let text = str::from_utf8(without_mark(&bytes));
    text.map(str::to_owned)
        .map_err(|error| LockFileError::Syntax(other_form(&bytes).unwrap_or_else(|| format!("not UTF-8: {error}"))))
}

/// The pins and the project's sources in the text of a lock file.
pub(super) fn parse(text: &str) -> Result<(Vec<Pin>, Vec<Source>), LockFileError> {
    // The version is read first, because the fields of another version would look like faults.
    let Head { version } = toml_edit::de::from_str(text)
        .map_err(|error| other_form(text.as_bytes()).map_or_else(|| syntax(error), LockFileError::Syntax))?;
    if !(1..=i64::from(VERSION)).contains(&version) {
        return Err(LockFileError::Version(version));
    }
    let Document { version, sources, table } = toml_edit::de::from_str(text).map_err(syntax)?;
    let pins = table.into_iter().map(|table| pin_of(table, version == 1)).collect::<Result<Vec<_>, _>>()?;
    check_pins(&pins)?;
    Ok((pins, sources))
}

fn pin_of(table: Table, is_old: bool) -> Result<Pin, LockFileError> {
    let Table { name, path, digest, bytes, recipe_digest, recipe, mut sources, export: exports, server } = table;
    if let Some(server) = &server {
        if !is_old {
            return Err(syntax("since version 2, a table has «sources» instead of «server»"));
        }
        sources.push(Source::server(server).map_err(syntax)?);
    }
    let incomplete = |field| LockFileError::Incomplete { name: name.clone(), field };
    match (&recipe, recipe_digest) {
        (Some(recipe), Some(stated)) => {
            let read = recipe_document::parse_any_stored(recipe.as_bytes())
                .map_err(|source| LockFileError::Recipe { name: name.clone(), source })?;
            let actual = recipe_document::digest(&read);
            if actual != stated {
                return Err(LockFileError::RecipeDigest { name, stated, actual });
            }
        }
        (None, None) if is_old => {}
        (None, _) => return Err(incomplete("recipe")),
        (_, None) => return Err(incomplete("recipe_digest")),
    }
    if bytes.is_none() && !is_old {
        return Err(incomplete("bytes"));
    }
    Ok(Pin { name, path, digest, bytes, recipe, sources, exports })
}

#[cfg(test)]
mod tests;
