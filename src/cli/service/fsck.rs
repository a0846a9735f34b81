//! `fsck`: whether a store is sound, that of a data folder or the one that processes share.

use std::path::Path;

use serde_json::json;

use super::{
    CommandFailure, Context, Exit, args::FsckArgs, cluster, place::Place, print, serve::failed, settings::ServeSettings,
};
use ltcforge_server::service::{CheckReport, DatabaseUrl, Disagreements, SharedReport, check, check_shared};

/// Checks a store, changes nothing in it, and tells the faults and what mends them.
pub(super) fn run(
    args: FsckArgs,
    file: &ServeSettings,
    json: bool,
    context: &mut Context<'_>,
) -> Result<Exit, CommandFailure> {
    let (mut value, text, is_clean) = match args.place {
        Place::Folder(folder) => of_folder(folder.as_ref().unwrap_or(&file.data))?,
        Place::Shared { database: Some(database), blobs: Some(blobs) } => of_shared(database, blobs, file)?,
        Place::Shared { database, .. } => {
            let missing = if database.is_some() { "--blobs" } else { "--database" };
            let refused = format!("{missing} is missing: a database and its store of tables are checked together");
            return Err(CommandFailure::new(Exit::Usage, refused));
        }
    };
    value["clean"] = json!(is_clean);
    print(context.stdout, json, &value, &text)?;
    Ok(if is_clean { Exit::Ok } else { Exit::Mismatch })
}

/// A report: for programs, for people, and whether nothing is wrong.
type Told = (serde_json::Value, String, bool);

fn of_folder(folder: &Path) -> Result<Told, CommandFailure> {
    if !folder.is_dir() {
        return Err(CommandFailure::new(Exit::Failed, format!("{}: no such folder", folder.display())));
    }
    let report = check(folder).map_err(failed)?;
    let mut value = json!(report);
    value["data"] = json!(folder.to_string_lossy());
    Ok((value, text(&report), report.is_clean()))
}

fn of_shared(database: DatabaseUrl, blobs: String, file: &ServeSettings) -> Result<Told, CommandFailure> {
    let shared = cluster::shared_for_all(database, blobs);
    let report = check_shared(&cluster::without_http(None, file), &shared).map_err(failed)?;
    let mut value = json!(report);
    value["blobs"] = json!(shared.blobs);
    Ok((value, shared_text(&report), report.is_clean()))
}

fn text(report: &CheckReport) -> String {
    let CheckReport { store, catalogue, tables, damaged_tables } = report;
    let mut lines = vec![format!("{tables} tables have the bytes of their digests")];
    let damage = store.messages();
    if !damage.is_empty() {
        lines.extend(damage);
        lines.push("a damaged database or journal is copied to quarantine by the next start".to_owned());
    }
    let of_tables = [
        (damaged_tables, "its file is damaged; it is moved to quarantine when it is next read"),
        (&catalogue.lost, "its file is missing or no regular file; the next start takes it out of the catalogue"),
        (&catalogue.missing_brdfs, MISSING_BRDF),
        (&catalogue.added, "it is missing in the catalogue; the next start adds it"),
    ];
    for (digests, what) in of_tables {
        lines.extend(digests.iter().map(|digest| format!("{digest}: {what}")));
    }
    lines.push(if report.is_clean() { "nothing is wrong" } else { "nothing was changed" }.to_owned());
    lines.join("\n")
}

const MISSING_BRDF: &str =
    "the file of this tabulated BRDF is missing, and recipes name it; send it to /v1/brdfs again";

fn shared_text(report: &SharedReport) -> String {
    let SharedReport { tables, files, damaged, disagreements, jobs_without_table, orphans, orphan_bytes } = report;
    let Disagreements { missing_tables, missing_brdfs, incomplete_tables, pinned_unknown, stuck_jobs, is_miscounted } =
        disagreements;
    let mut lines = vec![format!("{tables} tables and {files} other files have the bytes of their digests")];
    let of_files = [
        (
            damaged,
            "the store gives other bytes for it; remove the object, and submit the recipe of the table or send the file again",
        ),
        (missing_tables, "its object is missing; submit its recipe again, which fits it to the same bytes"),
        (missing_brdfs, MISSING_BRDF),
        (
            incomplete_tables,
            "a row of this table is missing or unreadable: its own, its recipe's or the one of its age; take its pins off, \
             delete it, submit its recipe again, and put the pins back",
        ),
        (pinned_unknown, "it has a pin and is not in the catalogue; submit its recipe again, or take the pin off"),
    ];
    for (digests, what) in of_files {
        lines.extend(digests.iter().map(|digest| format!("{digest}: {what}")));
    }
    let stuck =
        "no worker would ever end it, since rows of its shards are missing; cancel it, and submit its recipe again";
    lines.extend(stuck_jobs.iter().map(|job| format!("job {job}: {stuck}")));
    if *is_miscounted {
        lines.push(
            "ltcforge.totals does not count the tables that there are; only the figures of `/metrics` are wrong"
                .to_owned(),
        );
    }
    if *orphans > 0 {
        lines.push(format!(
            "nothing refers to {orphans} blobs, {orphan_bytes} bytes; `ltcforge gc --delete` removes them"
        ));
    }
    if !jobs_without_table.is_empty() {
        let jobs = jobs_without_table.len();
        lines.push(format!(
            "the tables of {jobs} done jobs were removed; submitted again, their recipes are fitted again"
        ));
    }
    lines.push(if report.is_clean() { "nothing is wrong" } else { "nothing was changed" }.to_owned());
    lines.join("\n")
}
