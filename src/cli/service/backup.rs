//! `backup` and `restore`: copies of a data folder.

use std::path::PathBuf;

use clap::Args;
use serde_json::json;

use super::{CommandFailure, Context, Exit, place::Place, print, serve::failed, settings::ServeSettings};
use ltcforge_server::service::{Copied, OpenError, back_up, restore};

/// `backup`.
#[derive(Debug, Args)]
pub struct BackupArgs {
    /// Folder of the copy; one that is there is brought up to date
    #[arg(value_name = "TO")]
    pub to: PathBuf,
    /// The data folder of a service, which may be running
    #[command(flatten)]
    pub place: Place,
}

/// `restore`.
#[derive(Debug, Args)]
pub struct RestoreArgs {
    /// Folder of the copy
    #[arg(value_name = "FROM")]
    pub from: PathBuf,
    /// The data folder to make; it must not exist yet
    #[command(flatten)]
    pub place: Place,
}

/// The data folder of these commands.
///
/// # Errors
/// When they are to work on a database: `instead` is what to do then.
fn folder(place: Place, file: ServeSettings, instead: &str) -> Result<PathBuf, CommandFailure> {
    match place {
        Place::Folder(data) => Ok(data.unwrap_or(file.data)),
        Place::Shared { .. } => {
            let refused = format!(
                "this is for a data folder, and a database or a store of tables is set: {instead}, as docs/scale.md says under \
                 «Backing up and restoring», or name a data folder with --data DIR"
            );
            Err(CommandFailure::new(Exit::Usage, refused))
        }
    }
}

/// Copies the data folder.
pub(super) fn back_up_to(
    args: BackupArgs,
    file: ServeSettings,
    json: bool,
    context: &mut Context<'_>,
) -> Result<Exit, CommandFailure> {
    let data = folder(args.place, file, "save it by `pg_dump -Fc`, and copy the store of tables after that")?;
    tell(back_up(&data, &args.to), json, context)
}

/// Makes a data folder of a copy.
pub(super) fn restore_from(
    args: RestoreArgs,
    file: ServeSettings,
    json: bool,
    context: &mut Context<'_>,
) -> Result<Exit, CommandFailure> {
    let data = folder(args.place, file, "restore it by `pg_restore`, and the store of tables if it is lost too")?;
    tell(restore(&args.from, &data), json, context)
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
