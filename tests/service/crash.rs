//! After a kill, the service continues an unfinished job where it was.

use crate::common::{
    LARGE,
    command::run_with_stdin,
    server::{Server, text},
};

#[test]
fn a_job_interrupted_by_kill_9_gives_the_same_table_without_refitting_finished_shards() {
    let folder = tempfile::tempdir().expect("a folder");
    let expected = run_with_stdin(folder.path(), ["fit", "-", "-o", "fitted"], LARGE).exited(0);
    let data = folder.path().join("data");

    // There is one worker. When half of the entries are done, some shards are finished and others have not started.
    let server = Server::start(&data, &["--workers", "1"]);
    let id = text(&server.submit(LARGE).with_status(202).json()["id"]).to_owned();
    let half = |job: &serde_json::Value| {
        job["progress"]["entries_done"].as_u64() >= job["progress"]["entries_total"].as_u64().map(|total| total / 2)
    };
    let job = server.job_when(&id, half);
    assert_eq!(job["state"], "running", "the job was finished before it could be interrupted");
    let total = job["progress"]["entries_total"].as_u64().expect("a count");
    server.kill();

    let server = Server::start(&data, &[]);
    let job = server.finished(&id);
    assert_eq!(job["table"], expected.last_line(), "{job:#}");
    let fitted = server.metric("ltcforge_entries_fitted_total");
    assert!(0 < fitted && fitted < total, "{fitted} of {total} entries were fitted after the crash");
}

#[test]
fn a_job_stopped_in_the_middle_continues_after_the_restart() {
    let folder = tempfile::tempdir().expect("a folder");
    let data = folder.path().join("data");
    let server = Server::start(&data, &["--workers", "1"]);
    let id = text(&server.submit(LARGE).with_status(202).json()["id"]).to_owned();
    server.job_when(&id, |job| job["progress"]["entries_done"].as_u64() > Some(0));
    assert_eq!(server.stop("INT").code, Some(0));

    let expected = run_with_stdin(folder.path(), ["fit", "-", "-o", "fitted"], LARGE).exited(0);
    let server = Server::start(&data, &[]);
    assert_eq!(server.finished(&id)["table"], expected.last_line());
    assert_ne!(server.metric("ltcforge_entries_fitted_total"), 0, "the job was finished before it could be stopped");
}

/// Killed processes do not count as failures of the job.
#[test]
fn a_job_outlives_more_kills_than_failures() {
    let folder = tempfile::tempdir().expect("a folder");
    let data = folder.path().join("data");
    let start = || Server::start(&data, &["--workers", "2"]);
    let mut server = start();
    let id = text(&server.submit(LARGE).with_status(202).json()["id"]).to_owned();
    for _ in 0..5 {
        server.job_when(&id, |job| job["state"] != "queued");
        server.kill();
        server = start();
    }
    let job = server.finished(&id);
    assert_eq!(job["state"], "done", "{job:#}");
}
