//! `fsck`: whether a data folder is sound.

use std::fmt::Write as _;

use serde_json::json;

use super::{
    CommandFailure, Context, Exit, args::FsckArgs, config_file::ServeSection, print, service_settings::DEFAULT_DATA,
};
use ltcforge_files::job::listed;
use ltcforge_server::service::{CheckReport, check};

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
    let CheckReport { store, jobs, catalogue, tables, damaged_tables } = report;
    let mut out = format!("{tables} tables have the bytes of their digests\n");
    let mut line = |found: bool, text: String| {
        if found {
            // Writing to a String cannot fail.
            let _ = writeln!(out, "{text}");
        }
    };
    let replaced = "the database is damaged or missing; the next start copies what there is to quarantine, and restores \
                    jobs from the journal and the catalogue from the tables; jobs that the end of the journal has lost as \
                    well are lost";
    line(store.database_was_replaced, replaced.to_owned());
    let older = "the database is older than the journal of jobs: jobs that the end of the journal has lost as well leave \
                 no trace";
    line(store.database_is_older && !store.database_was_replaced, older.to_owned());
    line(store.damaged_rows > 0, format!("{} rows of the database do not match their seal", store.damaged_rows));
    let rows = store.restored_rows;
    line(
        rows > 0,
        format!(
            "the database lacks {rows} rows of jobs, or has older ones; the next start restores them from the journal"
        ),
    );
    line(!store.restored_jobs.is_empty(), format!("jobs that are restored: {}", listed(&store.restored_jobs)));
    let reverted = "jobs that the database has as they once were; the next start copies it to quarantine and takes the \
                    journal's state";
    line(!store.reverted_jobs.is_empty(), format!("{reverted}: {}", listed(&store.reverted_jobs)));
    let entries = store.damaged_journal_entries;
    let copied = "the next start copies it to quarantine and writes it anew";
    line(entries > 0, format!("{entries} entries of the journal of jobs are damaged; {copied}"));
    let incomplete = "the journal of jobs is missing, empty or incomplete: whether the database has lost or \
                      reverted jobs cannot be proved";
    line(store.journal_is_incomplete, incomplete.to_owned());
    let lost = report.lost_jobs();
    line(!lost.is_empty(), format!("jobs that are lost: {}", listed(&lost)));
    let doubtful = "jobs that may be lost; damaged entries of the journal name them, and an id may be misread";
    line(!store.doubtful_jobs.is_empty(), format!("{doubtful}: {}", listed(&store.doubtful_jobs)));
    let missing = listed(&jobs.listed);
    line(!jobs.listed.is_empty(), format!("jobs that are missing in the list; the next start adds them: {missing}"));
    let places = jobs.places_without_job;
    line(places > 0, format!("{places} places in the list of jobs belong to no job; the next start removes them"));
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
