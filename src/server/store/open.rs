//! Opens the data folder.

use std::{
    fs::{File, TryLockError},
    io,
    path::Path,
    sync::Arc,
};

use super::{Blobs, FolderBlobs, MemoryRows, OpenError, Rows, SledRows, files};

/// The opened data folder. Other processes cannot open it until this is dropped.
#[derive(Debug)]
pub struct Store {
    /// Tables and BRDFs by digest.
    pub blobs: Arc<dyn Blobs>,
    /// Jobs and the catalogue of files.
    pub rows: Arc<dyn Rows>,
    /// Whether the database was opened. `false` if it was damaged and moved to quarantine, or if the disk is full and
    /// the rows are in memory.
    pub is_clean: bool,
    /// Dropping the file unlocks the folder. A shared store has no folder.
    _lock: Option<File>,
}

impl Store {
    /// A store that several processes share.
    #[must_use]
    pub fn shared(blobs: Arc<dyn Blobs>, rows: Arc<dyn Rows>) -> Self {
        Self { blobs, rows, is_clean: true, _lock: None }
    }
}

/// Opens the data folder `dir`. Creates it if it is missing. Reads every row of the database.
///
/// A database that is damaged or from an unreleased version is moved to `quarantine/db-N`, and an empty database
/// replaces it. On a full disk the database stays closed, and the rows are in memory. Jobs are then refused, but blobs
/// can be read and deleted.
///
/// # Errors
/// See [`OpenError`].
pub fn open(dir: &Path) -> Result<Store, OpenError> {
    files::make_folder(dir)?;
    let lock = lock(&dir.join("lock"))?;
    let quarantine = dir.join("quarantine");
    let blobs = FolderBlobs::open(&dir.join("blobs"), &quarantine)?;
    let (rows, is_clean): (Arc<dyn Rows>, bool) = match open_rows(&dir.join("db"), &quarantine) {
        Err(OpenError::Full) => {
            tracing::error!(
                "the disk is full, so the database stays closed and jobs are refused; free some space and restart the service"
            );
            (Arc::new(MemoryRows::of_full_disk()), false)
        }
        opened => opened.map(|(rows, is_clean)| (Arc::new(rows) as _, is_clean))?,
    };
    Ok(Store { blobs: Arc::new(blobs), rows, is_clean, _lock: Some(lock) })
}

/// The rows in `folder`, and whether its database was opened.
fn open_rows(folder: &Path, quarantine: &Path) -> Result<(SledRows, bool), OpenError> {
    files::make_folder(folder)?;
    let reason = match SledRows::open(folder) {
        Err(OpenError::Damaged(reason)) => reason,
        opened => return opened.map(|rows| (rows, true)),
    };
    let to = files::move_to_quarantine(folder, quarantine, "db")?;
    tracing::error!(
        reason,
        moved_to = %to.display(),
        "the database was moved to quarantine, and an empty one was created; unfinished jobs are lost, tables are not"
    );
    files::make_folder(folder)?;
    SledRows::open(folder).map(|rows| (rows, false))
}

fn lock(path: &Path) -> Result<File, OpenError> {
    if path.symlink_metadata().is_ok_and(|metadata| !metadata.is_file()) {
        return Err(OpenError::Unusable(io::Error::other(format!("{} is not a regular file", path.display()))));
    }
    let file = File::options().create(true).truncate(false).write(true).open(path)?;
    match file.try_lock() {
        Ok(()) => Ok(file),
        Err(TryLockError::WouldBlock) => Err(OpenError::Locked),
        Err(TryLockError::Error(source)) => Err(OpenError::Unusable(source)),
    }
}
