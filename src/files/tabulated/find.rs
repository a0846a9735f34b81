//! Finds the files of tabulated BRDFs.

use std::path::{Path, PathBuf};

use super::{TABULATED_LIMIT_BYTES, TabulatedError, decode};
use crate::{bounded::read_file, digest::Digest};
use ltcforge_fit::TabulatedFile;

/// A function that finds the file that a recipe names, or returns all errors, one per line.
pub type FindBrdf<'a> = dyn Fn(&str) -> Result<TabulatedFile, Vec<String>> + 'a;

/// A [`FindBrdf`] that finds nothing, for documents that name no file.
///
/// # Errors
/// Always.
pub fn no_files(name: &str) -> Result<TabulatedFile, Vec<String>> {
    Err(vec![format!("{name:?}: BRDF files are not available here")])
}

/// The name of a tabulated BRDF's file in the folder of the tables that were fitted to it.
#[must_use]
pub fn kept_name(digest: &[u8; 32]) -> String {
    format!("{}.brdf.safetensors", Digest::from_bytes(*digest).hex())
}

/// A file that was found.
pub struct Located {
    /// The part of the file that a recipe contains.
    pub file: TabulatedFile,
    /// The bytes of the file.
    pub bytes: Vec<u8>,
}

/// Finds files on disk. A digest names a file with its [`kept_name`] in one of `folders`. Any other name is a path,
/// relative to the first folder.
///
/// # Errors
/// The file is missing, cannot be read, is not a tabulated BRDF, or does not have the digest in its name.
pub fn locate(folders: &[PathBuf], name: &str) -> Result<Located, Vec<String>> {
    let digest: Option<Digest> = name.parse().ok();
    let Some(digest) = digest else {
        if name.starts_with("sha256:") {
            return Err(vec![format!("{name:?} is not a digest, sha256:<64 hex digits>")]);
        }
        let path = folders.first().map_or_else(|| PathBuf::from(name), |folder| folder.join(name));
        return read_path(&path);
    };
    let kept = kept_name(digest.as_bytes());
    let Some(path) = folders.iter().map(|folder| folder.join(&kept)).find(|path| path.exists()) else {
        let places: Vec<String> = folders.iter().map(|folder| folder.join("").display().to_string()).collect();
        return Err(vec![format!("{digest}: {kept} is missing in {}", places.join(" and "))]);
    };
    let found = read_path(&path)?;
    if found.file.digest() == digest.as_bytes() {
        Ok(found)
    } else {
        Err(vec![format!("{}: its digest is {}; the file is damaged or another file", path.display(), found.file)])
    }
}

fn read_path(path: &Path) -> Result<Located, Vec<String>> {
    let named = |fault: &dyn std::fmt::Display| format!("{}: {fault}", path.display());
    let bytes = read_file(path, TABULATED_LIMIT_BYTES).map_err(|error| vec![named(&error)])?;
    match decode(&bytes) {
        Ok(file) => Ok(Located { file, bytes }),
        Err(TabulatedError(faults)) => Err(faults.iter().map(|fault| named(fault)).collect()),
    }
}
