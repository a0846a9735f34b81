//! `ltcforge.lock`: the tables that a project uses, by hash. It may be edited by hand; comments are preserved.
//!
//! ```toml
//! version = 1
//!
//! [[table]]
//! name = "metal"
//! digest = "sha256:ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"
//! path = "assets/metal.safetensors"
//! bytes = 77880 # optional: no longer file is downloaded
//! server = "https://ltc.example.org" # optional
//! ```

use std::{
    collections::BTreeSet,
    io,
    path::{Component, Path, PathBuf},
};

use serde::Deserialize;
use toml_edit::{ArrayOfTables, DocumentMut, Item, Table, value};

use crate::files::{bounded::read_file, digest::Digest};

/// The only version of the format.
const VERSION: u32 = 1;

/// Longest lock file that is read: some ten thousand pins.
const LIMIT_BYTES: u64 = 4 << 20;

/// One table that a project uses.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Pin {
    /// Its name in the project.
    pub name: String,
    /// Its digest.
    pub digest: Digest,
    /// Where its file is: relative to the lock file's folder, and below it.
    pub path: PathBuf,
    /// Its size: a longer download is cut off.
    #[serde(default)]
    pub bytes: Option<u64>,
    /// The server that has it, if not the default one.
    #[serde(default)]
    pub server: Option<String>,
}

/// A project's pins.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LockFile {
    /// In the order of the file; no two have the same name or path.
    pub pins: Vec<Pin>,
    /// The folder that paths are relative to.
    pub folder: PathBuf,
}

/// Why a lock file cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum LockFileError {
    /// It cannot be read.
    #[error("{}: {source}", .path.display())]
    Read {
        /// The lock file.
        path: PathBuf,
        /// The system's error.
        source: io::Error,
    },
    /// It is not TOML, or not a lock file.
    #[error("{}", .0.trim_end())]
    Syntax(String),
    /// It has another version of the format.
    #[error("the lock file has version {0}; this program knows version {VERSION}")]
    Version(u32),
    /// Two tables share a name or a path.
    #[error("two tables have the {what} «{value}»")]
    Twice {
        /// `name` or `path`.
        what: &'static str,
        /// The value they share.
        value: String,
    },
    /// A path leads out of the lock file's folder.
    #[error("the path «{0}» is not allowed: paths are relative and stay below the lock file's folder")]
    Path(String),
    /// A path cannot be written in a file of text.
    #[error("the path «{0}» is not UTF-8 and cannot be written into a lock file")]
    NotText(String),
    /// A number is greater than TOML allows.
    #[error("a table of {0} bytes is too long for a lock file")]
    Bytes(u64),
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Document {
    version: u32,
    #[serde(default)]
    table: Vec<Pin>,
}

impl LockFile {
    /// Reads the lock file at `path`.
    ///
    /// # Errors
    /// When it cannot be read or is not a lock file.
    pub fn read(path: &Path) -> Result<Self, LockFileError> {
        let text = read_text(path).map_err(|source| LockFileError::Read { path: path.into(), source })?;
        Ok(Self { pins: parse(&text)?, folder: path.parent().map(Path::to_owned).unwrap_or_default() })
    }
}

/// The text of the lock file at `path`.
///
/// # Errors
/// The system's; also when the file is longer than 4 MiB or not UTF-8.
pub fn read_text(path: &Path) -> io::Result<String> {
    let bytes = read_file(path, LIMIT_BYTES)?;
    String::from_utf8(bytes).map_err(|error| io::Error::new(io::ErrorKind::InvalidData, error.utf8_error()))
}

/// The text of a lock file with `pin` added, or replaced if there is one of that name. An empty `text` becomes a new
/// lock file.
///
/// # Errors
/// When `text` is not a lock file or the result would not be one, and when the pin's path is not UTF-8.
pub fn with_pin(text: &str, pin: &Pin) -> Result<String, LockFileError> {
    let mut document: DocumentMut = text.parse().map_err(syntax)?;
    if document.is_empty() {
        document.insert("version", value(i64::from(VERSION)));
    } else {
        parse(text)?;
    }
    let tables = document.entry("table").or_insert_with(|| Item::ArrayOfTables(ArrayOfTables::new()));
    let Some(tables) = tables.as_array_of_tables_mut() else {
        return Err(LockFileError::Syntax("tables are written as [[table]]".into()));
    };
    let same_name = |table: &Table| table.get("name").and_then(Item::as_str) == Some(&pin.name);
    let present = tables.iter().position(same_name);
    if let Some(table) = present.and_then(|index| tables.get_mut(index)) {
        fill(table, pin)?;
    } else {
        let mut table = Table::new();
        fill(&mut table, pin)?;
        tables.push(table);
    }
    let text = document.to_string();
    parse(&text)?;
    Ok(text)
}

fn fill(table: &mut Table, pin: &Pin) -> Result<(), LockFileError> {
    let path = pin.path.to_str().ok_or_else(|| LockFileError::NotText(pin.path.display().to_string()))?;
    table.insert("name", value(&pin.name));
    table.insert("digest", value(pin.digest.to_string()));
    table.insert("path", value(path));
    match pin.bytes {
        Some(bytes) => table.insert("bytes", value(i64::try_from(bytes).map_err(|_| LockFileError::Bytes(bytes))?)),
        None => table.remove("bytes"),
    };
    match &pin.server {
        Some(server) => table.insert("server", value(server)),
        None => table.remove("server"),
    };
    Ok(())
}

fn parse(text: &str) -> Result<Vec<Pin>, LockFileError> {
    let document: Document = toml_edit::de::from_str(text).map_err(syntax)?;
    if document.version != VERSION {
        return Err(LockFileError::Version(document.version));
    }
    let (mut names, mut paths) = (BTreeSet::new(), BTreeSet::new());
    for pin in &document.table {
        check_path(&pin.path)?;
        if !names.insert(&pin.name) {
            return Err(LockFileError::Twice { what: "name", value: pin.name.clone() });
        }
        if !paths.insert(pin.path.components().filter(|part| *part != Component::CurDir).collect::<PathBuf>()) {
            return Err(LockFileError::Twice { what: "path", value: pin.path.display().to_string() });
        }
    }
    Ok(document.table)
}

/// A lock file comes with a checkout, so it must not cause writes outside of it.
fn check_path(path: &Path) -> Result<(), LockFileError> {
    let stays = path.components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir));
    if stays && path.file_name().is_some() { Ok(()) } else { Err(LockFileError::Path(path.display().to_string())) }
}

fn syntax(error: impl std::fmt::Display) -> LockFileError {
    LockFileError::Syntax(error.to_string())
}

#[cfg(test)]
mod tests {
    use std::{ffi::OsStr, os::unix::ffi::OsStrExt as _};

    use super::*;

    fn pin(name: &str, path: &str, server: Option<&str>) -> Pin {
        Pin {
            name: name.into(),
            digest: Digest::of(name.as_bytes()),
            path: path.into(),
            bytes: server.map(|_| 7),
            server: server.map(Into::into),
        }
    }

    #[test]
    fn pins_are_added_and_read_back() {
        let (a, b) = (pin("a", "ltc/a.safetensors", None), pin("b", "b.safetensors", Some("http://h")));
        let text = with_pin(&with_pin("", &a).expect("a new file"), &b).expect("a second pin");
        assert_eq!(parse(&text).expect("a lock file"), [a, b]);
    }

    #[test]
    fn a_pin_of_the_same_name_is_replaced_and_comments_stay() {
        let text = format!(
            "# ours\nversion = 1\n\n# the metal\n[[table]]\nname = \"a\"\ndigest = \"{}\"\npath = \"x\"\nserver = \"http://h\"\n",
            Digest::of(b"old")
        );
        let new = with_pin(&text, &pin("a", "x", None)).expect("a replaced pin");
        assert_eq!(parse(&new).expect("a lock file"), [pin("a", "x", None)]);
        assert!(new.contains("# ours") && new.contains("# the metal"), "{new}");
    }

    #[test]
    fn paths_that_lead_out_are_refused() {
        for path in ["/etc/passwd", "../x", "a/../../x", "", ".", "a/.."] {
            let refused = with_pin("", &pin("a", path, None));
            assert!(matches!(refused, Err(LockFileError::Path(_))), "{path}: {refused:?}");
        }
    }

    #[test]
    fn a_path_that_is_no_text_is_refused() {
        let path = OsStr::from_bytes(b"a\xffb").into();
        let refused = with_pin("", &Pin { path, ..pin("a", "x", None) });
        assert!(matches!(refused, Err(LockFileError::NotText(_))), "{refused:?}");
    }

    #[test]
    fn two_pins_share_neither_name_nor_path() {
        let one = with_pin("", &pin("a", "x", None)).expect("a lock file");
        let refused = with_pin(&one, &pin("b", "./x", None));
        assert!(matches!(refused, Err(LockFileError::Twice { what: "path", .. })), "{refused:?}");
        let twice = format!("{one}\n{}", one.replace("version = 1\n", "").replace("\"x\"", "\"y\""));
        assert!(matches!(parse(&twice), Err(LockFileError::Twice { what: "name", .. })));
    }

    #[test]
    fn other_files_are_refused() {
        assert!(matches!(parse("version = 2"), Err(LockFileError::Version(2))));
        for text in
            ["", "version = 1\ncolour = 2", "version = 1\n[[table]]\nname = \"a\"", "{", "version = 1\ntable = 3"]
        {
            assert!(matches!(parse(text), Err(LockFileError::Syntax(_))), "{text}");
        }
    }
}
