//! `fit`, `tradeoff` and `fsck`.

use std::{num::NonZeroU64, path::PathBuf};

use clap::Args;

use super::threads::Threads;

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
