//! `lookup`, `report`, `verify` and `diff`: commands on tables that exist.

use std::{num::NonZeroU64, path::PathBuf};

use clap::Args;

use super::{Threads, named::named};
use ltcforge_client::Limits;
use ltcforge_files::digest::Digest;
use ltcforge_light::{LightModel, NormalsRule};

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
    #[arg(long, env = "LTCFORGE_TABLE_LIMIT", value_name = "BYTES", default_value_t = Limits::USUAL.table_bytes)]
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
    /// A table's file, a `.npy` file of shape alpha x ratio x theta x phi x 3 x 3, or a digest as `fit` prints it (its
    /// first digits suffice) of a table in the folder of `--tables`
    #[arg(required_unless_present("model"))]
    pub table: Option<PathBuf>,
    /// The folder of tables
    #[command(flatten)]
    pub folder: TableFolder,
    /// The model to measure: the table of model `ltc`, the closed form `normals`, or the Gaussian `sg` or `asg`, by the
    /// light of random rectangles, a measure that all share [default: ltc, by its lobes]
    #[arg(long, value_parser = named(LightModel::ALL, LightModel::name))]
    pub model: Option<LightModel>,
    /// The rule of model `normals` [default: all of them]
    #[arg(long, value_parser = named(NormalsRule::ALL, NormalsRule::name))]
    pub rule: Option<NormalsRule>,
    /// Random rectangles that a model is measured by [default: 2000]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(10..=1_000_000))]
    pub lights: Option<u32>,
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
    /// service (`http://HOST/v1/tables/sha256:DIGEST`), or folders of files that `export` made; a file named after a digest
    /// must hash to it
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
