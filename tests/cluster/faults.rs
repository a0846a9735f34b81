//! What the processes of a cluster survive.

use serde_json::Value;

use crate::{
    Shared, Worker,
    common::{
        LARGE, SMALL,
        command::run_with_stdin,
        server::{Server, text},
    },
};

fn entries_done(job: &Value) -> u64 {
    job["progress"]["entries_done"].as_u64().expect("a count")
}

#[test]
fn replicas_share_their_jobs_and_a_killed_worker_s_shards_are_done_by_another() {
    let folder = tempfile::tempdir().expect("a folder");
    let Some(shared) = Shared::new(folder.path()) else { return };
    let expected = run_with_stdin(folder.path(), ["fit", "-", "-o", "fitted"], LARGE).exited(0);
    let args: Vec<&str> = shared.arguments().into_iter().chain(["--no-workers"]).collect();
    let [one, other] = ["one", "other"].map(|name| Server::start(&folder.path().join(name), &args));

    let id = text(&one.submit(LARGE).with_status(202).json()["id"]).to_owned();
    assert_eq!(text(&other.submit(LARGE).with_status(200).json()["id"]), id, "the same job");
    let doomed = Worker::start(&shared, folder.path(), "2");
    let job = one.job_when(&id, |job| entries_done(job) > 0);
    assert_eq!(job["state"], "running", "the job was over before it could be interrupted");
    drop(doomed);
    one.kill();

    // A replica and its clients lose nothing by another's end.
    let _worker = Worker::start(&shared, folder.path(), "2");
    let job = other.finished(&id);
    assert_eq!(job["state"], "done", "{job:#}");
    assert_eq!(job["table"], expected.last_line());
    let path = format!("/v1/tables/{}", expected.last_line());
    let file = other.get(&path).with_status(200);
    assert_eq!(file.header("etag"), Some(format!("\"{}\"", expected.last_line()).as_str()));
    other.get(&format!("{path}/manifest")).with_status(200);
    other.get("/readyz").with_status(200);
}

#[test]
fn a_worker_that_stops_gives_back_and_a_third_replica_knows_all_jobs() {
    let folder = tempfile::tempdir().expect("a folder");
    let Some(shared) = Shared::new(folder.path()) else { return };
    let server = Server::start(&folder.path().join("one"), &shared.arguments());
    let table = server.fit(SMALL);
    assert_eq!(server.stop("TERM").code, Some(0));
    let again = Server::start(&folder.path().join("two"), &shared.arguments());
    let job = again.submit(SMALL).with_status(200).json();
    assert_eq!(job["table"], table);
    assert_eq!(again.metric("ltcforge_entries_fitted_total"), 0, "nothing is fitted twice");
}
