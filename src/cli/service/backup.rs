//! `backup` and `restore`: copies of a data folder.

use std::path::PathBuf;

use clap::Args;
use serde_json::json;

use super::{CommandFailure, Context, Exit, print, serve::failed, settings::ServeSettings};
use ltcforge_server::service::{Copied, OpenError, back_up, restore};

/// `backup`.
#[derive(Debug, Args)]
pub struct BackupArgs {
    /// Folder of the copy; one that is there is brought up to date
    #[arg(value_name = "TO")]
    pub to: PathBuf,
    /// Folder of jobs and tables of a service, which may be running [default: ltcforge-data]
    #[arg(long, env = "LTCFORGE_DATA", value_name = "DIR")]
    pub data: Option<PathBuf>,
}

/// `restore`.
#[derive(Debug, Args)]
pub struct RestoreArgs {
    /// Folder of the copy
    #[arg(value_name = "FROM")]
    pub from: PathBuf,
    /// Folder of jobs and tables to make, which has none yet [default: ltcforge-data]
    #[arg(long, env = "LTCFORGE_DATA", value_name = "DIR")]
    pub data: Option<PathBuf>,
}

/// Copies the data folder.
pub(super) fn back_up_to(
    args: BackupArgs,
    file: ServeSettings,
    json: bool,
    context: &mut Context<'_>,
) -> Result<Exit, CommandFailure> {
    tell(back_up(&args.data.unwrap_or(file.data), &args.to), json, context)
}

/// Makes a data folder of a copy.
pub(super) fn restore_from(
    args: RestoreArgs,
    file: ServeSettings,
    json: bool,
    context: &mut Context<'_>,
) -> Result<Exit, CommandFailure> {
    tell(restore(&args.from, &args.data.unwrap_or(file.data)), json, context)
}

fn tell(copied: Result<Copied, OpenError>, json: bool, context: &mut Context<'_>) -> Result<Exit, CommandFailure> {
    let done = copied.map_err(failed)?;
    let Copied { copied, present, damaged } = &done;
    let mut lines: Vec<String> =
        damaged.iter().map(|digest| format!("{digest}: its file is damaged and was not copied")).collect();
    lines.push(format!("{copied} files were copied, {present} were there"));
    print(context.stdout, json, &json!(done), &lines.join("\n"))?;
    Ok(if damaged.is_empty() { Exit::Ok } else { Exit::Mismatch })
}
