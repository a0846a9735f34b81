//! Many workers on one database: which connections they hold and what they cost it, at rest and while they fit. A handful of
//! workers, or as many as `LTCFORGE_TEST_WORKERS` says; `--nocapture` shows the figures.

use std::{
    collections::BTreeMap,
    fs,
    path::Path,
    process::{Child, Command, Stdio},
    thread,
    time::{Duration, Instant},
};

use crate::{
    Shared, Worker,
    common::{server::text, soak::rounds},
    pgbouncer::{Pooler, pgbouncer},
    throwaway::Server,
};

const WORKERS: usize = 6;

/// Connections of a worker, at most: three of its pool, and one that listens.
const MOST: usize = 4;

/// Workers that start at the same time.
const STARTING: usize = 8;

/// Longer than by default: hundreds of workers on one machine wait for its cores, and none is to count as dead for that.
const LEASE_SECONDS: &str = "600";

/// How long figures are taken at rest.
const REST: Duration = Duration::from_secs(2);

/// A worker keeps a connection that it does not use for a minute, and looks for such twice a minute.
const UNUSED: Duration = Duration::from_secs(95);

/// Clock ticks of `/proc` a second: what Linux shows to every program.
const TICKS: f64 = 100.0;

/// A job of two shards or more for each of `workers`.
fn recipe(workers: usize) -> String {
    let phi = workers.div_ceil(2).max(2);
    format!(
        r#"{{"preset":"draft","resolution":{{"alpha":8,"ratio":8,"theta":8,"phi":{phi}}},
        "fit":{{"samples":128,"directions":8,"steps":5}}}}"#
    )
}

/// Seconds of processor time of a process; with those of its children that have ended, if `all`.
fn processor_seconds(process: &str, all: bool) -> f64 {
    // It may have ended.
    let Ok(stat) = fs::read_to_string(format!("/proc/{process}/stat")) else { return 0.0 };
    let fields: Vec<&str> = stat.rsplit(')').next().unwrap_or_default().split_whitespace().collect();
    let ticks = |field: usize| fields.get(field).and_then(|ticks| ticks.parse::<f64>().ok()).expect("a number");
    (11..if all { 15 } else { 13 }).map(ticks).sum::<f64>() / TICKS
}

/// Processor time of a server's processes so far, and its transactions in the database called `name`.
fn spent(server: &Server, name: &str) -> (f64, f64) {
    let file = fs::read_to_string(server.folder().join("data/postmaster.pid")).expect("the server runs");
    let first = file.lines().next().expect("a process").to_owned();
    let children = fs::read_to_string(format!("/proc/{first}/task/{first}/children")).expect("its children");
    let seconds = processor_seconds(&first, true)
        + children.split_whitespace().map(|child| processor_seconds(child, false)).sum::<f64>();
    let done = format!("SELECT xact_commit + xact_rollback FROM pg_stat_database WHERE datname = '{name}'");
    (seconds, server.psql("postgres", &done).parse().expect("a number"))
}

/// Kilobytes that a process shares with no other, and its part of what it shares.
fn kilobytes(process: u32) -> u64 {
    let sizes = fs::read_to_string(format!("/proc/{process}/smaps_rollup")).expect("a process that runs");
    let size = sizes.lines().find_map(|line| line.strip_prefix("Pss:")).expect("its size");
    size.trim().trim_end_matches(" kB").trim().parse().expect("a number")
}

/// Looks at the connections of a database again and again, until it is dropped.
struct Watch {
    psql: Child,
    file: std::path::PathBuf,
}

impl Drop for Watch {
    fn drop(&mut self) {
        let _ = self.psql.kill();
        let _ = self.psql.wait();
    }
}

impl Watch {
    /// Of the database called `name`.
    fn start(server: &Server, name: &str, folder: &Path) -> Self {
        let file = folder.join("connections");
        let script = folder.join("watch.sql");
        let look = format!(
            "SELECT application_name || '=' || count(*) FROM pg_stat_activity
            WHERE datname = '{name}' AND backend_type = 'client backend' GROUP BY application_name \\watch 0.1\n"
        );
        fs::write(&script, look).expect("a file");
        let mut psql: Command = server.client("psql");
        psql.args(["-XAtq", "-d", "postgres", "-f"]).arg(&script);
        psql.stdin(Stdio::null()).stdout(fs::File::create(&file).expect("a file")).stderr(Stdio::null());
        Self { psql: psql.spawn().expect("psql"), file }
    }

    /// The most that there were at the same time, by the name that they gave.
    fn most(&self) -> BTreeMap<String, usize> {
        let mut most = BTreeMap::new();
        for line in fs::read_to_string(&self.file).expect("what it saw").lines() {
            if let Some((name, count)) = line.rsplit_once('=')
                && let Ok(count) = count.parse::<usize>()
            {
                let before = most.entry(name.to_owned()).or_default();
                *before = count.max(*before);
            }
        }
        most
    }
}

/// Workers, started a few at a time, whose connections are called `worker`.
fn start(shared: &Shared, folder: &Path, count: usize) -> Vec<Worker> {
    let named = Shared { database: format!("{}&application_name=worker", shared.database), ..shared.clone() };
    let mut workers = Vec::new();
    while workers.len() < count {
        let next = STARTING.min(count - workers.len());
        workers.extend(thread::scope(|scope| {
            let starting: Vec<_> =
                (0..next).map(|_| scope.spawn(|| Worker::start(&named, folder, LEASE_SECONDS))).collect();
            starting.into_iter().map(|worker| worker.join().expect("a worker")).collect::<Vec<_>>()
        }));
    }
    workers
}

/// Runs a fleet on `shared`, which is the database `name` of `server` or a pooler before it, and prints its figures. Returns
/// the connections to the server while it fits.
fn run(server: &Server, name: &str, shared: &Shared, folder: &Path, of: &str) -> usize {
    let count = rounds("LTCFORGE_TEST_WORKERS", WORKERS);
    let replica = shared.replica(&folder.join("replica"));
    // Gets a row for each finished shard, and for each worker that was lost or failed.
    server.psql(
        name,
        "CREATE TABLE public.finished (worker text, submission bigint, task integer);
        CREATE TABLE public.lost (LIKE public.finished);
        CREATE FUNCTION public.note() RETURNS trigger LANGUAGE plpgsql AS $$ BEGIN
            EXECUTE format('INSERT INTO public.%I VALUES ($1, $2, $3)', TG_ARGV[0])
                USING regexp_replace(OLD.worker, '/[0-9a-f]+$', ''), OLD.submission, OLD.task;
            RETURN NEW; END $$;
        CREATE TRIGGER finished AFTER UPDATE ON ltcforge.tasks FOR EACH ROW
            WHEN (NEW.state = 'finished') EXECUTE FUNCTION public.note('finished');
        CREATE TRIGGER lost AFTER UPDATE ON ltcforge.tasks FOR EACH ROW
            WHEN (NEW.deaths > OLD.deaths OR NEW.failures > OLD.failures) EXECUTE FUNCTION public.note('lost')",
    );
    let watch = Watch::start(server, name, folder);
    let begun = Instant::now();
    let workers = start(shared, folder, count);
    println!("{of}: {count} workers started in {:.1} s, {:?} at most", begun.elapsed().as_secs_f64(), watch.most());
    drop(watch);

    let is_short = count == WORKERS;
    thread::sleep(if is_short { Duration::ZERO } else { UNUSED });
    let (begun, watch) = (Instant::now(), Watch::start(server, name, folder));
    let of_workers =
        || workers.iter().map(|worker| processor_seconds(&worker.process().to_string(), false)).sum::<f64>();
    let (before, worked) = (spent(server, name), of_workers());
    thread::sleep(if is_short { REST } else { 10 * REST });
    let (after, seconds) = (spent(server, name), begun.elapsed().as_secs_f64());
    println!(
        "{of}: at rest {:?} at most, {:.0} transactions a second, {:.3} cores of PostgreSQL, {:.3} of all workers",
        watch.most(),
        (after.1 - before.1) / seconds,
        (after.0 - before.0) / seconds,
        (of_workers() - worked) / seconds
    );
    drop(watch);

    let (begun, watch) = (Instant::now(), Watch::start(server, name, folder));
    let before = spent(server, name);
    let job = replica.finished(text(&replica.submit(&recipe(count)).with_status(202).json()["id"]));
    let (after, seconds) = (spent(server, name), begun.elapsed().as_secs_f64());
    let most = watch.most();
    assert_eq!(job["state"], "done", "{job:#}");
    println!(
        "{of}: a job in {seconds:.1} s, {most:?} at most, {:.0} transactions a second, {:.3} cores of PostgreSQL",
        (after.1 - before.1) / seconds,
        (after.0 - before.0) / seconds
    );
    drop(watch);
    let mut sizes: Vec<u64> = workers.iter().map(|worker| kilobytes(worker.process())).collect();
    sizes.sort_unstable();
    let took_part = "SELECT format('%s shards by %s workers', count(*), count(DISTINCT worker)) FROM public.finished";
    println!("{of}: {}, of {} to {} kB", server.psql(name, took_part), sizes[0], sizes[sizes.len() - 1]);
    let twice = "SELECT count(*) - count(DISTINCT (submission, task)) FROM public.finished";
    assert_eq!(server.psql(name, twice), "0", "a shard was fitted twice");
    assert_eq!(server.psql(name, "SELECT count(*) FROM public.lost"), "0", "a worker was lost or failed");
    most["worker"]
}

/// An empty database of `server`, a store that goes with it in `folder`, and the name of the database.
fn on(server: &Server, folder: &Path, shared: Shared) -> (Shared, String) {
    let (database, blobs) = (server.empty_database(), folder.join("store"));
    fs::create_dir_all(&blobs).expect("a folder");
    let name = database.split(['/', '?']).nth(3).expect("a name").to_owned();
    (Shared { database, blobs: format!("file://{}", blobs.display()), ..shared }, name)
}

#[test]
fn a_fleet_fits_no_shard_twice_within_its_connections() {
    let folder = tempfile::tempdir().expect("a folder");
    let Some(shared) = Shared::new(folder.path()) else { return };
    let count = rounds("LTCFORGE_TEST_WORKERS", WORKERS);
    let Some(server) = Server::start(&format!("-c max_connections={}", 17 * count + 40)) else { return };
    let (shared, name) = on(&server, &folder.path().join("directly"), shared);
    let most = run(&server, &name, &shared, folder.path(), "directly");
    assert!(most <= MOST * count, "{most} connections of {count} workers");
}

#[test]
fn a_fleet_behind_pgbouncer_has_a_connection_to_the_server_for_each_of_its_own() {
    let folder = tempfile::tempdir().expect("a folder");
    let Some((program, _)) = pgbouncer() else { return };
    let Some(shared) = Shared::new(folder.path()) else { return };
    let most = 4 * rounds("LTCFORGE_TEST_WORKERS", WORKERS) + 40;
    let Some(server) = Server::start(&format!("-c max_connections={most}")) else { return };
    let (shared, name) = on(&server, &folder.path().join("behind"), shared);
    let settings = format!("pool_mode = session\nmax_client_conn = {most}\ndefault_pool_size = {most}");
    let pooler = Pooler::start(&program, &server, &name, "", &settings);
    // It keeps a connection to the server for some time after its client has ended.
    let served = run(&server, &name, &shared.by(pooler.address), folder.path(), "behind pgbouncer");
    assert!(rounds("LTCFORGE_TEST_WORKERS", WORKERS) < served, "{served} connections");
}
