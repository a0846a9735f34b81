//! The arguments of the commands of the service, without those of `serve` that its configuration file has too.

use std::{net::SocketAddr, num::NonZeroU64, path::PathBuf};

use clap::Args;

use super::place::Place;
use crate::args::threads::{ThreadCount, UpTo};
use ltcforge_server::service::DatabaseUrl;

/// Connections to a database, beside one that listens.
pub(super) type ConnectionCount = UpTo<256>;

/// How long the database lets this process's statements and transactions take.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Args)]
pub struct TimeoutArgs {
    /// Seconds that a statement may take in the database; 0 for any time [default: 30]
    #[arg(long, env = "LTCFORGE_STATEMENT_SECONDS", value_name = "N", requires = "database")]
    pub statement_seconds: Option<u32>,
    /// Seconds that a transaction may wait for this process; 0 for any time [default: 60]
    #[arg(long, env = "LTCFORGE_IDLE_TRANSACTION_SECONDS", value_name = "N", requires = "database")]
    pub idle_transaction_seconds: Option<u32>,
}

/// The places that `work` shares with other processes: the database and the store of tables; and the folder of its cache.
#[derive(Debug, Args)]
pub struct SharedArgs {
    /// PostgreSQL database of the queue and the catalogue
    #[arg(long, env = "LTCFORGE_DATABASE", hide_env_values = true, value_name = "URL")]
    pub database: DatabaseUrl,
    /// Store of the tables: `s3://BUCKET/PREFIX`, `gs://`, `az://` or `file:///FOLDER`
    #[arg(long, env = "LTCFORGE_BLOBS", value_name = "URL")]
    pub blobs: String,
    /// Megabytes of tables that are kept in the data folder [default: 4096]
    #[arg(long, env = "LTCFORGE_CACHE_MB", value_name = "N")]
    pub cache_mb: Option<NonZeroU64>,
    /// Folder of the cache [default: ltcforge-data]
    #[arg(long, env = "LTCFORGE_DATA", value_name = "DIR")]
    pub data: Option<PathBuf>,
    /// Connections to the database, 1 to 256, beside one that listens [default: 3]
    #[arg(long, env = "LTCFORGE_DATABASE_CONNECTIONS", value_name = "N")]
    pub database_connections: Option<ConnectionCount>,
    /// How long the database waits
    #[command(flatten)]
    pub timeouts: TimeoutArgs,
}

/// Flags that make `serve` one of several processes.
#[derive(Debug, Clone, Default, PartialEq, Eq, Args)]
pub(crate) struct ReplicaArgs {
    /// PostgreSQL database of the queue and the catalogue, which any number of processes share
    #[arg(long, env = "LTCFORGE_DATABASE", hide_env_values = true, value_name = "URL", requires = "blobs")]
    pub database: Option<DatabaseUrl>,
    /// Store of the tables: `s3://BUCKET/PREFIX`, `gs://`, `az://` or `file:///FOLDER`
    #[arg(long, env = "LTCFORGE_BLOBS", value_name = "URL", requires = "database")]
    pub blobs: Option<String>,
    /// Megabytes of tables that are kept in the data folder, with --blobs [default: 4096]
    #[arg(long, env = "LTCFORGE_CACHE_MB", value_name = "N", requires = "blobs")]
    pub cache_mb: Option<NonZeroU64>,
    /// Only serve; `ltcforge work` fits
    #[arg(long, requires = "database")]
    pub no_workers: bool,
    /// Seconds after which another worker does what one has not reported on, with --database [default: 60]
    #[arg(long, env = "LTCFORGE_LEASE_SECONDS", value_name = "N", requires = "database")]
    pub lease_seconds: Option<NonZeroU64>,
    /// Connections to the database, 1 to 256, beside one that listens [default: 16]
    #[arg(long, env = "LTCFORGE_DATABASE_CONNECTIONS", value_name = "N", requires = "database")]
    pub database_connections: Option<ConnectionCount>,
    /// How long the database waits
    #[command(flatten)]
    pub timeouts: TimeoutArgs,
}

/// `gc`.
#[derive(Debug, Args)]
pub struct GcArgs {
    /// PostgreSQL database of the queue and the catalogue; without it, the store is that of the data folder
    #[arg(long, env = "LTCFORGE_DATABASE", hide_env_values = true, value_name = "URL", requires = "blobs")]
    pub database: Option<DatabaseUrl>,
    /// Store of the tables: `s3://BUCKET/PREFIX`, `gs://`, `az://` or `file:///FOLDER`
    #[arg(long, env = "LTCFORGE_BLOBS", value_name = "URL", requires = "database")]
    pub blobs: Option<String>,
    /// Folder of jobs and tables of a service that is not running, or with --database of the cache [default: ltcforge-data]
    #[arg(long, env = "LTCFORGE_DATA", value_name = "DIR")]
    pub data: Option<PathBuf>,
    /// Bytes that the store may have; files used longest ago are beyond them [default: any number]
    #[arg(long, env = "LTCFORGE_STORE_BYTES", value_name = "N")]
    pub store_bytes: Option<NonZeroU64>,
    /// Delete the files that are told
    #[arg(long)]
    pub delete: bool,
    /// Only tell them, as without any flag
    #[arg(long, conflicts_with = "delete")]
    pub dry_run: bool,
    /// Delete them even if nothing refers to more than half of the store
    #[arg(long, requires = "delete")]
    pub even_most: bool,
}

/// `work`.
#[derive(Debug, Args)]
pub struct WorkArgs {
    /// The database, the store and the folder
    #[command(flatten)]
    pub shared: SharedArgs,
    /// Shards fitted at the same time, 1 to 512 [default: one for each core]
    #[arg(long, env = "LTCFORGE_WORKERS", value_name = "N")]
    pub workers: Option<ThreadCount>,
    /// Seconds after which another worker does what this one has not reported on [default: 60]
    #[arg(long, env = "LTCFORGE_LEASE_SECONDS", value_name = "N")]
    pub lease_seconds: Option<NonZeroU64>,
    /// Answer `/healthz`, `/readyz`, `/metrics` and `/version` at this address; without it, nothing listens
    #[arg(long, env = "LTCFORGE_WORK_LISTEN", value_name = "ADDRESS")]
    pub listen: Option<SocketAddr>,
    /// File of tokens, of which each request but those of probes then needs one
    #[arg(long, env = "LTCFORGE_TOKENS", value_name = "FILE")]
    pub tokens: Option<PathBuf>,
    /// Tokens beside those of the file, with `;` between, as `ltcforge token new` prints them for the service
    #[arg(long, env = "LTCFORGE_TOKEN_LIST", hide_env_values = true, value_name = "TOKENS")]
    pub token_list: Option<String>,
    /// Without tokens, answer anyone who reaches an address that is not of this machine alone
    #[arg(long, requires = "listen")]
    pub allow_anyone: bool,
}

/// `migrate`.
#[derive(Debug, Args)]
pub struct MigrateArgs {
    /// PostgreSQL database that jobs and catalogue go to
    #[arg(long, env = "LTCFORGE_DATABASE", hide_env_values = true, value_name = "URL")]
    pub to: DatabaseUrl,
    /// Store that the tables go to: `s3://BUCKET/PREFIX`, `gs://`, `az://` or `file:///FOLDER`
    #[arg(long, env = "LTCFORGE_BLOBS", value_name = "URL")]
    pub blobs: String,
    /// Folder of jobs and tables of a service that is not running [default: ltcforge-data]
    #[arg(long, env = "LTCFORGE_DATA", value_name = "DIR")]
    pub data: Option<PathBuf>,
}

/// `fsck`.
#[derive(Debug, Args)]
pub struct FsckArgs {
    /// The store
    #[command(flatten)]
    pub place: Place,
}
