//! `fsck`: whether a data folder is sound.

use std::fmt::Write as _;

use serde_json::json;

use super::{CommandFailure, Context, Exit, args::FsckArgs, config_file::ServeSection, print, serve::DEFAULT_DATA};
use crate::{
    files::job::listed,
    server::service::{CheckReport, check},
};

/// Checks the folder, mends what can be mended, and tells what was found.
pub(super) fn run(
    args: FsckArgs,
    file: ServeSection,
    json: bool,
    context: &mut Context<'_>,
) -> Result<Exit, CommandFailure> {
    let folder = args.data.or(file.data).unwrap_or_else(|| DEFAULT_DATA.into());
    if !folder.is_dir() {
        return Err(CommandFailure::new(Exit::Failed, format!("{}: no such folder", folder.display())));
    }
    let report = check(&folder).map_err(|error| CommandFailure::new(Exit::Failed, error.to_string()))?;
    let mut value = json!(report);
    value["data"] = json!(folder.to_string_lossy());
    value["clean"] = json!(report.is_clean());
    print(context.stdout, json, &value, text(&report).trim_end())?;
    Ok(if report.is_clean() { Exit::Ok } else { Exit::Mismatch })
}

fn text(report: &CheckReport) -> String {
    let CheckReport { store, catalogue, tables, damaged_tables } = report;
    let mut out = format!("{tables} tables have the bytes of their digests\n");
    let mut line = |found: bool, text: String| {
        if found {
            // Writing to a String cannot fail.
            let _ = writeln!(out, "{text}");
        }
    };
    line(store.database_was_replaced, "the database was damaged; a copy of it is in quarantine".to_owned());
    line(store.damaged_rows > 0, format!("{} rows of the database do not match their seal", store.damaged_rows));
    line(store.restored_rows > 0, format!("{} rows of jobs were restored from their journal", store.restored_rows));
    line(!store.restored_jobs.is_empty(), format!("jobs among them: {}", listed(&store.restored_jobs)));
    let entries = store.damaged_journal_entries;
    line(entries > 0, format!("{entries} entries of the journal of jobs are damaged"));
    let incomplete =
        "the journal of jobs is missing, empty or incomplete: whether the database has lost jobs cannot be proved";
    line(store.journal_is_incomplete, incomplete.to_owned());
    line(!store.lost_jobs.is_empty(), format!("jobs that are lost: {}", listed(&store.lost_jobs)));
    for digest in damaged_tables {
        line(true, format!("{digest}: its file is damaged; it was moved to quarantine"));
    }
    for digest in &catalogue.lost {
        line(true, format!("{digest}: its file is missing; it was taken out of the catalogue"));
    }
    for digest in &catalogue.added {
        line(true, format!("{digest}: it was missing in the catalogue and was added"));
    }
    line(report.is_clean(), "nothing is wrong".to_owned());
    out
}
