//! The runbook of `docs/scale.md`: the database is dumped, the store copied after it, and both restored elsewhere.

use std::{
    path::Path,
    process::{Command, Stdio},
};

use crate::{
    Shared, Worker,
    common::{
        SMALL,
        command::run,
        seeded,
        server::{Server, text},
    },
    throwaway,
};

/// One of PostgreSQL's programs on a database of the shared server.
fn client(program: &str, database: &str, args: &[&str]) {
    let mut command = throwaway::shared().expect("a server").client(program);
    let done = command.args(["-d", database]).args(args).stdin(Stdio::null()).status().expect("the program runs");
    assert!(done.success(), "{program} {args:?}");
}

fn copy(from: &Path, to: &Path) {
    assert!(Command::new("cp").arg("-a").arg(from).arg(to).status().expect("cp").success());
}

#[test]
fn a_dump_and_a_copy_of_the_store_are_a_backup() {
    let folder = tempfile::tempdir().expect("a folder");
    let here = folder.path();
    let Some(shared) = Shared::new(here) else { return };
    let replica = shared.replica(&here.join("replica"));
    let worker = Worker::start(&shared, here, "60");
    let table = replica.fit(SMALL);
    let path = format!("/v1/tables/{table}");
    let (bytes, pins) = (replica.get(&path).with_status(200).body, format!("{path}/pins"));
    replica.request("PUT", &format!("{pins}/film"), &[], None).with_status(201);
    let pinned = replica.get(&pins).with_status(200).json();
    drop(worker);
    let waiting = text(&replica.submit(&seeded(1)).with_status(202).json()["id"]).to_owned();

    let dump = here.join("dump");
    let dump = dump.to_str().expect("a path in UTF-8");
    client("pg_dump", shared.name(), &["-Fc", "-f", dump]);
    // The processes go on between the two, and after them.
    let worker = Worker::start(&shared, here, "60");
    let later = replica.fit(&seeded(2));
    assert_eq!(replica.finished(&waiting)["state"], "done");
    copy(&shared.store(), &here.join("copy"));
    drop((worker, replica));

    let blobs = format!("file://{}", here.join("copy").display());
    let database = throwaway::empty_database().expect("a database");
    let restored = Shared { database, blobs, environment: vec![] };
    client("pg_restore", restored.name(), &["--clean", "--if-exists", "--single-transaction", dump]);
    let fsck = || run(here, ["fsck"].iter().chain(&restored.arguments())).exited(0).stdout;
    // The store is newer, and has the tables of the two jobs that ended since.
    assert_eq!(fsck(), "1 tables and 2 other files have the bytes of their digests\nnothing is wrong\n");
    let replica = Server::start(&here.join("other"), &[&restored.arguments()[..], &["--no-workers"]].concat());
    assert!(replica.get(&path).with_status(200).body == bytes);
    assert_eq!(replica.get(&pins).with_status(200).json(), pinned);
    assert_eq!(replica.submit(SMALL).with_status(200).json()["table"], table);
    assert_eq!(replica.get(&format!("/v1/jobs/{waiting}")).with_status(200).json()["state"], "queued");
    let _worker = Worker::start(&restored, here, "60");
    assert_eq!(replica.finished(&waiting)["state"], "done");
    assert_eq!(replica.fit(&seeded(2)), later);
    assert_eq!(fsck(), "3 tables and 0 other files have the bytes of their digests\nnothing is wrong\n");
}
