//! What the service offers to HTTP and to the command line.

use std::{num::NonZeroUsize, path::PathBuf, sync::Arc, time::Duration};

use jiff::Timestamp;
use serde::{Deserialize, Serialize};
use tokio::sync::watch;

use crate::{
    digest::Digest,
    queue::{Job, JobId, StateName},
    recipe::RecipeError,
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
#[derive(Debug, thiserror::Error)]
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

/// A table in the catalogue.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct TableRow {
    /// The table.
    pub digest: Digest,
    /// Its recipe.
    pub recipe_digest: Digest,
    /// Size of its file.
    pub bytes: u64,
    /// When it was stored.
    pub created_at: Timestamp,
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
}

/// The service. All its methods block; HTTP calls them from blocking threads.
#[derive(Debug)]
pub struct Service {}

impl Service {
    /// Opens the store, applies migrations, resumes unfinished jobs and starts the workers.
    ///
    /// # Errors
    /// When the folder is locked, not usable, or of a later version.
    pub fn open(_config: Config) -> Result<Arc<Self>, OpenError> {
        todo!()
    }

    /// Stops leasing, lets running shards finish their entry and gives them back, and flushes.
    pub fn stop(&self) {
        todo!()
    }

    /// Whether the service takes and works on jobs.
    #[must_use]
    pub fn is_ready(&self) -> bool {
        todo!()
    }

    /// Submits a recipe document. The job is durable when this returns.
    ///
    /// # Errors
    /// See [`SubmitError`].
    pub fn submit(&self, _document: &[u8]) -> Result<Submission, SubmitError> {
        todo!()
    }

    /// A job by its id, with the expected seconds to its end.
    ///
    /// # Errors
    /// When the store fails.
    pub fn job(&self, _id: JobId) -> Result<Option<JobNews>, ServiceError> {
        todo!()
    }

    /// Jobs, newest first.
    ///
    /// # Errors
    /// When the store fails. An unknown cursor starts from the newest.
    pub fn jobs(
        &self,
        _state: Option<StateName>,
        _cursor: Option<&str>,
        _limit: usize,
    ) -> Result<Page<JobNews>, ServiceError> {
        todo!()
    }

    /// Cancels a job. A finished job stays as it is. Returns the job as it is afterwards.
    ///
    /// # Errors
    /// When the store fails.
    pub fn cancel(&self, _id: JobId) -> Result<Option<JobNews>, ServiceError> {
        todo!()
    }

    /// Follows a job: the receiver always holds the latest news.
    ///
    /// # Errors
    /// When the store fails.
    pub fn watch(&self, _id: JobId) -> Result<Option<watch::Receiver<JobNews>>, ServiceError> {
        todo!()
    }

    /// The canonical file of a table, checked against its digest.
    ///
    /// # Errors
    /// When the blob is damaged or unreadable.
    pub fn table(&self, _digest: Digest) -> Result<Option<Arc<Vec<u8>>>, ServiceError> {
        todo!()
    }

    /// The manifest of a table (see [`super::manifest`]) as JSON bytes.
    ///
    /// # Errors
    /// When the blob is damaged or unreadable.
    pub fn manifest(&self, _digest: Digest) -> Result<Option<Vec<u8>>, ServiceError> {
        todo!()
    }

    /// Tables, newest first.
    ///
    /// # Errors
    /// When the store fails.
    pub fn tables(&self, _cursor: Option<&str>, _limit: usize) -> Result<Page<TableRow>, ServiceError> {
        todo!()
    }

    /// A known recipe's canonical JSON and its table, if it has been fitted.
    ///
    /// # Errors
    /// When the store fails.
    pub fn recipe(&self, _digest: Digest) -> Result<Option<(String, Option<Digest>)>, ServiceError> {
        todo!()
    }

    /// Figures for `/metrics`.
    ///
    /// # Errors
    /// When the store fails.
    pub fn metrics(&self) -> Result<Metrics, ServiceError> {
        todo!()
    }
}
