//! The words in which the service speaks to HTTP and to the command line.

use std::{num::NonZeroUsize, path::PathBuf, time::Duration};

use serde::{Deserialize, Serialize};

use crate::{
    files::{digest::Digest, recipe::RecipeError},
    server::{
        queue::{Job, StateName},
        store::StoreError,
    },
    view::preview::Adapter,
};

/// How a service is set up.
#[derive(Debug, Clone)]
pub struct Config {
    /// Folder of the store; made when it is missing.
    pub data_dir: PathBuf,
    /// Shards fitted at the same time.
    pub workers: NonZeroUsize,
    /// Jobs that may wait or run at the same time.
    pub queue_limit: usize,
    /// Entries a table may have.
    pub entry_limit: u64,
    /// How long a lease lasts without a sign of life.
    pub lease_ttl: Duration,
    /// How often a shard is tried.
    pub max_attempts: u32,
    /// What renders previews.
    pub adapter: Adapter,
    /// How long a picture may take, waiting included.
    pub picture_limit: Duration,
}

/// Why the service does not start.
#[derive(Debug, thiserror::Error)]
pub enum OpenError {
    /// Another process has the folder.
    #[error("the data folder {} is in use by another process", .0.display())]
    Locked(PathBuf),
    /// It cannot be made, read or written.
    #[error("the data folder {} cannot be used: {source}", .path.display())]
    Unusable {
        /// The folder.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The store is of a later version of the program.
    #[error("the data folder {} has schema {found}; this program knows schemas up to {known}", .path.display())]
    FromTheFuture {
        /// The folder.
        path: PathBuf,
        /// Its schema.
        found: u32,
        /// The newest schema this program knows.
        known: u32,
    },
}

/// What became of a submitted recipe.
#[derive(Debug, Clone)]
pub enum Submission {
    /// It waits or runs; `joined` when an equal recipe was in flight already.
    InFlight {
        /// The job.
        job: Job,
        /// Whether it was there before.
        joined: bool,
    },
    /// The table is there already.
    Ready {
        /// The job that made it.
        job: Job,
        /// The table.
        table: Digest,
    },
}

/// Why a recipe was not taken.
#[derive(Debug, thiserror::Error)]
pub enum SubmitError {
    /// It is not a recipe.
    #[error(transparent)]
    Recipe(#[from] RecipeError),
    /// Too many jobs wait.
    #[error("the queue is full: {limit} jobs are waiting or running")]
    QueueFull {
        /// The limit.
        limit: usize,
        /// When to try again.
        retry_after: Duration,
    },
    /// The service is stopping.
    #[error("the service is stopping")]
    Stopping,
    /// The job could not be stored.
    #[error(transparent)]
    Store(#[from] ServiceError),
}

/// Why a read or write of the store failed.
#[derive(Debug, Clone, thiserror::Error)]
pub enum ServiceError {
    /// A blob's bytes are not those of its digest; it was moved aside.
    #[error("the blob {expected} is damaged (its bytes hash to {actual}); it was moved to {}", .moved_to.display())]
    Corrupt {
        /// What was asked for.
        expected: Digest,
        /// What was found.
        actual: Digest,
        /// Where the damaged bytes are now.
        moved_to: PathBuf,
    },
    /// No room.
    #[error("the disk of the data folder is full")]
    DiskFull,
    /// Anything else that the storage reports.
    #[error("storage: {0}")]
    Storage(String),
}

/// A page of a list.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Page<T> {
    /// The items, newest first.
    pub items: Vec<T>,
    /// Pass it as `cursor` to get what follows; absent on the last page.
    pub next: Option<String>,
}

/// What was to be expected of a job's fit before it began.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Expected {
    /// Seconds of fitting with this service's workers and no other job.
    pub seconds: f64,
    /// Mean error between nodes, as a part of the lobe's width.
    pub error: f64,
}

/// A running job's news. `sequence` grows by at least one with each change.
#[derive(Debug, Clone)]
pub struct JobNews {
    /// Position in the job's history.
    pub sequence: u64,
    /// The job as it is now.
    pub job: Job,
    /// Expected time to the end, once it can be told.
    pub seconds_left: Option<f64>,
    /// What the whole fit is expected to take and to give; none of another fitter's recipe.
    pub expected: Option<Expected>,
}

/// Figures for `/metrics`.
#[derive(Debug, Clone, Default)]
pub struct Metrics {
    /// Jobs by state.
    pub jobs: Vec<(StateName, u64)>,
    /// Entries fitted since the start.
    pub entries_fitted: u64,
    /// Shards that failed since the start.
    pub shard_failures: u64,
    /// Leases that ran out since the start.
    pub leases_expired: u64,
    /// Tables in the catalogue.
    pub tables: u64,
    /// Bytes of all tables.
    pub table_bytes: u64,
    /// Blobs found damaged since the start.
    pub blobs_corrupt: u64,
    /// Pictures that were not kept from before.
    pub pictures: PictureCounts,
}

/// How many pictures ended how since the start.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct PictureCounts {
    /// There they were.
    pub done: u64,
    /// They could not be made.
    pub failed: u64,
    /// Nobody waited any more, or not long enough.
    pub given_up: u64,
    /// Too many were asked for already.
    pub refused: u64,
}

impl From<StoreError> for ServiceError {
    fn from(error: StoreError) -> Self {
        match error {
            StoreError::DiskFull => Self::DiskFull,
            StoreError::Corrupt { expected, actual, moved_to } => Self::Corrupt { expected, actual, moved_to },
            other => Self::Storage(other.to_string()),
        }
    }
}
