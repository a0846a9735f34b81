//! Metrics and health of workers and of the queue, as operators see them.

use std::io::{BufRead as _, BufReader};

use crate::{
    Shared, Worker,
    common::{
        LARGE, SMALL,
        command::{ltcforge, run},
        eventually,
        server::text,
    },
};

/// The value of a metric in the text of `/metrics`.
fn figure(metrics: &str, name: &str) -> f64 {
    let value = metrics.lines().find_map(|line| line.strip_prefix(name)?.strip_prefix(' '));
    value.unwrap_or_else(|| panic!("no {name} in {metrics}")).parse().expect("a number")
}

fn get(url: &str, path: &str) -> (u16, String) {
    let agent: ureq::Agent = ureq::Agent::config_builder().http_status_as_error(false).proxy(None).build().into();
    let mut answer = agent.get(format!("{url}{path}")).call().expect("an answer");
    (answer.status().as_u16(), answer.body_mut().read_to_string().expect("a text"))
}

#[test]
fn a_worker_reports_its_health_at_its_own_address() {
    let folder = tempfile::tempdir().expect("a folder");
    let Some(shared) = Shared::new(folder.path()) else { return };
    let args = ["work", "--workers", "1", "--listen"];
    let refused = run(folder.path(), args.iter().chain(&["0.0.0.0:0"]).chain(&shared.arguments())).exited(2);
    assert!(refused.complaints()[0].contains("--allow-anyone"), "{refused:#?}");

    let mut command = ltcforge(folder.path(), args.iter().chain(&["127.0.0.1:0"]).chain(&shared.arguments()));
    let mut child = command.spawn().expect("the binary runs");
    let stdout = child.stdout.take().expect("a pipe");
    let _worker = Worker(child);
    let mut line = String::new();
    BufReader::new(stdout).read_line(&mut line).expect("a line");
    let url = line.trim().strip_prefix("working with 1 threads, listening on ").expect("an address").to_owned();
    for (path, status) in [("/healthz", 200), ("/readyz", 200), ("/version", 200), ("/v1/jobs", 404), ("/", 404)] {
        assert_eq!(get(&url, path).0, status, "{path}");
    }

    let replica = shared.replica(&folder.path().join("replica"));
    replica.fit(SMALL);
    let (status, metrics) = get(&url, "/metrics");
    assert_eq!((status, figure(&metrics, "ltcforge_entries_fitted_total")), (200, 16.0), "{metrics}");
    assert_eq!(figure(&metrics, "ltcforge_queue_core_seconds"), 0.0);
    assert_eq!(replica.metric("ltcforge_entries_fitted_total"), 0, "it does not fit");
}

/// Every process reports the same queue depth.
#[test]
fn the_depth_of_the_queue_falls_as_jobs_are_done() {
    let folder = tempfile::tempdir().expect("a folder");
    let Some(shared) = Shared::new(folder.path()) else { return };
    let replica = shared.replica(&folder.path().join("replica"));
    let metrics = || String::from_utf8(replica.get("/metrics").with_status(200).body).expect("UTF-8");
    assert_eq!(figure(&metrics(), "ltcforge_queue_oldest_seconds"), 0.0);
    let id = text(&replica.submit(LARGE).with_status(202).json()["id"]).to_owned();
    let before = metrics();
    let waiting = r#"ltcforge_queue_shards{state="waiting"}"#;
    assert!(figure(&before, waiting) > 4.0 && figure(&before, "ltcforge_queue_core_seconds") > 0.0, "{before}");
    let older = eventually("a second that passes", || {
        let metrics = metrics();
        (figure(&metrics, "ltcforge_queue_oldest_seconds") > 1.0).then_some(metrics)
    });
    assert_eq!(figure(&older, waiting), figure(&before, waiting), "no worker takes jobs");
    let _worker = Worker::start(&shared, folder.path(), "60");
    replica.finished(&id);
    let after = metrics();
    for name in [
        waiting,
        r#"ltcforge_queue_shards{state="leased"}"#,
        "ltcforge_queue_core_seconds",
        "ltcforge_queue_oldest_seconds",
    ] {
        assert_eq!(figure(&after, name), 0.0, "{after}");
    }
}
