//! A copy of a data folder, on which a start can be rehearsed.

use std::{
    fs::{self, File},
    io,
    path::{Path, PathBuf},
};

use super::{StoreError, StoreOpenError, files, open::lock};

/// The folder of the copy, in the data folder: there is room for it, and tables can be linked instead of copied.
const NAME: &str = "fsck";

/// A copy of a data folder, removed when dropped. The folder itself stays as it is, and other processes are locked out of
/// it.
#[derive(Debug)]
pub struct Rehearsal {
    folder: PathBuf,
    _lock: File,
}

impl Rehearsal {
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
        for name in ["db", "jobs.log", "blobs"] {
            let (from, to) = (dir.join(name), self.folder.join(name));
            match name {
                "blobs" if from.is_dir() => link_folder(&from, &to)?,
                _ if from.is_dir() => files::copy_folder(&from, &to)?,
                _ if from.is_file() => drop(fs::copy(from, to)?),
                _ => {}
            }
        }
        Ok(())
    }
}

impl Drop for Rehearsal {
    fn drop(&mut self) {
        // What stays is removed by the next one.
        let _ = fs::remove_dir_all(&self.folder);
    }
}

/// Copies a folder whose files are never changed in place: as links where the file system has them.
fn link_folder(from: &Path, to: &Path) -> io::Result<()> {
    fs::create_dir(to)?;
    for entry in fs::read_dir(from)? {
        let entry = entry?;
        let (path, target) = (entry.path(), to.join(entry.file_name()));
        if path.is_dir() {
            link_folder(&path, &target)?;
        } else if fs::hard_link(&path, &target).is_err() {
            fs::copy(path, target)?;
        }
    }
    Ok(())
}
