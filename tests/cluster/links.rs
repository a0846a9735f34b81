//! A worker whose link to the database is down for longer than its leases.

use std::path::PathBuf;

use crate::{
    Shared, Worker,
    common::{LARGE, SMALL, command::run_with_stdin, server::text},
    faults::entries_done,
    proxy::{Link, Proxy, Upstream},
    throwaway,
};

#[test]
fn a_worker_that_was_cut_off_is_replaced_and_goes_on_later() {
    let folder = tempfile::tempdir().expect("a folder");
    let Some(mut shared) = Shared::new(folder.path()) else { return };
    let Some(database) = throwaway::Server::start("-c fsync=off") else { return };
    shared.database = database.empty_database();
    let name = shared.database.split(['/', '?']).nth(3).expect("a name").to_owned();
    let expected = run_with_stdin(folder.path(), ["fit", "-", "-o", "fitted"], LARGE).exited(0);
    let link = Proxy::start(Upstream::Unix(PathBuf::from(database.socket())));
    let replica = shared.replica(&folder.path().join("replica"));
    let cut_off = Worker::start(&shared.by(link.address), folder.path(), "2");
    let id = text(&replica.submit(LARGE).with_status(202).json()["id"]).to_owned();
    replica.job_when(&id, |job| entries_done(job) > 0);

    link.set(Link::Held);
    let other = Worker::start(&shared, folder.path(), "2");
    let job = replica.finished(&id);
    assert_eq!((&job["state"], &job["table"]), (&"done".into(), &expected.last_line().into()), "{job:#}");
    assert!(job["attempts"].as_u64().expect("a count") >= 2, "the shard was leased again: {job:#}");
    drop(other);

    // What it was fitting is refused, and it works on what there is then.
    link.set(Link::Up);
    let job = replica.finished(text(&replica.submit(SMALL).with_status(202).json()["id"]));
    assert_eq!(job["state"], "done", "{job:#}");
    assert_eq!(database.psql(&name, "SELECT count(*) FROM ltcforge.tasks"), "0", "a late result was taken");
    drop(cut_off);
}
