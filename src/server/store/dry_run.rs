//! A copy of a data folder, to try a start on.

use std::{
    fs::{self, File},
    io,
    path::{Path, PathBuf},
};

use super::{StoreError, StoreOpenError, files, open::lock};

/// The folder of the copy, in the data folder: there is room for it, and tables can be linked instead of copied.
const NAME: &str = "fsck";

/// A copy of a data folder, removed when dropped. The folder itself stays as it is, and other processes are locked
/// out of it.
#[derive(Debug)]
pub struct DryRun {
    folder: PathBuf,
    _lock: File,
}

impl DryRun {
    /// Copies the data folder `dir`; `None` if it has no store.
    ///
    /// # Errors
    /// When the folder is in use, or cannot be read or written.
    pub fn of(dir: &Path) -> Result<Option<Self>, StoreOpenError> {
        let is_store = dir.join("db/db").is_file()
            || dir.join("jobs.log").is_file()
            || dir.join("lock").is_file() && dir.join("blobs").is_dir();
        if !is_store {
            return Ok(None);
        }
        let copy = Self { _lock: lock(&dir.join("lock"))?, folder: dir.join(NAME) };
        copy.fill(dir).map_err(|source| StoreError::of_io(&copy.folder, source))?;
        Ok(Some(copy))
    }

    /// The copy.
    #[must_use]
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    fn fill(&self, dir: &Path) -> io::Result<()> {
        // One that was killed may have left its copy.
        if self.folder.is_dir() {
            fs::remove_dir_all(&self.folder)?;
        }
        fs::create_dir(&self.folder)?;
        if dir.join("jobs.log").is_file() {
            fs::copy(dir.join("jobs.log"), self.folder.join("jobs.log"))?;
        }
        if dir.join("db").is_dir() {
            files::copy_folder(&dir.join("db"), &self.folder.join("db"))?;
        }
        if dir.join("blobs").is_dir() {
            // Tables are never changed in place.
            let link = |from: &Path, to: &Path| fs::hard_link(from, to).or_else(|_| fs::copy(from, to).map(drop));
            files::copy_folder_by(&dir.join("blobs"), &self.folder.join("blobs"), &link)?;
        }
        Ok(())
    }
}

impl Drop for DryRun {
    fn drop(&mut self) {
        // A folder that cannot be removed now is removed by the next run.
        let _ = fs::remove_dir_all(&self.folder);
    }
}
