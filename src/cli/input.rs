//! Recipes and tables as the command line names them.

use std::{
    fs,
    io::{self, Read as _},
    path::{Path, PathBuf},
};

use super::{Exit, Failure, args::TableChoice, file_failure, verify};
use crate::{
    files::{
        digest::Digest,
        export::{NPY_MAGIC, NpyTable, TableFile, decode_npy},
    },
    fit::{PerAxis, Recipe, Table},
};

/// A table that was read, ours or another's.
pub(super) struct AnyTable {
    pub(super) path: PathBuf,
    /// Of the file.
    pub(super) digest: Digest,
    pub(super) table: Table,
    pub(super) origin: Origin,
}

/// What is known of how a table came to be.
pub(super) enum Origin {
    /// Its recipe.
    Recipe(Recipe),
    /// Of a `.npy` file: what its axes cover.
    Range(PerAxis<[f64; 2]>),
}

impl AnyTable {
    /// Reads a table; the file's first bytes or its name tell of which kind it is.
    ///
    /// # Errors
    /// No such file, or one that is no table.
    pub(super) fn read(choice: &TableChoice) -> Result<Self, Failure> {
        let path = table_path(&choice.table, &choice.tables)?;
        let bytes = fs::read(&path).map_err(|error| file_failure(&path, &error))?;
        let is_npy = bytes.starts_with(NPY_MAGIC) || path.extension().is_some_and(|extension| extension == "npy");
        if !is_npy {
            let (digest, TableFile { table, recipe }) = verify::check(&path, &bytes, None)?;
            return Ok(Self { path, digest, table, origin: Origin::Recipe(recipe) });
        }
        let NpyTable { table, range } =
            decode_npy(&bytes).map_err(|error| Failure::new(Exit::Mismatch, format!("{}: {error}", path.display())))?;
        Ok(Self { path, digest: Digest::of(&bytes), table, origin: Origin::Range(range) })
    }
}

/// The document that `name` stands for: `-` is stdin, a bare word is a preset, anything else a file.
///
/// # Errors
/// When it cannot be read.
pub(super) fn recipe_document(name: &str) -> Result<Vec<u8>, Failure> {
    if name == "-" {
        let mut document = Vec::new();
        let read = io::stdin().lock().read_to_end(&mut document);
        read.map_err(|error| file_failure(Path::new("standard input"), &error))?;
        Ok(document)
    } else if is_preset_name(name) {
        Ok(serde_json::json!({ "preset": name }).to_string().into_bytes())
    } else {
        fs::read(name).map_err(|error| file_failure(Path::new(name), &error))
    }
}

/// A recipe's file in the working folder without an extension is named `./recipe`.
fn is_preset_name(name: &str) -> bool {
    !name.is_empty() && name.bytes().all(|byte| byte.is_ascii_alphanumeric() || matches!(byte, b'-' | b'_'))
}

/// The table's file that `name` stands for: a path, or the beginning of a digest of a file in `folder`.
///
/// # Errors
/// When there is none, or more than one begins so.
fn table_path(name: &str, folder: &Path) -> Result<PathBuf, Failure> {
    let path = PathBuf::from(name);
    let beginning = name.strip_prefix("sha256:").unwrap_or(name).to_ascii_lowercase();
    let is_digest = !beginning.is_empty() && beginning.bytes().all(|byte| byte.is_ascii_hexdigit());
    if path.exists() || !is_digest {
        return Ok(path);
    }
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).map_err(|error| file_failure(folder, &error))? {
        let name = entry.map_err(|error| file_failure(folder, &error))?.file_name();
        let stem = name.to_str().and_then(|name| name.strip_suffix(".safetensors"));
        if stem.is_some_and(|stem| stem.len() == 64 && stem.starts_with(&beginning)) {
            found.push(folder.join(&name));
        }
    }
    match (found.len(), found.pop()) {
        (1, Some(path)) => Ok(path),
        (0, _) => Err(Failure::new(Exit::Failed, format!("no table in {} begins with {beginning}", folder.display()))),
        (n, _) => Err(Failure::new(Exit::Usage, format!("{n} tables in {} begin with {beginning}", folder.display()))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bare_word_is_a_preset_and_anything_else_a_file() {
        assert_eq!(recipe_document("paper").expect("a preset"), br#"{"preset":"paper"}"#);
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("recipe.json");
        fs::write(&path, "{}").expect("a file");
        assert_eq!(recipe_document(path.to_str().expect("UTF-8")).expect("a file"), b"{}");
        let refused = recipe_document("./none.json").expect_err("no file");
        assert_eq!(refused.exit, Exit::Failed);
        assert!(refused.message.starts_with("./none.json: "), "{}", refused.message);
    }

    #[test]
    fn a_digest_is_found_by_a_unique_beginning() {
        let folder = tempfile::tempdir().expect("a folder");
        for hex in ["ab".repeat(32), "ac".repeat(32)] {
            fs::write(folder.path().join(format!("{hex}.safetensors")), "").expect("a file");
        }
        let find = |name: &str| table_path(name, folder.path());
        let expected = folder.path().join(format!("{}.safetensors", "ab".repeat(32)));
        assert_eq!(find("sha256:AB").expect("one"), expected);
        assert_eq!(find("a").expect_err("two").exit, Exit::Usage);
        assert_eq!(find("ff").expect_err("none").exit, Exit::Failed);
        assert_eq!(find("some/file").expect("a path"), PathBuf::from("some/file"));
    }
}
