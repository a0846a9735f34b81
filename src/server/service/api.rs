//! The types of the service's interface, which HTTP and the command line use.

use std::{
    num::NonZeroUsize,
    path::{Path, PathBuf},
    time::Duration,
};

use serde::{Deserialize, Serialize};

use crate::store::{DatabaseOpenError, ObjectsOpenError, PairError};
use crate::{
    queue::{Depth, Job, StateName},
    store::{StoreError, StoreOpenError},
};
use ltcforge_files::{digest::Digest, recipe_document::RecipeError};
use ltcforge_view::preview::Adapter;

/// The configuration of a service.
#[derive(Debug, Clone)]
pub struct Config {
    /// Folder of the store; created if it is missing.
    pub data_dir: PathBuf,
    /// Shards fitted at the same time.
    pub workers: NonZeroUsize,
    /// Jobs that may be queued or running at the same time.
    pub queue_limit: usize,
    /// Entries a table may have.
    pub entry_limit: u64,
    /// Seconds that a job's fit may take, as predicted when it is submitted.
    pub job_seconds: u64,
    /// How long a job that has ended is remembered; `None` for ever.
    pub keep_ended: Option<Duration>,
    /// Jobs that have ended and are remembered; `None` for any number.
    pub most_ended: Option<usize>,
    /// Bytes of tables and of files that users sent; `None` for any number.
    pub store_bytes: Option<u64>,
    /// How long a file is not removed after it was used, whatever the size of the store.
    pub unused_for: Duration,
    /// How long a lease lasts unless it is renewed.
    pub lease_ttl: Duration,
    /// How often a task may fail before its job does.
    pub max_attempts: u32,
    /// The adapter that renders previews.
    pub adapter: Adapter,
    /// The limits of pictures.
    pub pictures: PictureLimits,
    /// Tabulated BRDFs that may be stored.
    pub brdf_limit: usize,
    /// Light textures that may be stored.
    pub light_texture_limit: usize,
    /// Bytes of exports that are kept in memory.
    pub export_bytes: usize,
}

/// The limits of pictures. The defaults fit one machine and a team.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PictureLimits {
    /// How long one may take, from when it starts to be rendered. The limit of its samples follows from it.
    pub time: Duration,
    /// How many may wait or be rendered at the same time.
    pub queue: NonZeroUsize,
    /// Bytes of finished ones that are kept in memory.
    pub memory_bytes: usize,
}

impl Default for PictureLimits {
    /// Most pictures take less than a second, the largest references minutes. One is rendered, and eight wait.
    fn default() -> Self {
        let queue = NonZeroUsize::MIN.saturating_add(8);
        Self { time: Duration::from_secs(30), queue, memory_bytes: 64 << 20 }
    }
}

/// Why the service did not start.
#[derive(Debug, thiserror::Error)]
pub enum OpenError {
    /// Another process has the folder.
    #[error("the data folder {} is in use by another process", .0.display())]
    Locked(PathBuf),
    /// It cannot be created, read or written.
    #[error("the data folder {} cannot be used: {source}", .path.display())]
    Unusable {
        /// The folder.
        path: PathBuf,
        /// The system's error.
        source: std::io::Error,
    },
    /// It has no store, and this operation makes none.
    #[error("{} has no jobs and tables of this service", .0.display())]
    NoStore(PathBuf),
    /// It has a store, and this operation makes one.
    #[error("{} has jobs and tables already", .0.display())]
    HasStore(PathBuf),
    /// The database that processes share cannot be used.
    #[error(transparent)]
    Database(#[from] DatabaseOpenError),
    /// The store of blobs that processes share cannot be used.
    #[error(transparent)]
    Blobs(#[from] ObjectsOpenError),
    /// Database and store are not used together.
    #[error(transparent)]
    Pair(#[from] PairError),
    /// Most blobs of the store would be removed.
    #[error(
        "{orphans} of the store's {blobs} blobs have no row in the database, more than half: nothing was removed; is it the \
        right database, and whole? `--even-most` removes them"
    )]
    MostAreOrphans {
        /// Blobs without a row.
        orphans: usize,
        /// All blobs.
        blobs: usize,
    },
    /// A database that was opened failed.
    #[error(transparent)]
    Shared(StoreError),
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

impl OpenError {
    /// The error of the store in `folder`.
    pub(super) fn of(folder: &Path, error: StoreOpenError) -> Self {
        let path = folder.to_owned();
        match error {
            StoreOpenError::Locked => Self::Locked(path),
            StoreOpenError::Unusable(source) => Self::Unusable { path, source },
            StoreOpenError::FromTheFuture { found, known } => Self::FromTheFuture { path, found, known },
        }
    }
}

/// The result of submitting a recipe.
#[derive(Debug, Clone)]
pub enum SubmitReply {
    /// The job is queued or running.
    InFlight {
        /// The job.
        job: Job,
        /// Whether an equal recipe had been submitted before.
        joined: bool,
    },
    /// The table is stored already.
    Ready {
        /// The job that made it.
        job: Job,
        /// The table.
        table: Digest,
    },
}

/// What submitting a recipe would begin.
#[derive(Debug)]
pub struct Foreseen {
    /// Canonical text of the recipe.
    pub recipe: String,
    /// Its digest.
    pub recipe_digest: Digest,
    /// Entries of its table.
    pub entries: u64,
    /// The table, if it is stored.
    pub table: Option<Digest>,
    /// The forecast for the fit.
    pub expected: Option<Expected>,
    /// Why the job would not be begun, though the recipe has no fault.
    pub refused: Option<SubmitError>,
}

/// Why a recipe was not accepted.
#[derive(Debug, thiserror::Error)]
pub enum SubmitError {
    /// The document is not a recipe, or has faults.
    #[error(transparent)]
    Recipe(#[from] RecipeError),
    /// Too many jobs are queued or running.
    #[error(
        "the queue is full: {limit} jobs{} are waiting or running; `--queue-limit` of the service raises the limit",
        team.as_ref().map(|team| format!(" of the team «{team}», half of the queue,")).unwrap_or_default()
    )]
    QueueFull {
        /// The limit.
        limit: usize,
        /// The team whose limit it is.
        team: Option<String>,
        /// When to try again.
        retry_after: Duration,
    },
    /// The fit would take too long.
    #[error(
        "the fit is predicted to take {predicted:.0} s on this machine, and a job may take {limit} s; fewer entries, samples, \
        directions or steps take less, and `--job-seconds` of the service raises the limit"
    )]
    TooExpensive {
        /// Predicted seconds, with all workers on the job.
        predicted: f64,
        /// The limit in seconds.
        limit: u64,
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
    /// A blob's bytes do not have its digest; it was moved to quarantine.
    #[error("the blob {expected} is damaged (its bytes hash to {actual}); it was moved to {}", .moved_to.display())]
    Corrupt {
        /// The digest that was requested.
        expected: Digest,
        /// The digest of the bytes found.
        actual: Digest,
        /// Where the damaged file is now.
        moved_to: PathBuf,
    },
    /// The disk is full.
    #[error("the disk of the data folder is full")]
    DiskFull,
    /// The service is stopping, and neither begins nor finishes work that takes long.
    #[error("the service is stopping")]
    Stopping,
    /// The storage does not answer now.
    #[error("the storage cannot be reached now: {0}")]
    Unavailable(String),
    /// The machine or the process is short of a resource for a moment, such as a thread or a file descriptor.
    #[error("the machine is short of a resource for a moment: {0}")]
    Lacking(String),
    /// Any other error of the storage.
    #[error("storage: {0}")]
    Storage(String),
}

/// A page of a list.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Page<T> {
    /// The items, newest first.
    pub items: Vec<T>,
    /// Pass it as `cursor` to get the next page; `None` on the last one.
    pub next: Option<String>,
}

/// The forecast for a job's fit.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Expected {
    /// Seconds of fitting with this service's workers and no other job.
    pub seconds: f64,
    /// Mean error between nodes, as a part of the lobe's width.
    pub error: f64,
    /// Bytes of the table's matrices and terms.
    pub bytes: u64,
    /// Parts of the table that workers fit one by one.
    pub shards: u32,
}

/// A job at one moment. `sequence` grows with each change.
#[derive(Debug, Clone)]
pub struct JobSnapshot {
    /// Position in the history of the job.
    pub sequence: u64,
    /// The job.
    pub job: Job,
    /// Expected time to the end, once it can be estimated.
    pub seconds_left: Option<f64>,
    /// The forecast for the whole fit; `None` for a recipe of another fitter.
    pub expected: Option<Expected>,
}

/// What a queue has to do.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Backlog {
    /// Shards that wait and that are leased.
    pub shards: Depth,
    /// Predicted seconds that one core takes for the entries that are not fitted.
    pub core_seconds: f64,
    /// Seconds since the oldest unfinished job was submitted; 0 without one.
    pub oldest_seconds: f64,
}

/// Figures for `/metrics`.
#[derive(Debug, Clone, Default)]
pub struct Metrics {
    /// Jobs by state.
    pub jobs: Vec<(StateName, u64)>,
    /// What all processes that share the queue have to do.
    pub backlog: Backlog,
    /// Entries fitted since the start.
    pub entries_fitted: u64,
    /// Shards that failed since the start.
    pub shard_failures: u64,
    /// Leases that expired since the start.
    pub leases_expired: u64,
    /// Tables in the catalogue.
    pub tables: u64,
    /// Bytes of all tables.
    pub table_bytes: u64,
    /// Blobs found damaged or missing since the start.
    pub blobs_corrupt: u64,
    /// Pictures since the start, except those served from memory.
    pub pictures: PictureCounts,
    /// Exports made since the start; those served from memory are not counted.
    pub exports_made: u64,
    /// Files removed since the start because the store was larger than it may be.
    pub files_removed: u64,
}

/// How many pictures ended in which way since the start.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct PictureCounts {
    /// Rendered.
    pub done: u64,
    /// The renderer or the storage failed.
    pub failed: u64,
    /// The callers withdrew, or the time ran out.
    pub given_up: u64,
    /// The queue was full, or the picture had too many samples.
    pub refused: u64,
}

impl From<StoreError> for ServiceError {
    fn from(error: StoreError) -> Self {
        match error {
            StoreError::DiskFull => Self::DiskFull,
            StoreError::Corrupt { expected, actual, moved_to } => Self::Corrupt { expected, actual, moved_to },
            StoreError::Unavailable(reason) => Self::Unavailable(reason),
            other @ (StoreError::Refused(_) | StoreError::OtherBytes(_)) => Self::Unavailable(other.to_string()),
            other if other.is_passing() => Self::Lacking(other.to_string()),
            other => Self::Storage(other.to_string()),
        }
    }
}
