//! `fsck`: whether a data folder is sound.

use std::fmt::Write as _;

use serde_json::json;

use super::{
    CommandFailure, Context, Exit, args::FsckArgs, config_file::ServeSection, print, service_settings::DEFAULT_DATA,
};
use crate::{
    files::job::listed,
    server::service::{CheckReport, check},
};

/// Checks the folder, changes nothing in it, and tells what is wrong and what the next start does about it.
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
    let replaced = "the database is damaged or missing; the next start copies it to quarantine, makes the catalogue again \
                    from the tables, and fits the shards of unfinished jobs again";
    line(store.database_was_replaced, replaced.to_owned());
    line(store.damaged_rows > 0, format!("{} rows of the database do not match their seal", store.damaged_rows));
    let entries = store.damaged_journal_entries;
    let copied = "the next start copies it to quarantine and writes it anew without them";
    line(entries > 0, format!("{entries} entries of the journal of jobs are damaged; {copied}"));
    let incomplete = "the journal of jobs is missing, empty or cut short; the jobs that it had are lost";
    line(store.journal_is_incomplete, incomplete.to_owned());
    let lost = listed(&store.lost_jobs);
    line(!store.lost_jobs.is_empty(), format!("jobs whose last change is lost: {lost}"));
    for digest in damaged_tables {
        line(true, format!("{digest}: its file is damaged; it is moved to quarantine when it is next read"));
    }
    for digest in &catalogue.lost {
        line(true, format!("{digest}: its file is missing; the next start takes it out of the catalogue"));
    }
    for digest in &catalogue.added {
        line(true, format!("{digest}: it is missing in the catalogue; the next start adds it"));
    }
    line(report.is_clean(), "nothing is wrong".to_owned());
    line(!report.is_clean(), "nothing was changed".to_owned());
    out
}
