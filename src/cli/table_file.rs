//! Finds table files by their digests, checks them, and writes them.

use std::{
    collections::BTreeMap,
    fs, io,
    path::{Path, PathBuf},
};

use super::{CommandFailure, failed, file_failure, mismatch, usage};
use ltcforge_files::{
    bounded::read_named,
    container::{AnyFile, decode_any},
    digest::Digest,
    replace::replace_pair,
    text::other_form,
};

/// The folders that are searched for tables by default: the output folder of `fit`, and the folder that the manual
/// uses.
pub(super) const TABLE_FOLDERS: [&str; 2] = [".", "tables"];

/// Finds a table by its path, its digest, or the first digits of its digest, which `fit` prints. Returns its path. A
/// digest is searched for in `folder`, by default in each of [`TABLE_FOLDERS`].
///
/// # Errors
/// When there is no such table, or several digests begin with these digits.
pub(super) fn table_path(name: &Path, folder: Option<&Path>) -> Result<PathBuf, CommandFailure> {
    // A name that is not UTF-8 is a path.
    let text = name.to_str().unwrap_or_default();
    let beginning = text.strip_prefix("sha256:").unwrap_or(text).to_ascii_lowercase();
    let is_digest = !beginning.is_empty() && beginning.bytes().all(|byte| byte.is_ascii_hexdigit());
    if name.exists() || !is_digest {
        return Ok(name.to_owned());
    }
    let folders: Vec<&Path> = folder.map_or_else(|| TABLE_FOLDERS.map(Path::new).into(), |folder| vec![folder]);
    // The same digest in two folders is the same table.
    let mut found: BTreeMap<String, PathBuf> = BTreeMap::new();
    for looked_in in &folders {
        let entries = match fs::read_dir(looked_in) {
            Ok(entries) => entries,
            Err(error) if error.kind() == io::ErrorKind::NotFound && folder.is_none() => continue,
            Err(error) => return Err(file_failure(looked_in, &error)),
        };
        for entry in entries {
            let name = entry.map_err(|error| file_failure(looked_in, &error))?.file_name();
            let Some(stem) = name.to_str().and_then(|name| name.strip_suffix(".safetensors")) else { continue };
            if stem.len() == 64 && stem.starts_with(&beginning) {
                let path = if *looked_in == Path::new(".") { PathBuf::from(&name) } else { looked_in.join(&name) };
                found.entry(stem.to_owned()).or_insert(path);
            }
        }
    }
    let count = found.len();
    let looked_in: Vec<String> = folders.iter().map(|folder| folder.join("").display().to_string()).collect();
    let (places, other) =
        (looked_in.join(" and "), if folder.is_none() { "; use --tables to search another folder" } else { "" });
    match found.into_values().next() {
        Some(path) if count == 1 => Ok(path),
        Some(_) => Err(usage(format!("{beginning}: {count} tables in {places} begin with these digits; add more"))),
        None => {
            Err(failed(format!("{text}: there is no such file, and no {beginning}*.safetensors in {places}{other}")))
        }
    }
}

/// Reads a table file of at most `limit_bytes`.
///
/// # Errors
/// When the file cannot be read or is too long.
pub(super) fn read(path: &Path, limit_bytes: u64) -> Result<Vec<u8>, CommandFailure> {
    read_named(path, limit_bytes).map_err(|error| file_failure(path, &error))
}

/// Checks and decodes a table file. It must hash to `expected`, or else to the digest in its name, if there is one.
pub(super) fn check(path: &Path, bytes: &[u8], expected: Option<Digest>) -> Result<(Digest, AnyFile), CommandFailure> {
    let actual = Digest::of(bytes);
    if let Some(expected) = expected.or_else(|| digest_in_name(path))
        && actual != expected
    {
        let reason = || format!("the file has digest {actual}, expected {expected}");
        return Err(mismatch(path, other_form(bytes).unwrap_or_else(reason)));
    }
    let file = decode_any(bytes).map_err(|error| mismatch(path, error))?;
    Ok((actual, file))
}

/// The digest in the name of a file.
pub(super) fn digest_in_name(path: &Path) -> Option<Digest> {
    path.file_name()?.to_str()?.split('.').next()?.parse().ok()
}

/// Writes a table's file and its manifest to the folder `out`, and returns the digest and the paths. The table is
/// written first: if the process ends in between, there is no manifest without its table.
pub(super) fn replace(out: &Path, file: &[u8], manifest: &str) -> Result<(Digest, [PathBuf; 2]), CommandFailure> {
    let digest = Digest::of(file);
    let paths = ["safetensors", "manifest.json"].map(|extension| out.join(format!("{}.{extension}", digest.hex())));
    replace_pair((&paths[0], file), (&paths[1], manifest.as_bytes()))
        .map_err(|error| file_failure(&error.path, &error.source))?;
    Ok((digest, paths))
}

#[cfg(test)]
mod tests {
    use super::{super::Exit, *};

    #[test]
    fn a_digest_is_found_by_a_unique_beginning() {
        let folder = tempfile::tempdir().expect("a folder");
        for hex in ["ab".repeat(32), "ac".repeat(32)] {
            fs::write(folder.path().join(format!("{hex}.safetensors")), "").expect("a file");
        }
        let find = |name: &str| table_path(Path::new(name), Some(folder.path()));
        let expected = folder.path().join(format!("{}.safetensors", "ab".repeat(32)));
        assert_eq!(find("sha256:AB").expect("one"), expected);
        assert_eq!(find("a").expect_err("two").exit, Exit::Usage);
        let refused = find("sha256:ff").expect_err("none");
        assert_eq!(refused.exit, Exit::Failed);
        let expected = format!("no ff*.safetensors in {}/", folder.path().display());
        assert!(refused.message.ends_with(&expected), "{}", refused.message);
        assert_eq!(find("some/file").expect("a path"), PathBuf::from("some/file"));
    }

    #[test]
    fn a_name_may_hold_a_digest() {
        let hex = Digest::of(b"abc").hex();
        assert_eq!(digest_in_name(Path::new(&format!("a/{hex}.safetensors"))), Some(Digest::of(b"abc")));
        assert_eq!(digest_in_name(Path::new("a/metal.safetensors")), None);
    }
}
