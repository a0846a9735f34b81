//! Flags that let `serve` share a database and an object store with other processes.

use std::{
    num::{NonZeroU64, NonZeroUsize},
    time::Duration,
};

use clap::Args;

use super::Context;
use ltcforge_server::service::{Config, DatabaseUrl, Shared};

/// Database connections of a serving process.
const REPLICA_CONNECTIONS: NonZeroUsize = NonZeroUsize::new(16).unwrap();

/// Flags that make `serve` one of several processes.
#[derive(Debug, Clone, Default, PartialEq, Eq, Args)]
pub(crate) struct ReplicaArgs {
    /// PostgreSQL database of the queue
    #[arg(long, env = "LTCFORGE_DATABASE", hide_env_values = true, value_name = "URL", requires = "blobs")]
    pub database: Option<DatabaseUrl>,
    /// Object store: `s3://BUCKET/PREFIX`, `gs://`, `az://` or `file:///`
    #[arg(long, env = "LTCFORGE_BLOBS", value_name = "URL", requires = "database")]
    pub blobs: Option<String>,
    /// Do not fit here; leave it to `ltcforge work`
    #[arg(long, requires = "database")]
    pub no_workers: bool,
    /// Seconds until another worker takes over a silent worker's shard
    #[arg(long, env = "LTCFORGE_LEASE_SECONDS", value_name = "N", requires = "database")]
    pub lease_seconds: Option<NonZeroU64>,
}

impl ReplicaArgs {
    /// Opens the service on the shared database, or `None` for a service on its own data folder.
    pub(super) fn shared(&self) -> Option<Shared> {
        let (database, store) = self.database.clone().zip(self.blobs.clone())?;
        Some(Shared { database, store, connections: REPLICA_CONNECTIONS })
    }

    /// Applies these flags to the configuration.
    pub(super) fn change(&self, config: Config) -> Config {
        let workers = if self.no_workers { 0 } else { config.workers };
        Config { workers, lease_ttl: lease_ttl(self.lease_seconds, &config), ..config }
    }
}

/// How long a lease lasts.
pub(super) fn lease_ttl(seconds: Option<NonZeroU64>, config: &Config) -> Duration {
    seconds.map_or(config.lease_ttl, |seconds| Duration::from_secs(seconds.get()))
}

/// The result of `opening`; `None` if the process is interrupted first.
pub(super) async fn unless_interrupted<T>(opening: impl Future<Output = T>, context: &Context<'_>) -> Option<T> {
    tokio::select! {
        opened = opening => Some(opened),
        () = context.interrupt.clone().wait() => None,
    }
}
