//! `lock` and `pull`: tables that a project pins.

use std::{ffi::OsString, num::NonZeroU64, path::PathBuf};

use clap::Args;

use super::{ExportChoice, TableLimit, Threads};

/// The sources of pinned tables.
#[derive(Debug, Args)]
pub struct SourceArgs {
    /// The lock file; paths are relative to its folder
    #[arg(long, value_name = "FILE", default_value = "ltcforge.lock")]
    pub lock: PathBuf,
    /// Look for tables here: the URL of a service, or a folder of `<digest>.safetensors` files; give it several times
    /// to look in several places, in this order [default: --server, or what the lock file and the configuration name]
    #[arg(long, value_name = "URL|DIR")]
    pub from: Vec<OsString>,
    /// Use no server, only folders
    #[arg(long)]
    pub offline: bool,
    /// The longest table whose size the lock file does not state
    #[command(flatten)]
    pub limit: TableLimit,
    /// Entries that a table may have to be fitted [default: 2000000]
    #[arg(long, env = "LTCFORGE_ENTRY_LIMIT", value_name = "N")]
    pub entry_limit: Option<NonZeroU64>,
    /// Number of threads that fit and measure
    #[command(flatten)]
    pub threads: Threads,
}

/// The end of the names of a plan's second recipe and of its table's pin.
const SHEEN: &str = "-sheen";

/// `lock`.
#[derive(Debug, Args)]
pub struct LockArgs {
    /// The table's name in the project; without one, all pins are written anew, with the files that this program makes
    pub name: Option<String>,
    /// The table: its file, or its digest, which must be complete if the table comes from a source [default: the one
    /// that is pinned under this name]
    #[arg(conflicts_with = "recipe")]
    pub table: Option<PathBuf>,
    /// The table of this recipe: its file, `-` for stdin, or the name of a preset. It is fitted, unless it is there
    #[arg(long)]
    pub recipe: Option<PathBuf>,
    /// The tables of a plan: the folder that `plan` wrote its recipes to. That of sheen is pinned as NAME-sheen
    #[arg(long, value_name = "DIR", conflicts_with_all = ["table", "recipe"])]
    pub plan: Option<PathBuf>,
    /// Path of the table, relative to the lock file's folder and below it [default: NAME.safetensors]
    #[arg(long, value_name = "PATH", requires = "name")]
    pub to: Option<PathBuf>,
    /// Files to make from the table and to pin as well
    #[command(flatten)]
    pub export: ExportChoice,
    /// Their folder, relative to the lock file's and below it
    #[arg(short, long, value_name = "DIR", requires = "name")]
    pub out: Option<PathBuf>,
    /// Remove the pin of this name; its files stay
    #[arg(long, requires = "name", conflicts_with_all = ["table", "recipe", "plan", "to", "out"])]
    pub remove: bool,
    /// Folder that is searched for a digest first [default: the working folder, then `tables` in it]
    #[arg(long, value_name = "DIR")]
    pub tables: Option<PathBuf>,
    /// The sources of tables
    #[command(flatten)]
    pub sources: SourceArgs,
}

impl LockArgs {
    /// The recipes that the command line names, by itself or as those of a plan, and what their pins' names end in.
    pub(crate) fn recipes(&self) -> Vec<(&'static str, PathBuf)> {
        let Some(folder) = &self.plan else {
            return self.recipe.iter().map(|recipe| ("", recipe.clone())).collect();
        };
        let of = |end: &'static str| (end, folder.join(format!("recipe{end}.json")));
        let mut found = ["", SHEEN].map(of).to_vec();
        found.retain(|(_, path)| path.exists());
        // An error about a folder without recipes names the first.
        if found.is_empty() { vec![of("")] } else { found }
    }
}

/// `pull`.
#[derive(Debug, Args)]
pub struct PullArgs {
    /// Change nothing; fail with exit code 3 when a file is missing or has other bytes
    #[arg(long, conflicts_with_all = ["from", "fit", "offline"])]
    pub locked: bool,
    /// Fit a table from its recipe if no source has it; it must have the pinned digest
    #[arg(long)]
    pub fit: bool,
    /// The sources of tables
    #[command(flatten)]
    pub sources: SourceArgs,
}
