//! Whatever a recipe asks for, its job can be ended and the service stopped.

use std::time::{Duration, Instant};

use crate::common::{
    SMALL,
    server::{Server, text},
};

/// One shard of it takes hours: the dearest legal settings of the solver that looks up least.
const DEAREST: &str = r#"{"preset":"draft","resolution":{"alpha":4,"ratio":4,"theta":4,"phi":4},
    "fit":{"solver":"sgd","samples":65536,"directions":1024,"steps":1000}}"#;

/// Far more than it takes, far less than the work would.
const SOON: Duration = Duration::from_secs(20);

#[test]
fn a_job_of_hours_frees_its_worker_and_lets_the_service_stop() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = Server::start(folder.path(), &["--workers", "1", "--job-seconds", "1000000000"]);
    let job = server.submit(DEAREST).with_status(202).json();
    let seconds = job["expected"]["seconds"].as_f64().expect("a forecast");
    let entries = job["progress"]["entries_total"].as_f64().expect("a count");
    assert!(seconds / entries > 60.0, "an entry is too cheap to tell a stop from its end: {job:#}");
    let id = text(&job["id"]).to_owned();
    server.job_when(&id, |job| job["state"] == "running");
    // In the middle of an entry.
    std::thread::sleep(Duration::from_secs(1));

    let begun = Instant::now();
    let path = format!("/v1/jobs/{id}");
    assert_eq!(server.request("DELETE", &path, &[], None).with_status(200).json()["state"], "cancelled");
    // The only worker is free again.
    server.fit(SMALL);
    assert!(begun.elapsed() < SOON, "{:?}", begun.elapsed());

    server.submit(DEAREST).with_status(202);
    server.job_when(&id, |job| job["state"] == "running");
    std::thread::sleep(Duration::from_secs(1));
    let begun = Instant::now();
    server.stop("TERM").exited(0);
    assert!(begun.elapsed() < SOON, "{:?}", begun.elapsed());
}
