//! The configuration of a service, and of a cluster.

use std::{num::NonZeroUsize, path::PathBuf, time::Duration};

use ltcforge_view::preview::Adapter;

/// The configuration of a service.
#[derive(Debug, Clone)]
pub struct Config {
    /// The data folder. It is created if it is missing.
    pub data_dir: PathBuf,
    /// Number of shards that are fitted at the same time. A replica with 0 workers does not fit.
    pub workers: usize,
    /// Maximum number of queued and running jobs.
    pub queue_limit: usize,
    /// Maximum number of entries of a table.
    pub entry_limit: u64,
    /// Maximum predicted seconds of a job's fit.
    pub job_seconds: u64,
    /// How long an ended job is remembered. `None` means forever.
    pub keep_ended: Option<Duration>,
    /// Maximum bytes of all tables and BRDFs. Above it, the least recently used tables are deleted. `None` means no
    /// limit.
    pub store_bytes: Option<u64>,
    /// How long a lease lasts unless it is renewed.
    pub lease_ttl: Duration,
    /// The adapter that renders previews.
    pub adapter: Adapter,
    /// Time limit for rendering a picture.
    pub picture_time: Duration,
    /// Maximum number of stored BRDFs.
    pub brdf_limit: usize,
}

impl Config {
    /// Number of threads that assemble and measure tables.
    pub(super) fn pool_threads(&self) -> NonZeroUsize {
        NonZeroUsize::new(self.workers).unwrap_or(NonZeroUsize::MIN)
    }
}

/// The URL of a database. It may contain a password and is never printed.
#[cfg(feature = "cluster")]
#[derive(Clone, PartialEq, Eq)]
pub struct DatabaseUrl(pub(super) String);

#[cfg(feature = "cluster")]
impl std::str::FromStr for DatabaseUrl {
    type Err = std::convert::Infallible;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        Ok(Self(text.to_owned()))
    }
}

#[cfg(feature = "cluster")]
impl std::fmt::Debug for DatabaseUrl {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("DatabaseUrl(..)")
    }
}

/// The database and the object store that the processes of a cluster share.
#[cfg(feature = "cluster")]
#[derive(Debug, Clone)]
pub struct Shared {
    /// The PostgreSQL database of the queue and the catalogue.
    pub database: DatabaseUrl,
    /// The URL of the object store.
    pub store: String,
    /// Maximum number of connections to the database.
    pub connections: NonZeroUsize,
}
