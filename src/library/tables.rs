//! Tables in folders.

use std::{
    io,
    path::{Path, PathBuf},
};

use super::{Error, RecipeDocument as _, fit};
use ltcforge_files::{
    bounded::read_file,
    container::{self, TableFile},
    digest::Digest,
    replace::{PairError, replace_file, replace_pair},
};
use ltcforge_fit::{Recipe, Table};

/// The table of a recipe. It is read from `folder` if it was fitted before, otherwise fitted and stored there under the
/// recipe's digest.
///
/// A damaged file, or the table of another recipe, is replaced. The folder is created if it is missing.
///
/// # Errors
/// [`Error::File`] for a folder that cannot be read or written, and the errors of [`fit()`].
pub fn cached(recipe: &Recipe, folder: impl AsRef<Path>) -> Result<TableFile, Error> {
    let path = folder.as_ref().join(format!("{}.safetensors", recipe.digest().hex()));
    match read_file(&path, u64::MAX) {
        Ok(bytes) => {
            if let Ok(file) = container::decode(&bytes)
                && file.recipe == *recipe
            {
                // The recipes are equal, but only this recipe has its BRDF's file.
                let table = Table { brdf: recipe.brdf.clone(), ..file.table };
                return Ok(TableFile { recipe: recipe.clone(), table });
            }
        }
        Err(error) if error.kind() == io::ErrorKind::NotFound => {}
        Err(source) => return Err(Error::File { path, source }),
    }
    let file = fit(recipe)?;
    replace_file(&path, &file.to_bytes()?).map_err(|source| Error::File { path, source })?;
    Ok(file)
}

/// Writes a table and its manifest into `folder`, both named by the table's digest, and measures the table for the
/// manifest. Returns the digest and the table's path. The manifest's path ends in `.manifest.json`. The caller has to
/// keep the file of a tabulated BRDF.
///
/// # Errors
/// [`Error::File`] when a file cannot be written. Then no half-written file remains, and no manifest without its table.
pub fn write_table(file: &TableFile, folder: impl AsRef<Path>) -> Result<(Digest, PathBuf), Error> {
    let bytes = file.to_bytes()?;
    let digest = Digest::of(&bytes);
    let manifest = file.manifest()?;
    let manifest_path = folder.as_ref().join(format!("{}.manifest.json", digest.hex()));
    let path = folder.as_ref().join(format!("{}.safetensors", digest.hex()));
    // The table is written first, so that there is never a manifest without its table, even if the process ends here.
    replace_pair((&path, &bytes), (&manifest_path, manifest.as_bytes()))
        .map_err(|PairError { path, source }| Error::File { path, source })?;
    Ok((digest, path))
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    fn tiny(seed: u64) -> Recipe {
        let builder = Recipe::builder().isotropic().resolution("alpha", 2).resolution("theta", 2);
        builder.samples(32).directions(4).steps(2).seed(seed).build().expect("a recipe")
    }

    #[test]
    fn a_cached_table_is_read_and_a_damaged_one_replaced() {
        let folder = tempfile::tempdir().expect("a folder");
        let recipe = tiny(1);
        let path = folder.path().join(format!("{}.safetensors", recipe.digest().hex()));
        let first = cached(&recipe, folder.path()).expect("a table");
        let bytes = fs::read(&path).expect("the file");
        assert_eq!(cached(&recipe, folder.path()).expect("the same"), first);

        // The table of another recipe under this recipe's name would be a wrong result.
        let other = cached(&tiny(2), folder.path()).expect("a table").to_bytes().expect("a file");
        for wrong in [&bytes[..bytes.len() / 2], b"", &other] {
            fs::write(&path, wrong).expect("a damaged file");
            assert_eq!(cached(&recipe, folder.path()).expect("refitted"), first);
            assert_eq!(fs::read(&path).expect("the file"), bytes);
        }
    }

    #[test]
    fn a_table_is_written_next_to_its_manifest() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = fit(&tiny(1)).expect("a table");
        let (digest, path) = write_table(&file, folder.path().join("new")).expect("two files");
        assert_eq!(Digest::of(&fs::read(path).expect("the table")), digest);
        let manifest = folder.path().join(format!("new/{}.manifest.json", digest.hex()));
        assert!(fs::read_to_string(manifest).expect("the manifest").contains(&digest.to_string()));

        // A table that cannot be written leaves no manifest behind.
        let blocked = folder.path().join("blocked");
        let in_the_way = blocked.join(format!("{}.safetensors", digest.hex()));
        fs::create_dir_all(&in_the_way).expect("a folder in the way");
        let failed = write_table(&file, &blocked).expect_err("no table");
        assert!(matches!(failed, Error::File { path, .. } if path == in_the_way));
        assert_eq!(fs::read_dir(&blocked).expect("the folder").count(), 1);
    }
}
