//! A job with any recipe can be cancelled, and the service can be stopped, without waiting for the current work.

use crate::common::{
    SMALL,
    server::{Server, text},
};

/// Entries per shard.
const SHARD: u64 = 64;

/// Largest processor time of the service until a shard has stopped, in seconds. A shard checks every few hundredths of
/// a second whether to stop. One step of the most expensive recipe takes six seconds.
const MOST_SECONDS: f64 = 3.0;

/// A recipe with the most expensive allowed settings. It has four shards. Each takes minutes or hours.
fn most_expensive(what: &str, fit: &str) -> String {
    format!(r#"{{"preset":"draft",{what},"fit":{{{fit},"samples":65536,"directions":1024,"steps":1000}}}}"#)
}

const ANISOTROPIC: &str = r#""resolution":{"alpha":4,"ratio":4,"theta":4,"phi":4}"#;
const GAUSSIANS: &str = r#""lobe":"asg","resolution":{"alpha":4,"ratio":4,"theta":4,"phi":4}"#;
const SHEEN: &str = r#""brdf":"charlie","layout":"ltc2017","resolution":{"alpha":16,"theta":16}"#;
const ISOTROPIC: &str = r#""layout":"ltc2017","resolution":{"alpha":16,"theta":16}"#;

#[test]
fn a_job_of_any_length_frees_its_worker_and_lets_the_service_stop() {
    let folder = tempfile::tempdir().expect("a folder");
    let start = || Server::start(folder.path(), &["--workers", "1", "--job-seconds", "1000000000"]);
    let recipes = [
        most_expensive(ANISOTROPIC, r#""solver":"sgd""#),
        most_expensive(ANISOTROPIC, r#""solver":"bfgs""#),
        most_expensive(GAUSSIANS, r#""solver":"bfgs""#),
        most_expensive(ISOTROPIC, r#""solver":"nelder_mead","metric":"l3""#),
        most_expensive(SHEEN, r#""solver":"nelder_mead""#),
    ];
    for recipe in &recipes {
        let server = start();
        let job = server.submit(recipe).with_status(202).json();
        let path = format!("/v1/jobs/{}", text(&job["id"]));
        let running = || server.job_when(text(&job["id"]), |job| job["state"] == "running");
        running();
        let before = server.processor_seconds();
        assert_eq!(server.request("DELETE", &path, &[], None).with_status(200).json()["state"], "cancelled");
        // The only worker is available again, although the shard is not finished.
        server.fit(SMALL);
        let taken = server.processor_seconds() - before;
        assert!(taken < MOST_SECONDS, "{recipe}: {taken} s until another job was done");
        let done = server.get(&path).with_status(200).json()["progress"]["entries_done"].clone();
        assert!(done.as_u64().is_some_and(|done| done < SHARD), "{recipe}: {done}");

        server.submit(recipe).with_status(202);
        running();
        let (run, taken) = server.stop_and_measure("TERM");
        run.exited(0);
        assert!(taken < MOST_SECONDS, "{recipe}: {taken} s until the service had stopped");
        let server = start();
        let again = server.get(&path).with_status(200).json();
        assert!(again["state"] == "running" || again["state"] == "queued", "{again:#}");
        assert_eq!(server.request("DELETE", &path, &[], None).with_status(200).json()["state"], "cancelled");
        server.stop("TERM").exited(0);
    }
}
