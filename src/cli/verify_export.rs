//! `verify` for the files of an export: compares them with their manifest, and with a new export of the recipe.

use std::path::{Component, Path, PathBuf};

use serde::Deserialize;
use serde_json::value::RawValue;

use super::{CommandFailure, Fitting, exit, file_failure};
use ltcforge_files::{bounded::read_file, container::decode_any, digest::Digest};
use ltcforge_textures::MANIFEST;

/// Maximum size of a manifest.
const MANIFEST_LIMIT: u64 = 4 << 20;

/// The part of `ltcforge.json` that is checked here.
#[derive(Debug, Deserialize)]
struct Manifest {
    #[serde(rename = "for")]
    engine: Option<String>,
    export: Option<String>,
    about: Vec<String>,
    files: Vec<Listed>,
    recipe: Option<Box<RawValue>>,
}

#[derive(Debug, Deserialize)]
struct Listed {
    path: PathBuf,
    bytes: u64,
    sha256: String,
}

/// The manifest of an export, from the manifest's path or its folder.
pub(super) fn manifest_of(name: &Path) -> Option<PathBuf> {
    if name.is_dir() {
        return Some(name.join(MANIFEST));
    }
    name.file_name().is_some_and(|name| name == MANIFEST).then(|| name.to_owned())
}

/// Checks that all files of an export have the bytes that the manifest states. With `fitting`, also fits the recipe,
/// exports the table again, and compares all files and the manifest. Returns the table's digest.
///
/// # Errors
/// When a file cannot be read or has other bytes, or when the manifest is invalid or lacks a recipe to fit.
pub(super) fn check(
    manifest: &Path,
    limit_bytes: u64,
    fitting: Option<&Fitting<'_>>,
) -> Result<Digest, CommandFailure> {
    let mismatch = |reason: &str| exit::mismatch(manifest, reason);
    let text = read_file(manifest, MANIFEST_LIMIT).map_err(|error| file_failure(manifest, &error))?;
    let read: Manifest =
        serde_json::from_slice(&text).map_err(|error| mismatch(&format!("not a manifest of an export: {error}")))?;
    let table = read.about.iter().find_map(|line| line.strip_prefix("table ")?.parse::<Digest>().ok());
    let table = table.ok_or_else(|| mismatch("the manifest does not name a table"))?;
    let folder = manifest.parent().unwrap_or(Path::new(""));
    let mut here = vec![(PathBuf::from(MANIFEST), text)];
    for Listed { path, bytes, sha256 } in &read.files {
        let is_below = path.components().all(|part| matches!(part, Component::Normal(_)));
        if !is_below {
            return Err(mismatch(&format!("the file «{}» is outside the manifest's folder", path.display())));
        }
        let file = folder.join(path);
        let found = read_file(&file, limit_bytes).map_err(|error| file_failure(&file, &error))?;
        if found.len() as u64 != *bytes || Digest::of(&found).hex() != *sha256 {
            let (found, actual) = (found.len(), Digest::of(&found).hex());
            let reason = format!("expected {bytes} bytes with sha256 {sha256}, found {found} bytes with {actual}");
            return Err(exit::mismatch(&file, reason));
        }
        here.push((path.clone(), found));
    }
    let Some(fitting) = fitting else { return Ok(table) };
    let recipe =
        read.recipe.as_ref().ok_or_else(|| mismatch("the manifest has no recipe to fit: export the table again"))?;
    let bytes = fitting.fit(&fitting.recipe(manifest, recipe.get().as_bytes())?)?;
    let fitted = Digest::of(&bytes);
    if fitted != table {
        return Err(mismatch(&format!("the files belong to table {table}, but fitting their recipe gives {fitted}")));
    }
    let name = read.engine.or(read.export).ok_or_else(|| mismatch("the manifest does not name an export"))?;
    let file = decode_any(&bytes).map_err(|error| mismatch(&error.to_string()))?;
    let made_by = read.about.first().map(String::as_str).unwrap_or_default();
    for made in &fitting.measure(file, table)?.files(&name)? {
        let found = here.iter().find(|(path, _)| *path == Path::new(&made.path));
        let what = match found {
            Some((_, bytes)) if *bytes == made.bytes => continue,
            Some(_) => "has other bytes",
            None => "is missing",
        };
        let version = concat!("ltcforge ", env!("CARGO_PKG_VERSION"));
        let path = &made.path;
        let why = format!("exported again, {path} {what}; the files were made by {made_by}, this is {version}");
        return Err(mismatch(&why));
    }
    Ok(table)
}
