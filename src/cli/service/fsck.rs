//! `fsck`: whether a data folder is sound.

use serde_json::json;

use super::{CommandFailure, Context, Exit, args::FsckArgs, print, settings::ServeSettings};
use ltcforge_server::service::{CheckReport, check};

/// Checks the folder, changes nothing in it, and tells the faults and how the next start mends them.
pub(super) fn run(
    args: FsckArgs,
    file: ServeSettings,
    json: bool,
    context: &mut Context<'_>,
) -> Result<Exit, CommandFailure> {
    let folder = args.data.unwrap_or(file.data);
    if !folder.is_dir() {
        return Err(CommandFailure::new(Exit::Failed, format!("{}: no such folder", folder.display())));
    }
    let report = check(&folder).map_err(|error| CommandFailure::new(Exit::Failed, error.to_string()))?;
    let mut value = json!(report);
    value["data"] = json!(folder.to_string_lossy());
    value["clean"] = json!(report.is_clean());
    print(context.stdout, json, &value, &text(&report))?;
    Ok(if report.is_clean() { Exit::Ok } else { Exit::Mismatch })
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
        (
            &catalogue.missing_brdfs,
            "the file of this tabulated BRDF is missing, and recipes name it; send it to /v1/brdfs again",
        ),
        (&catalogue.added, "it is missing in the catalogue; the next start adds it"),
    ];
    for (digests, what) in of_tables {
        lines.extend(digests.iter().map(|digest| format!("{digest}: {what}")));
    }
    lines.push(if report.is_clean() { "nothing is wrong" } else { "nothing was changed" }.to_owned());
    lines.join("\n")
}
