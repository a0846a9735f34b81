//! Opening the data folder.

use std::{
    fs::{File, TryLockError},
    io,
    path::Path,
    sync::Arc,
};

use super::{Blobs, FolderBlobs, MemoryRows, Rows, SledRows, StoreError, files, sled_rows::SledOpenError};

/// The opened data folder. Other processes are locked out until it is dropped.
#[derive(Debug)]
pub struct Store {
    /// Tables and BRDFs by digest.
    pub blobs: Arc<dyn Blobs>,
    /// Jobs and the list of tables.
    pub rows: Arc<dyn Rows>,
    /// Whether the database was opened. `false` if it was damaged and moved to quarantine, or the disk is full and the rows
    /// are in memory.
    pub is_clean: bool,
    /// Dropping it unlocks the folder. A store that processes share has no folder.
    _lock: Option<File>,
}

impl Store {
    /// A store that any number of processes share.
    #[must_use]
    pub fn shared(blobs: Arc<dyn Blobs>, rows: Arc<dyn Rows>) -> Self {
        Self { blobs, rows, is_clean: true, _lock: None }
    }
}

/// Why a data folder did not open.
#[derive(Debug, thiserror::Error)]
pub enum OpenError {
    /// Another process has opened it.
    #[error("in use by another process")]
    Locked,
    /// It cannot be created, read or written.
    #[error(transparent)]
    Unusable(#[from] io::Error),
    /// A later version of the program wrote it.
    #[error("schema {found} is newer than {known}")]
    FromTheFuture {
        /// Its schema.
        found: u32,
        /// The newest schema that this program knows.
        known: u32,
    },
}

impl From<StoreError> for OpenError {
    fn from(error: StoreError) -> Self {
        Self::Unusable(match error {
            StoreError::Io { source, .. } => source,
            StoreError::DiskFull => io::ErrorKind::StorageFull.into(),
            other => io::Error::other(other),
        })
    }
}

/// Opens the data folder `dir`, and creates it if it is missing. Every row of the database is read.
///
/// A damaged database, or one of an unreleased version, is moved to `quarantine/db-N` and replaced by an empty one. On a
/// full disk the database stays closed, and its rows are in memory: jobs are refused, but blobs can be read and deleted.
///
/// # Errors
/// See [`OpenError`].
pub fn open(dir: &Path) -> Result<Store, OpenError> {
    files::make_folder(dir)?;
    let lock = lock(&dir.join("lock"))?;
    let quarantine = dir.join("quarantine");
    let blobs = FolderBlobs::open(&dir.join("blobs"), &quarantine)?;
    let (rows, is_clean) = open_rows(&dir.join("db"), &quarantine)?;
    Ok(Store { blobs: Arc::new(blobs), rows, is_clean, _lock: Some(lock) })
}

/// The rows in `folder`, and whether the database there was opened.
fn open_rows(folder: &Path, quarantine: &Path) -> Result<(Arc<dyn Rows>, bool), OpenError> {
    let opened = open_or_replace(folder, quarantine);
    match opened {
        Ok((rows, is_clean)) => Ok((Arc::new(rows), is_clean)),
        Err(SledOpenError::DiskFull) => {
            tracing::error!(
                "the disk is full: the database stays closed, and jobs are refused; free some space and start the service again"
            );
            Ok((Arc::new(MemoryRows::of_full_disk()), false))
        }
        Err(SledOpenError::FromTheFuture { found, known }) => Err(OpenError::FromTheFuture { found, known }),
        Err(SledOpenError::Unusable(source)) => Err(OpenError::Unusable(source)),
        Err(SledOpenError::Damaged(reason)) => Err(OpenError::Unusable(io::Error::other(reason))),
    }
}

fn open_or_replace(folder: &Path, quarantine: &Path) -> Result<(SledRows, bool), SledOpenError> {
    let passed_on = |error| match error {
        StoreError::DiskFull => SledOpenError::DiskFull,
        StoreError::Io { source, .. } => SledOpenError::Unusable(source),
        other => SledOpenError::Unusable(io::Error::other(other)),
    };
    files::make_folder(folder).map_err(passed_on)?;
    let reason = match SledRows::open(folder) {
        Err(SledOpenError::Damaged(reason)) => reason,
        opened => return opened.map(|rows| (rows, true)),
    };
    let to = files::move_to_quarantine(folder, quarantine, "db").map_err(passed_on)?;
    tracing::error!(
        reason,
        moved_to = %to.display(),
        "the database was moved to quarantine and an empty one was created: unfinished jobs are lost, tables are not"
    );
    files::make_folder(folder).map_err(passed_on)?;
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
