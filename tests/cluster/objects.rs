//! Object stores that are down, slow, full or broken, or that send other bytes.

use crate::{
    Shared, Worker,
    common::{LARGE, SMALL, eventually, server::text},
    proxy::{Link, Proxy, Upstream},
    s3::S3,
};

/// A database, an S3 server, and a proxy in front of it that the processes use.
fn shared_on_s3(folder: &std::path::Path) -> Option<(Shared, S3, Proxy)> {
    let mut shared = Shared::new(folder)?;
    let server = S3::start()?;
    let link = Proxy::start(Upstream::Tcp(server.address));
    "s3://tables/ltc".clone_into(&mut shared.blobs);
    shared.environment = S3::environment(link.address);
    Some((shared, server, link))
}

#[test]
fn uploads_are_retried_until_they_succeed_and_readers_get_no_wrong_bytes() {
    let folder = tempfile::tempdir().expect("a folder");
    let Some((shared, _server, link)) = shared_on_s3(folder.path()) else { return };
    let replica = shared.replica(&folder.path().join("one"));
    let _worker = Worker::start(&shared, folder.path(), "60");

    link.set(Link::Answers(500));
    let id = text(&replica.submit(SMALL).with_status(202).json()["id"]).to_owned();
    // The store is broken, without permission, full, or down. Each state must reject an upload before the next state.
    for next in [Link::Answers(403), Link::Answers(507), Link::Down, Link::Slow] {
        let before = link.refused();
        eventually("an upload", || (link.refused() > before).then_some(()));
        let job = replica.get(&format!("/v1/jobs/{id}")).with_status(200).json();
        assert!(job["state"] == "queued" || job["state"] == "running", "{job:#}");
        link.set(next);
    }
    let job = replica.finished(&id);
    assert_eq!(job["state"], "done", "{job:#}");
    let table = text(&job["table"]).to_owned();

    // This replica has never read the table, so its cache is empty.
    let other = shared.replica(&folder.path().join("other"));
    let path = format!("/v1/tables/{table}");
    link.set(Link::Answers(403));
    other.get(&path).with_status(503);
    link.set(Link::OtherBytes);
    other.get(&path).with_status(503);
    link.set(Link::Down);
    other.get(&path).with_status(503);
    other.get("/readyz").with_status(503);
    link.set(Link::Slow);
    let whole = other.get(&path).with_status(200);
    link.set(Link::Up);
    other.get("/readyz").with_status(200);
    let part = other.request("GET", &path, &[("range", "bytes=1-4")], None).with_status(206);
    assert_eq!(part.body, whole.body[1..5]);
    other.request("GET", &path, &[("if-none-match", &format!("\"{table}\""))], None).with_status(304);
    // With the link down, the replica serves the table from its cache.
    link.set(Link::Down);
    assert_eq!(other.get(&path).with_status(200).body, whole.body);
}

/// An upload takes longer than one lease.
#[test]
fn a_slow_link_to_the_store_causes_no_errors() {
    let folder = tempfile::tempdir().expect("a folder");
    let Some((shared, _server, link)) = shared_on_s3(folder.path()) else { return };
    let replica = shared.replica(&folder.path().join("one"));
    let _worker = Worker::start(&shared, folder.path(), "3");
    link.set(Link::Slow);
    let job = replica.finished(text(&replica.submit(LARGE).with_status(202).json()["id"]));
    assert_eq!((&job["state"], &job["attempts"]), (&"done".into(), &1.into()), "{job:#}");
}

#[test]
fn a_store_without_the_bucket_or_the_permission_is_named() {
    let folder = tempfile::tempdir().expect("a folder");
    let Some((shared, _server, link)) = shared_on_s3(folder.path()) else { return };
    let complaint_with = |blobs: &str, more: &[(&str, &str)]| {
        let args = ["work", "--database", &shared.database, "--blobs", blobs];
        let mut command = crate::common::command::ltcforge(folder.path(), args);
        command.envs(shared.environment.iter().map(|(name, value)| (name, value))).envs(more.iter().copied());
        let run: crate::common::command::Run = command.output().expect("the binary runs").into();
        let run = run.exited(1);
        assert!(!run.stderr.contains("hunter2"), "{run:#?}");
        let [line] = run.complaints()[..] else { panic!("{run:#?}") };
        line.to_owned()
    };
    let complaint = |blobs: &str| complaint_with(blobs, &[]);
    let line = complaint_with("s3://tables/ltc", &[("AWS_ENDPOINT", "http://me:hunter2@127.0.0.1:1")]);
    assert!(line.contains("the environment variable AWS_ENDPOINT has a user or a password"), "{line}");
    let line = complaint("s3://nowhere/ltc");
    assert!(line.contains("s3://nowhere/ltc does not exist"), "{line}");
    link.set(Link::Answers(403));
    let line = complaint("s3://tables/ltc");
    assert!(line.contains("s3://tables/ltc cannot be written"), "{line}");
}
