//! `serve`, `fit` and `tradeoff`: commands that fit tables.

use std::{
    net::SocketAddr,
    num::{NonZeroU64, NonZeroUsize},
    path::PathBuf,
};

use clap::Args;

use super::{
    super::preview_names::AdapterName,
    ConnectionArgs, WaitSeconds,
    threads::{Threads, threads},
};

/// `serve`.
#[derive(Debug, Args)]
pub struct ServeArgs {
    /// Address to listen on; port 0 takes a free one [default: 127.0.0.1:8317]
    #[arg(long, env = "LTCFORGE_LISTEN", value_name = "ADDRESS")]
    pub listen: Option<SocketAddr>,
    /// Folder of jobs and tables, made when missing [default: ltcforge-data]
    #[arg(long, env = "LTCFORGE_DATA", value_name = "DIR")]
    pub data: Option<PathBuf>,
    /// Shards fitted at the same time, 1 to 512 [default: one for each core]
    #[arg(long, env = "LTCFORGE_WORKERS", value_name = "N", value_parser = threads)]
    pub workers: Option<NonZeroUsize>,
    /// Jobs that may wait or run at the same time [default: 64]
    #[arg(long, env = "LTCFORGE_QUEUE_LIMIT", value_name = "N")]
    pub queue_limit: Option<NonZeroUsize>,
    /// Entries a table may have [default: 2000000]
    #[arg(long, env = "LTCFORGE_ENTRY_LIMIT", value_name = "N")]
    pub entry_limit: Option<NonZeroU64>,
    /// Seconds that a job may take, as predicted when it is submitted [default: 86400]
    #[arg(long, env = "LTCFORGE_JOB_SECONDS", value_name = "N")]
    pub job_seconds: Option<NonZeroU64>,
    /// Days after which a job that has ended is forgotten; 0 keeps it for good. Tables stay [default: 90]
    #[arg(long, env = "LTCFORGE_JOB_DAYS", value_name = "N")]
    pub job_days: Option<u32>,
    /// Bytes of exports that are kept in memory, so that they are not made again; 0 keeps none [default: 268435456]
    #[arg(long, env = "LTCFORGE_EXPORT_BYTES", value_name = "N")]
    pub export_bytes: Option<usize>,
    /// What renders previews [default: any]
    #[arg(long, value_enum, env = "LTCFORGE_ADAPTER")]
    pub adapter: Option<AdapterName>,
    /// Limits of pictures
    #[command(flatten)]
    pub pictures: PictureLimitArgs,
    /// Whom it serves
    #[command(flatten)]
    pub connections: ConnectionArgs,
    /// What it shares
    #[command(flatten)]
    pub replica: super::ReplicaArgs,
}

/// `serve`: limits of pictures.
#[derive(Debug, Clone, Default, Args)]
#[allow(clippy::struct_field_names, reason = "they are the flags' names")]
pub struct PictureLimitArgs {
    /// Seconds that a picture may take, as predicted and while it is rendered, 1 to 86400 [default: 30]
    #[arg(long, env = "LTCFORGE_PICTURE_SECONDS", value_name = "N")]
    pub picture_seconds: Option<WaitSeconds>,
    /// Pictures that may wait or be rendered at the same time [default: 9]
    #[arg(long, env = "LTCFORGE_PICTURE_QUEUE", value_name = "N")]
    pub picture_queue: Option<NonZeroUsize>,
    /// MiB of rendered pictures that are kept in memory; 0 keeps none [default: 64]
    #[arg(long, env = "LTCFORGE_PICTURE_MEMORY", value_name = "MIB")]
    pub picture_memory: Option<u32>,
}

/// `fsck`.
#[derive(Debug, Args)]
pub struct FsckArgs {
    /// Folder of jobs and tables of a service that is not running [default: ltcforge-data]
    #[arg(long, env = "LTCFORGE_DATA", value_name = "DIR")]
    pub data: Option<PathBuf>,
}

/// `fit`.
#[derive(Debug, Args)]
pub struct FitArgs {
    /// A recipe's file, `-` for stdin, or the name of a preset
    pub recipe: PathBuf,
    /// Folder that the table and its manifest go to
    #[arg(short, long, value_name = "DIR", default_value = ".")]
    pub out: PathBuf,
    /// Number of threads
    #[command(flatten)]
    pub threads: Threads,
    /// Entries the table may have [default: 2000000]
    #[arg(long, env = "LTCFORGE_ENTRY_LIMIT", value_name = "N")]
    pub entry_limit: Option<NonZeroU64>,
}

/// `tradeoff`.
#[derive(Debug, Args)]
pub struct TradeoffArgs {
    /// A recipe's file, `-` for stdin, or the name of a preset: the family keeps its ranges, terms, seed and solver,
    /// and varies its layout, resolution and precision [default: paper]
    #[arg(long, value_name = "RECIPE")]
    pub recipe: Option<PathBuf>,
    /// Fit a small family: the presets and a few recipes around them
    #[arg(long)]
    pub quick: bool,
    /// Folder that `tradeoff.csv`, `tradeoff.json` and `tradeoff.svg` go to
    #[arg(short, long, value_name = "DIR", default_value = ".")]
    pub out: PathBuf,
    /// Number of threads
    #[command(flatten)]
    pub threads: Threads,
}
