//! Errors of opening a service and of its storage.

use std::{path::PathBuf, time::Duration};

use crate::store::{OpenError as StoreOpenError, StoreError};
use ltcforge_files::{digest::Digest, recipe_document::RecipeError};

/// Why a service did not start.
#[derive(Debug, thiserror::Error)]
pub enum OpenError {
    /// The data folder did not open.
    #[error("the data folder {} cannot be used: {}", .0.display(), .1)]
    Folder(PathBuf, StoreOpenError),
    /// A thread did not start.
    #[error("cannot start a thread: {0}")]
    Thread(#[from] std::io::Error),
    /// The storage failed while the service started.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// The folder that a cluster shares is missing.
    #[cfg(feature = "cluster")]
    #[error("there is no such folder for --blobs: {}", .0.display())]
    NoFolder(PathBuf),
    /// The database or the object store of a cluster did not open.
    #[cfg(feature = "cluster")]
    #[error(transparent)]
    Connect(#[from] crate::store::ConnectError),
}

/// Why a table or a BRDF was not deleted.
#[derive(Debug, thiserror::Error)]
pub enum DeleteError {
    /// There is no such table.
    #[error("no table with the digest {0} is stored")]
    UnknownTable(Digest),
    /// There is no such BRDF.
    #[error("no BRDF with the digest {0} is stored")]
    UnknownBrdf(Digest),
    /// The BRDF is needed.
    #[error("the recipe of a table, or of a queued or running job, names {0}")]
    InUse(Digest),
    /// The store failed.
    #[error(transparent)]
    Store(#[from] ServiceError),
}

impl From<StoreError> for DeleteError {
    fn from(error: StoreError) -> Self {
        Self::Store(error.into())
    }
}

/// Why a read or write of the store failed.
#[derive(Debug, Clone, thiserror::Error)]
pub enum ServiceError {
    /// The bytes of a file do not have its digest. The file was moved to quarantine.
    #[error("{0}")]
    Corrupt(String),
    /// The disk is full.
    #[error("the disk of the data folder is full")]
    DiskFull,
    /// The service is stopping and starts no long work.
    #[error("the service is stopping")]
    Stopping,
    /// The storage does not answer now.
    #[error("the storage cannot be reached now: {0}")]
    Unavailable(String),
    /// The machine lacks a thread, memory or a file descriptor for a moment.
    #[error("the machine is short of a resource for a moment: {0}")]
    Lacking(String),
    /// Any other error of the storage.
    #[error("storage: {0}")]
    Storage(String),
}

impl From<StoreError> for ServiceError {
    fn from(error: StoreError) -> Self {
        match error {
            StoreError::DiskFull => Self::DiskFull,
            StoreError::Corrupt { .. } => Self::Corrupt(error.to_string()),
            StoreError::Unavailable(reason) => Self::Unavailable(reason),
            other @ (StoreError::Refused(_) | StoreError::OtherBytes(_)) => Self::Unavailable(other.to_string()),
            other if other.is_passing() => Self::Lacking(other.to_string()),
            other => Self::Storage(other.to_string()),
        }
    }
}

/// Why a recipe was not accepted.
#[derive(Debug, thiserror::Error)]
pub enum SubmitError {
    /// The document is not a recipe, or has faults.
    #[error(transparent)]
    Recipe(#[from] RecipeError),
    /// Too many jobs are queued or running: the limit, and when to try again.
    #[error("the queue is full: {0} jobs are waiting or running; `--queue-limit` of the service raises the limit")]
    QueueFull(usize, Duration),
    /// The fit would take too long: predicted seconds with all workers on the job, and the limit.
    #[error(
        "the fit is predicted to take {0:.0} s on this machine, and a job may take {1} s; fewer entries, samples, \
        directions or steps take less, and `--job-seconds` of the service raises the limit"
    )]
    TooExpensive(f64, u64),
    /// The service is stopping, or the job could not be stored.
    #[error(transparent)]
    Store(#[from] ServiceError),
}
