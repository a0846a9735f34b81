//! Errors of a service: at its start, and when it uses its storage.

use std::{path::PathBuf, time::Duration};

use crate::store::{OpenError as StoreOpenError, StoreError};
use ltcforge_files::{digest::Digest, recipe_document::RecipeError};

/// Why a service did not start.
#[derive(Debug, thiserror::Error)]
pub enum OpenError {
    /// The data folder could not be opened.
    #[error("the data folder {} cannot be used: {}", .0.display(), .1)]
    Folder(PathBuf, StoreOpenError),
    /// A thread could not be started.
    #[error("cannot start a thread: {0}")]
    Thread(#[from] std::io::Error),
    /// The storage failed while the service started.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// The folder that the processes of a cluster share is missing.
    #[cfg(feature = "cluster")]
    #[error("there is no such folder for --blobs: {}; create the folder first", .0.display())]
    NoFolder(PathBuf),
    /// The database or the object store of a cluster could not be opened.
    #[cfg(feature = "cluster")]
    #[error(transparent)]
    Connect(#[from] crate::store::ConnectError),
}

/// Why a table or a BRDF was not deleted.
#[derive(Debug, thiserror::Error)]
pub enum DeleteError {
    /// The table is unknown.
    #[error("no table with the digest {0} is stored")]
    UnknownTable(Digest),
    /// The BRDF is unknown.
    #[error("no BRDF with the digest {0} is stored")]
    UnknownBrdf(Digest),
    /// A recipe contains the BRDF.
    #[error("the recipe of a table, or of a queued or running job, uses {0}; first delete the table or cancel the job")]
    InUse(Digest),
    /// The database was damaged or could not be opened at the start, so a job that is no longer known may use the BRDF.
    #[error("the database was incomplete at startup, so an unknown job may use {0}; restart the service and try again")]
    Incomplete(Digest),
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
    /// The bytes of a file do not match its digest. The file was moved to quarantine.
    #[error("{0}")]
    Corrupt(String),
    /// The disk is full.
    #[error("the disk of the data folder is full; free some space")]
    DiskFull,
    /// The service is stopping and accepts no long work.
    #[error("the service is stopping")]
    Stopping,
    /// The storage is temporarily unavailable.
    #[error("the storage cannot be reached: {0}")]
    Unavailable(String),
    /// The machine is temporarily short of threads, memory or file descriptors.
    #[error("the machine is temporarily short of a resource: {0}")]
    Lacking(String),
    /// The request is for another kind of table.
    #[error("{0} is a lookup table, but this request is for tables of linearly transformed cosines")]
    LookupTable(Digest),
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
    /// Too many jobs are queued or running. The values are the limit, and when to try again.
    #[error("the queue is full: {0} jobs are waiting or running; try again later or raise `--queue-limit`")]
    QueueFull(usize, Duration),
    /// The fit would take too long. The values are the predicted seconds if all workers fit the job, and the limit.
    #[error(
        "the predicted time of the fit is {0:.0} s on this machine, and the limit is {1} s; reduce entries, samples, \
        directions or steps, or raise `--job-seconds`"
    )]
    TooExpensive(f64, u64),
    /// The service is stopping, or the job could not be stored.
    #[error(transparent)]
    Store(#[from] ServiceError),
}
