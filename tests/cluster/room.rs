//! A database that has no room for another connection.

use std::{
    fs::{self, File},
    io::{BufRead as _, BufReader},
    path::{Path, PathBuf},
    process::{Child, ChildStdout, Stdio},
    thread,
    time::Duration,
};

use crate::{
    Shared,
    common::{
        LARGE, SMALL,
        command::{ltcforge, run, run_with_stdin, signal},
        eventually,
        server::{Server, text},
    },
    faults::entries_done,
    throwaway,
};

/// Connections that PostgreSQL keeps for its superuser, as by default.
const KEPT: usize = 3;

/// Connections of other programs.
const OTHERS: usize = 6;

/// What a process says that waits for room.
const TOLD: &str = "has no room for another connection";

/// A worker with one connection of its pool, which may have to wait for it. Killed when dropped.
struct Waiting {
    child: Child,
    stdout: BufReader<ChildStdout>,
    log: PathBuf,
}

impl Drop for Waiting {
    fn drop(&mut self) {
        // It may have ended already.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

impl Waiting {
    fn start(shared: &Shared, folder: &Path, name: &str) -> Self {
        let log = folder.join(name);
        let own = ["--workers", "1", "--lease-seconds", "2", "--data", "data", "--database-connections", "1"];
        let named = Shared { database: format!("{}&application_name=worker", shared.database), ..shared.clone() };
        let mut command = ltcforge(folder, ["work"].iter().chain(&named.arguments()).chain(&own));
        let mut child = command.stderr(File::create(&log).expect("a file")).spawn().expect("the binary runs");
        let stdout = BufReader::new(child.stdout.take().expect("a pipe"));
        Self { child, stdout, log }
    }

    /// The lines of its log that say that it waits.
    fn told(&self) -> Vec<String> {
        let log = fs::read_to_string(&self.log).expect("a log");
        log.lines().filter(|line| line.contains(TOLD)).map(str::to_owned).collect()
    }

    /// The first line of its output, or nothing if it ends before.
    fn line(&mut self) -> String {
        let mut line = String::new();
        self.stdout.read_line(&mut line).expect("a line on stdout or its end");
        line
    }
}

#[test]
fn a_database_without_room_is_waited_for_and_costs_no_job() {
    let folder = tempfile::tempdir().expect("a folder");
    let Some(mut shared) = Shared::new(folder.path()) else { return };
    let settings =
        format!("-c fsync=off -c superuser_reserved_connections={KEPT} -c max_connections={}", KEPT + OTHERS + 2);
    let Some(database) = throwaway::Server::start(&settings) else { return };
    let url = database.empty_database();
    let name = url.split(['/', '?']).nth(3).expect("a name").to_owned();
    database.psql(&name, &format!("CREATE ROLE farm LOGIN; GRANT CREATE ON DATABASE {name} TO farm"));
    shared.database = url.replace("postgres@", "farm@");
    let expected = run_with_stdin(folder.path(), ["fit", "-", "-o", "fitted"], LARGE).exited(0);

    let one = ["--no-workers", "--database-connections", "1"];
    let arguments: Vec<&str> = shared.arguments().into_iter().chain(one).collect();
    let replica = Server::start(&folder.path().join("replica"), &arguments);
    let connections = || -> usize {
        let count = "SELECT count(*) FROM pg_stat_activity WHERE usename = 'farm'";
        database.psql(&name, count).parse().expect("a number")
    };
    eventually("a replica with all that it may have", || (connections() == 2).then_some(()));
    // The superuser's programs take what there is beside the replica's.
    let mut others: Vec<Child> = (0..OTHERS)
        .map(|_| {
            let mut psql = database.client("psql");
            psql.args(["-d", &name, "-c", "SELECT pg_sleep(3600)"]);
            psql.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("psql")
        })
        .collect();
    let sleeping = "SELECT count(*) FROM pg_stat_activity WHERE query = 'SELECT pg_sleep(3600)'";
    eventually("others with all that there is", || {
        (database.psql(&name, sleeping) == OTHERS.to_string()).then_some(())
    });

    let id = text(&replica.submit(SMALL).with_status(202).json()["id"]).to_owned();
    let mut worker = Waiting::start(&shared, folder.path(), "worker");
    let mut stopped = Waiting::start(&shared, folder.path(), "stopped");
    for process in [&worker, &stopped] {
        let line = eventually("words on what is lacking", || process.told().pop());
        assert!(line.contains("max_connections") && line.contains("--database-connections: here it is 1"), "{line}");
        assert!(line.contains(&format!("the database {name} on ")), "{line}");
    }
    signal(&stopped.child, "TERM");
    assert_eq!((stopped.child.wait().expect("an end").code(), stopped.line().as_str()), (Some(0), ""));
    let end = |which: &str| {
        let ended = "SELECT count(pg_terminate_backend(pid)) FROM pg_stat_activity WHERE";
        assert_ne!(database.psql(&name, &format!("{ended} {which}")), "0");
    };
    end("query = 'SELECT pg_sleep(3600)'");
    for other in &mut others {
        other.wait().expect("an end");
    }
    assert!(worker.line().starts_with("working"));
    assert_eq!(replica.finished(&id)["state"], "done");

    // In the middle of a job it loses what it has, and its role may have no more than the replica.
    let id = text(&replica.submit(LARGE).with_status(202).json()["id"]).to_owned();
    replica.job_when(&id, |job| entries_done(job) > 0);
    database.psql(&name, "ALTER ROLE farm CONNECTION LIMIT 2");
    end("application_name = 'worker'");
    thread::sleep(Duration::from_secs(3));
    database.psql(&name, "ALTER ROLE farm CONNECTION LIMIT -1");
    let job = replica.finished(&id);
    assert_eq!((&job["state"], &job["table"]), (&"done".into(), &expected.last_line().into()), "{job:#}");
    assert_eq!(worker.told().len(), 1, "{:#?}", worker.told());
}

#[test]
fn a_number_of_connections_that_is_out_of_range_is_told() {
    let folder = tempfile::tempdir().expect("a folder");
    for command in ["serve", "work"] {
        for number in ["0", "257", "many"] {
            let shared = ["--database", "postgres://127.0.0.1:1/x", "--blobs", "file:///x"];
            let args = [command, "--database-connections", number];
            let refused = run(folder.path(), args.iter().chain(&shared)).exited(2);
            let told =
                format!("invalid value '{number}' for '--database-connections <N>': it is a number from 1 to 256");
            assert!(refused.stderr.contains(&told), "{refused:#?}");
        }
    }
}
