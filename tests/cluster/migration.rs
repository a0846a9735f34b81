//! Migrating a data folder.

use std::{fs, path::PathBuf};

use serde_json::Value;

use crate::{
    Shared,
    common::{
        ENDLESS, SMALL,
        command::run,
        seeded,
        server::{Server, text},
    },
    faults::entries_done,
};

#[test]
fn tables_and_jobs_are_taken_along_once() {
    let folder = tempfile::tempdir().expect("a folder");
    let Some(shared) = Shared::new(folder.path()) else { return };
    let data = folder.path().join("data");
    let server = Server::start(&data, &["--workers", "1"]);
    let table = server.fit(SMALL);
    let pins = format!("/v1/tables/{table}/pins");
    server.request("PUT", &format!("{pins}/film"), &[], None).with_status(201);
    let pinned = server.get(&pins).with_status(200).json();
    let endless = text(&server.submit(ENDLESS).with_status(202).json()["id"]).to_owned();
    let running = server.job_when(&endless, |job| job["state"] == "running");
    assert_eq!(server.stop("TERM").code, Some(0));

    let migrate = || -> Value {
        let args = ["migrate", "--to", &shared.database, "--blobs", &shared.blobs, "--data", "data", "--json"];
        serde_json::from_str(run(folder.path(), args).exited(0).last_line()).expect("JSON")
    };
    let first = migrate();
    assert_eq!((&first["tables"], &first["jobs"], &first["missing"]), (&1.into(), &2.into(), &0.into()), "{first}");
    let again = migrate();
    assert_eq!((&again["tables"], &again["jobs"]), (&0.into(), &0.into()), "{again}");

    let args: Vec<&str> = shared.arguments().into_iter().chain(["--no-workers"]).collect();
    let replica = Server::start(&folder.path().join("replica"), &args);
    assert_eq!(replica.submit(SMALL).with_status(200).json()["table"], table);
    replica.get(&format!("/v1/tables/{table}")).with_status(200);
    assert_eq!(replica.get(&pins).with_status(200).json(), pinned);
    let job = replica.get(&format!("/v1/jobs/{endless}")).with_status(200).json();
    assert_eq!(job["state"], "running");
    // The database has microseconds; zeros at the end are not written.
    let microseconds = |time: &Value| {
        let time = text(time).trim_end_matches('Z');
        let (seconds, fraction) = time.split_once('.').unwrap_or((time, ""));
        format!("{seconds}.{fraction:0<6.6}")
    };
    for field in ["created_at", "started_at"] {
        assert_eq!(microseconds(&job[field]), microseconds(&running[field]), "{field} of {job:#}");
    }
}

/// Tables are copied newest first. A folder is where the oldest table's file would be, so that the migration fails
/// after the others and before the jobs.
#[test]
fn an_interrupted_migration_goes_on_where_it_ended() {
    let folder = tempfile::tempdir().expect("a folder");
    let Some(shared) = Shared::new(folder.path()) else { return };
    let server = Server::start(&folder.path().join("data"), &["--workers", "1"]);
    let tables: Vec<String> = (0..4).map(|seed| server.fit(&seeded(seed))).collect();
    let endless = text(&server.submit(ENDLESS).with_status(202).json()["id"]).to_owned();
    // A shard of it has 256 entries.
    server.job_when(&endless, |job| entries_done(job) > 256);
    assert_eq!(server.stop("TERM").code, Some(0));
    let oldest = tables[0].strip_prefix("sha256:").expect("a digest");
    let store: PathBuf = shared.blobs.strip_prefix("file://").expect("a folder").into();
    let obstacle = store.join(&oldest[..2]).join(oldest);
    fs::create_dir_all(obstacle.join("obstacle")).expect("a folder");

    let arguments = ["migrate", "--to", &shared.database, "--blobs", &shared.blobs, "--data", "data", "--json"];
    run(folder.path(), arguments).exited(1);
    let args: Vec<&str> = shared.arguments().into_iter().chain(["--no-workers"]).collect();
    let replica = Server::start(&folder.path().join("replica"), &args);
    for table in &tables[1..] {
        replica.get(&format!("/v1/tables/{table}")).with_status(200);
    }
    replica.get(&format!("/v1/tables/{}", tables[0])).with_status(404);
    replica.get(&format!("/v1/jobs/{endless}")).with_status(404);

    fs::remove_dir_all(&obstacle).expect("no obstacle");
    let rest: Value = serde_json::from_str(run(folder.path(), arguments).exited(0).last_line()).expect("JSON");
    assert_eq!((&rest["tables"], &rest["jobs"], &rest["missing"]), (&1.into(), &5.into(), &0.into()), "{rest}");
    replica.get(&format!("/v1/tables/{}", tables[0])).with_status(200);
    let job = replica.get(&format!("/v1/jobs/{endless}")).with_status(200).json();
    assert!(entries_done(&job) >= 256, "{job:#}");
}
