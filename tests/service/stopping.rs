//! Whatever a recipe asks for, its job can be ended and the service stopped. A shard that does not stop outlasts the test.

use std::time::Duration;

use crate::common::{
    DEADLINE, SMALL,
    server::{Server, text},
};

/// Entries of a shard.
const SHARD: f64 = 64.0;

/// Four shards, each of which takes minutes or hours, by the dearest legal settings of a solver.
fn dearest(solver: &str) -> String {
    format!(
        r#"{{"preset":"draft","resolution":{{"alpha":4,"ratio":4,"theta":4,"phi":4}},
            "fit":{{"solver":"{solver}","samples":65536,"directions":1024,"steps":1000}}}}"#
    )
}

#[test]
fn a_job_of_any_length_frees_its_worker_and_lets_the_service_stop() {
    let folder = tempfile::tempdir().expect("a folder");
    let start = || Server::start(folder.path(), &["--workers", "1", "--job-seconds", "1000000000"]);
    for solver in ["sgd", "bfgs"] {
        let server = start();
        let job = server.submit(&dearest(solver)).with_status(202).json();
        let seconds = job["expected"]["seconds"].as_f64().expect("a forecast");
        let entries = job["progress"]["entries_total"].as_f64().expect("a count");
        let shard = Duration::from_secs_f64(seconds / entries * SHARD);
        assert!(
            shard > DEADLINE,
            "{solver}: a shard of {shard:?} is too cheap to tell a stop from its end: {job:#}"
        );
        let path = format!("/v1/jobs/{}", text(&job["id"]));
        let running = || server.job_when(text(&job["id"]), |job| job["state"] == "running");
        running();
        assert_eq!(server.request("DELETE", &path, &[], None).with_status(200).json()["state"], "cancelled");
        // The only worker is free again.
        server.fit(SMALL);

        server.submit(&dearest(solver)).with_status(202);
        running();
        server.stop("TERM").exited(0);
        let server = start();
        let again = server.get(&path).with_status(200).json();
        assert!(again["state"] == "running" || again["state"] == "queued", "{again:#}");
        assert_eq!(server.request("DELETE", &path, &[], None).with_status(200).json()["state"], "cancelled");
        server.stop("TERM").exited(0);
    }
}
