//! The pins of a project: tables, and files that are made from them.

use std::{
    collections::BTreeMap,
    ffi::OsStr,
    path::{Component, Path, PathBuf},
};

use serde::Deserialize;
use unicode_normalization::UnicodeNormalization as _;

use super::{Source, Wanted, error::is_hidden, lock_error::LockFileError};
use ltcforge_files::digest::Digest;

/// One table that a project uses.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Pin {
    /// The name of the table in the project.
    pub name: String,
    /// The path of the table's file, relative to the lock file's folder and below it.
    pub path: PathBuf,
    /// The digest of the table's file.
    pub digest: Digest,
    /// The size of the table's file. A file of another size is rejected. A pin of version 1 may lack the size.
    pub bytes: Option<u64>,
    /// The recipe document, to fit the table again. A pin of version 1 lacks it.
    pub recipe: Option<String>,
    /// The sources that are tried before the sources of the project.
    pub sources: Vec<Source>,
    /// The files that are made from the table.
    pub exports: Vec<ExportPin>,
}

/// Files that are made from a table, with their paths and digests. The first four fields are arguments of
/// `ltcforge export`, as text.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ExportPin {
    /// The engine that loads the files.
    #[serde(default, rename = "for")]
    pub engine: Option<String>,
    /// The layout of the textures, if there is no engine. A compact form has the layout of its table.
    #[serde(default)]
    pub layout: Option<String>,
    /// The format of the files, if there is no engine.
    #[serde(default)]
    pub container: Option<String>,
    /// The number format of the files, as in recipes, if there is no engine.
    #[serde(default)]
    pub precision: Option<String>,
    /// The folder of the files, relative to the lock file's folder and below it.
    pub to: PathBuf,
    /// The files.
    pub file: Vec<FilePin>,
}

/// A file that is made from a table.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FilePin {
    /// The path of the file, relative to the lock file's folder and below it.
    pub path: PathBuf,
    /// The size of the file.
    pub bytes: u64,
    /// The SHA-256 of the file.
    pub digest: Digest,
}

impl ExportPin {
    /// The name that a service uses for this export: the engine, or `LAYOUT.CONTAINER.PRECISION`, or the compact form,
    /// or for a lookup table `CONTAINER` or `CONTAINER.PRECISION`.
    /// `None` if the fields do not name an export.
    #[must_use]
    pub fn name(&self) -> Option<String> {
        let name = match (&self.engine, &self.layout, &self.container) {
            (Some(engine), None, None) => engine.clone(),
            (None, Some(layout), Some(container)) => {
                // `ltcforge export` has the same default.
                let precision = self.precision.as_deref().unwrap_or("f32");
                format!("{layout}.{container}.{precision}")
            }
            (None, None, Some(container)) => match &self.precision {
                Some(precision) => format!("{container}.{precision}"),
                None => container.clone(),
            },
            _ => return None,
        };
        is_plain(&name).then_some(name)
    }

    /// The path of one of the files within the export, with `/` between names; `None` for a path that no export has.
    fn path_of(&self, file: &FilePin) -> Option<String> {
        let names = file.path.strip_prefix(&self.to).ok()?.iter();
        let names: Option<Vec<&str>> = names.map(|name| name.to_str().filter(|name| is_plain(name))).collect();
        names.filter(|names| !names.is_empty()).map(|names| names.join("/"))
    }

    /// The request for a file of this export of `table`; `None` for an export or a path that no service has.
    #[must_use]
    pub fn wanted(&self, table: Digest, file: &FilePin) -> Option<Wanted> {
        let FilePin { digest, bytes, .. } = *file;
        let path = format!("/v1/tables/{table}/exports/{}/{}?digest={digest}", self.name()?, self.path_of(file)?);
        Some(Wanted { digest, stated_bytes: Some(bytes), path })
    }

    /// Whether `other` requests the same files.
    #[must_use]
    pub fn requests_same_as(&self, other: &Self) -> bool {
        Self { file: vec![], ..self.clone() } == Self { file: vec![], ..other.clone() }
    }
}

/// Whether a text needs no escapes in a URL, and is neither `.` nor `..`.
fn is_plain(text: &str) -> bool {
    let is_allowed = |c: char| c.is_ascii_alphanumeric() || matches!(c, '.' | '-' | '_');
    text.chars().all(is_allowed) && text.chars().any(|c| c != '.')
}

/// Checks the names and paths of pins before they are used.
///
/// # Errors
/// When a name or path is not allowed, or two pins share one.
pub fn check_pins(pins: &[Pin]) -> Result<(), LockFileError> {
    let mut names = BTreeMap::new();
    for pin in pins {
        if pin.name.is_empty() || pin.name.contains(is_hidden) {
            return Err(LockFileError::Name(pin.name.clone()));
        }
        check_once(&mut names, ("tables", "name"), &pin.name)?;
        for export in &pin.exports {
            check_path(&export.to, true)?;
        }
    }
    let mut seen = BTreeMap::new();
    for path in paths(pins) {
        check_path(path, false)?;
        check_once(&mut seen, ("files", "path"), &plain(path).display().to_string())?;
    }
    Ok(())
}

/// Adds a name to `seen`. Fails if `seen` has the same name, or one that differs only in case or Unicode form, which
/// some systems ignore.
fn check_once(
    seen: &mut BTreeMap<String, String>,
    (owners, what): (&'static str, &'static str),
    name: &str,
) -> Result<(), LockFileError> {
    // Lower case alone would keep a final sigma different from other sigmas.
    let folded = name.nfkc().collect::<String>().to_uppercase().to_lowercase().nfkc().collect();
    match seen.insert(folded, name.to_owned()) {
        None => Ok(()),
        Some(other) if other == name => Err(LockFileError::Twice { owners, what, value: other }),
        Some(value) => Err(LockFileError::Alike { owners, what, value, other: name.to_owned() }),
    }
}

/// The path of each pinned file.
pub(super) fn paths(pins: &[Pin]) -> impl Iterator<Item = &Path> {
    pins.iter().flat_map(|pin| {
        let files = pin.exports.iter().flat_map(|export| &export.file).map(|file| file.path.as_path());
        std::iter::once(pin.path.as_path()).chain(files)
    })
}

/// A path without `.` components.
pub(super) fn plain(path: &Path) -> PathBuf {
    path.components().filter(|part| *part != Component::CurDir).collect()
}

/// Why a reserved name is not allowed.
pub(super) const KEPT: &str =
    "version control, editors and tools keep their own files under names that begin with a dot, or have ~ and a digit";

/// Whether a name is reserved for version control, editors and tools. Some of them run the files that they find. Such
/// names begin with a dot, or are short names that Windows gives to these files, such as `GIT~1`.
pub(super) fn is_kept(name: &OsStr) -> bool {
    let bytes = name.as_encoded_bytes();
    bytes.starts_with(b".") || bytes.windows(2).any(|pair| pair[0] == b'~' && pair[1].is_ascii_digit())
}

/// Rejects an unsafe path. A lock file comes with a checkout, so it must not cause writes outside the checkout or into
/// the files of version control, editors and tools. Its paths must also mean the same on every system.
fn check_path(path: &Path, is_folder: bool) -> Result<(), LockFileError> {
    let Some(text) = path.to_str() else { return Err(LockFileError::NotText(path.display().to_string())) };
    let refused = |reason| Err(LockFileError::Path { path: text.to_owned(), reason });
    if text.contains(is_hidden) {
        return refused("it has characters that do not print");
    }
    let stays = path.components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir));
    let is_named = is_folder && path.components().next().is_some() || path.file_name().is_some();
    if !stays || !is_named {
        return refused("a path must be relative, name a file, and stay below the lock file's folder");
    }
    for name in text.split('/') {
        if name.contains(['\\', ':', '*', '?', '"', '<', '>', '|']) {
            return refused("not every system allows \\ : * ? \" < > | in names; separate folders with /");
        }
        // Windows ignores dots and blanks at the end of a name.
        let bare = name.trim_end_matches(['.', ' ']);
        if bare != name && !bare.is_empty() {
            return refused("not every system allows names that end in a dot or a blank");
        }
        if name != "." && is_kept(OsStr::new(name)) {
            return refused(KEPT);
        }
        if is_device(name) {
            return refused("Windows has a device with this name");
        }
    }
    Ok(())
}

/// Whether Windows treats a name as a device. Windows ignores everything after the first dot.
fn is_device(name: &str) -> bool {
    let stem = name.split('.').next().unwrap_or_default().trim_end_matches(' ').to_ascii_uppercase();
    let numbered = stem.strip_prefix("COM").or(stem.strip_prefix("LPT"));
    let is_digit = |rest: &str| {
        matches!(rest, "\u{b9}" | "\u{b2}" | "\u{b3}") || rest.len() == 1 && rest.as_bytes()[0].is_ascii_digit()
    };
    ["CON", "PRN", "AUX", "NUL", "CONIN$", "CONOUT$"].contains(&stem.as_str()) || numbered.is_some_and(is_digit)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn export(engine: Option<&str>, to: &str, path: &str) -> ExportPin {
        let file = FilePin { path: path.into(), bytes: 1, digest: Digest::of(b"x") };
        let engine = engine.map(str::to_owned);
        ExportPin { engine, layout: None, container: None, precision: None, to: to.into(), file: vec![file] }
    }

    #[test]
    fn paths_mean_the_same_everywhere_and_lead_into_no_repository() {
        for (path, said) in [
            (".git/config", "version control"),
            ("a/.GIT/hooks/x", "version control"),
            ("GIT~1/config", "version control"),
            ("a/git~2", "version control"),
            (".vscode/tasks.json", "version control"),
            (".idea/x", "version control"),
            ("a/.github/workflows/x", "version control"),
            ("a/.envrc", "version control"),
            (".git./config", "dot or a blank"),
            ("a /b", "dot or a blank"),
            ("CON.safetensors", "device"),
            ("a/nul", "device"),
            ("com1.x.y", "device"),
            ("lpt\u{b2}", "device"),
            ("a\\b", "separate folders"),
            ("c:x", "separate folders"),
            ("a\u{202e}b", "do not print"),
            ("a\u{2066}b", "do not print"),
            ("a\u{feff}b", "do not print"),
            ("../x", "stay below"),
        ] {
            let refused = check_path(Path::new(path), false).expect_err(path).to_string();
            assert!(refused.contains(said) && !refused.contains(is_hidden), "{path:?}: {refused}");
        }
        for path in ["./a/b", "a~/b", "console.bin", "com10", "git", "\u{e4}/\u{65e5} b.x"] {
            check_path(Path::new(path), false).unwrap_or_else(|error| panic!("{error}"));
        }
        let pin = |name: &str| Pin {
            name: name.into(),
            path: "a".into(),
            digest: Digest::of(b""),
            bytes: None,
            recipe: None,
            sources: vec![],
            exports: vec![],
        };
        assert!(matches!(check_pins(&[pin("a\u{202e}")]), Err(LockFileError::Name(_))));
        check_pins(&[pin("a b")]).expect("a name");
    }

    #[test]
    fn names_and_paths_that_urls_cannot_contain_are_none() {
        let three = export(Some("three"), "a/b", "a/b/areaLights/x.bin");
        assert_eq!(three.name().as_deref(), Some("three"));
        assert_eq!(three.path_of(&three.file[0]).as_deref(), Some("areaLights/x.bin"));
        for engine in ["", ".", "..", "a/b", "a?b", "a b", "%2e"] {
            assert_eq!(export(Some(engine), "a", "a/b").name(), None, "{engine}");
        }
        assert_eq!(export(None, "a", "a/b").name(), None);
        for (to, path) in [("a", "b/c"), ("a", "a"), ("a", "a/x?y"), ("a", "a/x#y")] {
            let other = export(Some("three"), to, path);
            assert_eq!(other.path_of(&other.file[0]), None, "{path}");
        }
    }
}
