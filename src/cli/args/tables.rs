//! `lookup`, `report`, `verify` and `diff`: commands on tables that exist.

use std::{num::NonZeroU64, path::PathBuf};

use clap::Args;

use super::Threads;
use ltcforge_client::TABLE_BYTES;
use ltcforge_files::digest::Digest;

/// The choice of a table.
#[derive(Debug, Args)]
pub struct TableChoice {
    /// A table's file, a `.npy` file of shape alpha x ratio x theta x phi x 3 x 3, or a digest as `fit` prints it
    /// (its first digits suffice) of a table in the folder of `--tables`
    pub table: PathBuf,
    /// The folder of tables
    #[command(flatten)]
    pub folder: TableFolder,
}

/// The folder that is searched for digests, and the length of tables.
#[derive(Debug, Args)]
pub struct TableFolder {
    /// Folder of `<digest>.safetensors` files [default: the working folder, then `tables` in it]
    #[arg(long, value_name = "DIR")]
    pub tables: Option<PathBuf>,
    /// How long a table may be
    #[command(flatten)]
    pub limit: TableLimit,
}

/// How long a table may be.
#[derive(Debug, Clone, Copy, Args)]
pub struct TableLimit {
    /// Longest table that is read or downloaded
    #[arg(long, env = "LTCFORGE_TABLE_LIMIT", value_name = "BYTES", default_value_t = TABLE_BYTES)]
    pub table_limit: u64,
}

/// `lookup`.
#[derive(Debug, Args)]
pub struct LookupArgs {
    /// The table
    #[command(flatten)]
    pub table: TableChoice,
    /// CSV with `alpha_x,alpha_y,theta,phi` on each line, angles in radians; `-` for stdin
    #[arg(long, value_name = "CSV")]
    pub points: PathBuf,
    /// Look up this material of a table of layout `materials`, by its place in the recipe's list, from 0; the CSV then has
    /// `theta,phi` on each line
    #[arg(long, value_name = "N")]
    pub material: Option<u32>,
}

/// `report`.
#[derive(Debug, Args)]
pub struct ReportArgs {
    /// The table
    #[command(flatten)]
    pub table: TableChoice,
    /// Nodes to measure, and as many configurations between them, 8 to 1000000 [default: as many as the manifest's
    /// report, which depend on the recipe; 1024 of a `.npy` file]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(8..=1_000_000), hide_default_value = true)]
    pub points: Option<u32>,
    /// Measure the corners of the domain as well: mirrors, needles, the horizon, every fold
    #[arg(long)]
    pub extremes: bool,
    /// Number of threads
    #[command(flatten)]
    pub threads: Threads,
}

/// `verify`.
#[derive(Debug, Args)]
pub struct VerifyArgs {
    /// Tables' files, digests (their first digits suffice) of tables in the folder of `--tables`, addresses of tables of a
    /// service (`http://HOST/v1/tables/sha256:DIGEST`), folders of files that `export` made, or a service's data folder or a
    /// copy of one, whose blobs must hash to their names; a file named after a digest must hash to it
    #[arg(required = true)]
    pub files: Vec<PathBuf>,
    /// The folder of tables
    #[command(flatten)]
    pub folder: TableFolder,
    /// The digest that the table must have, whatever its name
    #[arg(long)]
    pub digest: Option<Digest>,
    /// Fit each table's recipe again as well: it must give the table's bytes, and those of an export's files
    #[arg(long)]
    pub refit: bool,
    /// Entries that a table may have to be fitted [default: 2000000]
    #[arg(long, env = "LTCFORGE_ENTRY_LIMIT", value_name = "N")]
    pub entry_limit: Option<NonZeroU64>,
    /// Number of threads that fit
    #[command(flatten)]
    pub threads: Threads,
}

/// `diff`.
#[derive(Debug, Args)]
pub struct DiffArgs {
    /// A table's file, a `.npy` file of shape alpha x ratio x theta x phi x 3 x 3, or a digest as `fit` prints it (its
    /// first digits suffice) of a table in the folder of `--tables`
    pub a: PathBuf,
    /// Another one
    pub b: PathBuf,
    /// The folder of tables
    #[command(flatten)]
    pub folder: TableFolder,
    /// Nodes of each table to compare and measure, and as many configurations between them, 8 to 1000000 [default: 1024
    /// to compare, and for each report as many as `report` takes]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(8..=1_000_000), hide_default_value = true)]
    pub points: Option<u32>,
    /// Number of threads that measure
    #[command(flatten)]
    pub threads: Threads,
}
