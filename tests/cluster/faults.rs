//! Faults that a cluster must survive.

use std::{sync::Barrier, thread};

use serde_json::Value;

use crate::{
    Shared, Worker,
    common::{
        LARGE, SMALL,
        command::{Run, ltcforge, run_with_stdin},
        eventually, report_skipped,
        server::{Server, text},
    },
    proxy::{Proxy, Upstream},
    throwaway,
};

pub(crate) fn entries_done(job: &Value) -> u64 {
    job["progress"]["entries_done"].as_u64().expect("a count")
}

#[test]
fn replicas_share_jobs_and_another_worker_does_the_shards_of_a_killed_worker() {
    let folder = tempfile::tempdir().expect("a folder");
    let Some(shared) = Shared::new(folder.path()) else { return };
    let expected = run_with_stdin(folder.path(), ["fit", "-", "-o", "fitted"], LARGE).exited(0);
    let [one, other] = ["one", "other"].map(|name| shared.replica(&folder.path().join(name)));

    let id = text(&one.submit(LARGE).with_status(202).json()["id"]).to_owned();
    assert_eq!(text(&other.submit(LARGE).with_status(202).json()["id"]), id, "the same job");
    let doomed = Worker::start(&shared, folder.path(), "2");
    let job = one.job_when(&id, |job| entries_done(job) > 0);
    assert_eq!(job["state"], "running", "the job was finished before it could be interrupted");
    drop(doomed);
    one.kill();

    // Another replica and its clients do not depend on the stopped replica.
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
fn the_same_recipe_at_two_replicas_at_once_is_one_job() {
    let folder = tempfile::tempdir().expect("a folder");
    let Some(mut shared) = Shared::new(folder.path()) else { return };
    let Some(database) = throwaway::Server::start("-c fsync=off") else { return };
    shared.database = database.empty_database();
    let name = shared.database.split(['/', '?']).nth(3).expect("a name").to_owned();
    let replicas = ["one", "other"].map(|replica| {
        let arguments: Vec<&str> =
            shared.arguments().into_iter().chain(["--no-workers", "--queue-limit", "200"]).collect();
        Server::start(&folder.path().join(replica), &arguments)
    });
    for seed in 0..100 {
        let recipe = SMALL.replace("\"steps\":5", &format!("\"steps\":5,\"seed\":{seed}"));
        let ready = Barrier::new(2);
        let [one, other] = thread::scope(|scope| {
            let submit = |replica| {
                ready.wait();
                Server::submit(replica, &recipe).json()["id"].clone()
            };
            replicas.each_ref().map(|replica| scope.spawn(move || submit(replica))).map(|id| id.join().expect("an id"))
        });
        assert!(one.is_string() && one == other, "{seed}: {one} and {other}");
    }
    assert_eq!(database.psql(&name, "SELECT count(*) FROM ltcforge.jobs"), "100");
}

#[test]
fn a_stopped_worker_returns_its_shards_and_a_third_replica_knows_all_jobs() {
    let folder = tempfile::tempdir().expect("a folder");
    let Some(shared) = Shared::new(folder.path()) else { return };
    let server = Server::start(&folder.path().join("one"), &shared.arguments());
    let table = server.fit(SMALL);
    assert_eq!(server.stop("TERM").code, Some(0));
    let again = Server::start(&folder.path().join("two"), &shared.arguments());
    let job = again.submit(SMALL).with_status(200).json();
    assert_eq!(job["table"], table);
    assert_eq!(again.metric("ltcforge_entries_fitted_total"), 0, "an entry was fitted twice");
}

#[test]
fn no_job_is_lost_while_the_database_is_down() {
    let folder = tempfile::tempdir().expect("a folder");
    let Some(mut shared) = Shared::new(folder.path()) else { return };
    let Some(database) = throwaway::Server::start("-c fsync=off") else { return };
    shared.database = database.empty_database();
    let expected = run_with_stdin(folder.path(), ["fit", "-", "-o", "fitted"], LARGE).exited(0);
    let replica = shared.replica(&folder.path().join("replica"));
    let _worker = Worker::start(&shared, folder.path(), "60");
    let id = text(&replica.submit(LARGE).with_status(202).json()["id"]).to_owned();
    replica.job_when(&id, |job| entries_done(job) > 0);

    database.stop();
    let answer = replica.get("/readyz").with_status(503).json();
    assert_eq!(answer["type"], "/problems/unavailable");
    replica.get(&format!("/v1/jobs/{id}")).with_status(503);
    replica.get("/healthz").with_status(200);
    database.start_again();
    eventually("readiness", || (replica.get("/readyz").status == 200).then_some(()));
    let job = replica.finished(&id);
    assert_eq!((&job["state"], &job["table"]), (&"done".into(), &expected.last_line().into()), "{job:#}");
}

#[test]
fn a_standby_takes_over_with_everything_that_was_acknowledged() {
    let folder = tempfile::tempdir().expect("a folder");
    let Some(mut shared) = Shared::new(folder.path()) else { return };
    let Some(primary) = throwaway::Server::start("-c fsync=off") else { return };
    let name_url = primary.empty_database();
    let expected = run_with_stdin(folder.path(), ["fit", "-", "-o", "fitted"], LARGE).exited(0);
    let standby = primary.standby().expect("a standby of a server that runs");
    primary.psql("postgres", "ALTER SYSTEM SET synchronous_standby_names = '*'");
    primary.psql("postgres", "ALTER SYSTEM SET synchronous_commit = 'remote_apply'");
    primary.psql("postgres", "SELECT pg_reload_conf()");
    eventually("a standby that each commit waits for", || {
        let states = primary.psql("postgres", "SELECT sync_state FROM pg_stat_replication");
        (states == "sync" && primary.psql("postgres", "SHOW synchronous_commit") == "remote_apply").then_some(())
    });
    shared.database = name_url;
    let link = Proxy::start(Upstream::Unix(primary.socket()));
    let shared = shared.by(link.address);
    let replica = shared.replica(&folder.path().join("replica"));
    let _worker = Worker::start(&shared, folder.path(), "60");
    let first = replica.fit(SMALL);
    let id = text(&replica.submit(LARGE).with_status(202).json()["id"]).to_owned();
    replica.job_when(&id, |job| entries_done(job) > 0);

    primary.stop();
    standby.psql("postgres", "SELECT pg_promote()");
    standby.psql("postgres", "ALTER SYSTEM SET synchronous_standby_names = ''");
    standby.psql("postgres", "SELECT pg_reload_conf()");
    link.lead_to(Upstream::Unix(standby.socket()));
    let job = replica.finished(&id);
    assert_eq!((&job["state"], &job["table"]), (&"done".into(), &expected.last_line().into()), "{job:#}");
    assert_eq!(replica.submit(SMALL).with_status(200).json()["table"], first);
}

/// Leases expire by the database's clock, not by the worker's.
#[test]
fn workers_clocks_that_are_an_hour_off_have_no_effect() {
    let folder = tempfile::tempdir().expect("a folder");
    let Some(shared) = Shared::new(folder.path()) else { return };
    let Some(library) = faketime() else {
        report_skipped("faketime is not installed, which gives a process another clock");
        return;
    };
    let replica = shared.replica(&folder.path().join("replica"));
    // If leases expired by the workers' clocks, one worker would take the shards of the other at once.
    let _workers = ["-1h", "+1h"].map(|offset| {
        let clock = [("LD_PRELOAD", library.as_str()), ("FAKETIME", offset), ("FAKETIME_DONT_FAKE_MONOTONIC", "1")];
        let environment = clock.map(|(name, value)| (name.to_owned(), value.to_owned())).into();
        Worker::start(&Shared { environment, ..shared.clone() }, folder.path(), "60")
    });
    let job = replica.finished(text(&replica.submit(LARGE).with_status(202).json()["id"]));
    assert_eq!((&job["state"], &job["attempts"]), (&"done".into(), &1.into()), "{job:#}");
}

/// After the error, the tables and jobs in the folder are intact.
#[test]
fn a_clock_before_1970_is_reported_and_damages_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    let Some(library) = faketime() else {
        report_skipped("faketime is not installed, which gives a process another clock");
        return;
    };
    let data = folder.path().join("data");
    let server = Server::start(&data, &[]);
    let table = server.fit(SMALL);
    assert_eq!(server.stop("TERM").code, Some(0));
    let mut command = ltcforge(folder.path(), ["serve", "--listen", "127.0.0.1:0", "--data", "data"]);
    command.env("LD_PRELOAD", library).env("FAKETIME", "@1969-12-31 12:00:00").env("FAKETIME_DONT_FAKE_MONOTONIC", "1");
    let run: Run = command.output().expect("the binary runs").into();
    let run = run.exited(1);
    assert!(run.stderr.contains("before 1970; set the clock"), "{run:#?}");
    assert!(!data.join("quarantine").exists(), "{run:#?}");
    let server = Server::start(&data, &[]);
    assert_eq!(server.submit(SMALL).with_status(200).json()["table"], table);
}

#[test]
fn a_replica_whose_role_cannot_write_is_not_ready_and_says_why() {
    let folder = tempfile::tempdir().expect("a folder");
    let Some(mut shared) = Shared::new(folder.path()) else { return };
    let Some(database) = throwaway::Server::start("-c fsync=off") else { return };
    shared.database = database.empty_database();
    let name = shared.database.split(['/', '?']).nth(3).expect("a name").to_owned();
    drop(shared.replica(&folder.path().join("owner")));
    database.psql(
        &name,
        "CREATE ROLE reader LOGIN; GRANT USAGE ON SCHEMA ltcforge TO reader;
         GRANT SELECT ON ALL TABLES IN SCHEMA ltcforge TO reader",
    );
    shared.database = shared.database.replace("postgres@", "reader@");
    let replica = shared.replica(&folder.path().join("reader"));
    for path in ["/readyz", "/v1/jobs"] {
        let answer = if path == "/readyz" { replica.get(path) } else { replica.submit(SMALL) };
        let problem = answer.with_status(503).json();
        assert_eq!(problem["type"], "/problems/unavailable", "{problem:#}");
        assert!(text(&problem["detail"]).contains("jobs"), "{problem:#}");
    }
    database.psql(
        &name,
        "GRANT ALL ON ALL TABLES IN SCHEMA ltcforge TO reader; GRANT ALL ON ALL SEQUENCES IN SCHEMA ltcforge TO reader",
    );
    replica.get("/readyz").with_status(200);
    replica.submit(SMALL).with_status(202);
}

/// The library that gives a program another clock, at the path where Debian installs it.
fn faketime() -> Option<String> {
    let folders = std::fs::read_dir("/usr/lib").ok()?.filter_map(Result::ok);
    let mut libraries = folders.map(|folder| folder.path().join("faketime/libfaketimeMT.so.1"));
    Some(libraries.find(|library| library.exists())?.to_str()?.to_owned())
}
