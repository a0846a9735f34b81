//! The queue in PostgreSQL by itself: no shard is fitted.
//!
//! `cargo bench -p ltcforge-benches --bench cluster`, or with `--profile dev` what the tests have compiled already. It
//! starts a PostgreSQL of its own that waits for its disk, as Debian's package has it, and needs about 500 MB in the
//! folder for temporary files.

use std::{
    num::{NonZeroU32, NonZeroUsize},
    sync::{
        Arc,
        atomic::{AtomicBool, AtomicU64, Ordering},
    },
    thread,
    time::{Duration, Instant},
};

use ltcforge::{
    files::digest::Digest,
    server::{
        queue::{
            Demand, JobId, Lease, Limits, NewJob, Offer, Queue as _,
            postgres::{PostgresQueue, Process},
        },
        store::Database,
    },
};

#[path = "../src/server/store/postgres/tests/throwaway.rs"]
mod throwaway;

/// The first database of a server.
const DATABASE: &str = "test0";
/// The leased tasks of unfinished jobs.
const LEASED: &str = "SELECT format('%s to %s', min(leased), max(leased)) FROM (
    SELECT (SELECT count(*) FROM ltcforge.tasks AS t WHERE t.submission = s.submission AND t.state = 'leased') AS leased
    FROM ltcforge.serving AS s) AS jobs";
/// Shards of a large job: those of a table of 16 million entries.
const SHARDS: usize = 250_000;
/// Large jobs.
const JOBS: usize = 4;
/// Shards of a small job, and such jobs.
const SMALL: (usize, usize) = (64, 1000);
/// Simulated workers, each with connections of its own.
const WORKERS: usize = 64;
/// How long they work.
const TIME: Duration = Duration::from_secs(10);
/// Bytes of a shard's result: 64 entries of 12 numbers.
const RESULT: usize = 64 * 12 * 8;

fn open(url: &str, name: &str) -> PostgresQueue {
    let limits = Limits {
        jobs: 10_000,
        lease_ttl: Duration::from_secs(60),
        max_attempts: NonZeroU32::MIN,
        keep_ended: None,
        most_ended: None,
    };
    let process = Process { name: name.to_owned(), fitter: 1 };
    PostgresQueue::open(Database::open(url).expect("a database"), limits, process).expect("a queue")
}

fn submit(queue: &PostgresQueue, name: &str, shards: usize) -> Duration {
    let recipe_digest = Digest::of(name.as_bytes());
    let new = NewJob { recipe: name.to_owned(), recipe_digest, shard_entries: vec![64; shards], by: None };
    let start = Instant::now();
    queue.submit(new, &|_| false).expect("a job");
    start.elapsed()
}

/// Half of them take at most the first time, and all but one in a hundred the second.
fn quantiles(mut times: Vec<Duration>) -> String {
    times.sort_unstable();
    let at = |part: f64| times[((times.len() - 1) as f64 * part) as usize].as_secs_f64() * 1e3;
    format!("median {:.1} ms, 99 of 100 within {:.1} ms", at(0.5), at(0.99))
}

fn timed(repeated: usize, mut work: impl FnMut()) -> String {
    let time = |_| {
        let start = Instant::now();
        work();
        start.elapsed()
    };
    quantiles((0..repeated).map(time).collect())
}

fn lease(queue: &PostgresQueue, most: usize) -> Vec<Lease> {
    match queue.lease(Demand::Any, NonZeroUsize::new(most).expect("at least one")) {
        Offer::Tasks(tasks) => tasks.iter().map(|task| task.lease).collect(),
        Offer::Nothing { .. } | Offer::Closed => vec![],
    }
}

fn complete(queue: &PostgresQueue, leases: &[Lease], result: &[u8]) -> u64 {
    let done: Vec<(Lease, &[u8])> = leases.iter().map(|lease| (*lease, result)).collect();
    let answers = queue.complete(&done).expect("an answer");
    answers.iter().filter(|answer| answer.is_ok()).count() as u64
}

/// Figures of workers that sleep for each shard's time: shards a second, the tasks that each unfinished job has leased
/// at least and at most, how long a new job waits for its first lease, and how long a lease takes.
fn rate(server: &throwaway::Server, at_once: usize, shard: Duration) -> String {
    let url = &server.url(DATABASE);
    let (ended, shards) = (Arc::new(AtomicBool::new(false)), Arc::new(AtomicU64::new(0)));
    let workers: Vec<_> = (0..WORKERS)
        .map(|number| {
            let (url, ended, shards) = (url.clone(), Arc::clone(&ended), Arc::clone(&shards));
            thread::spawn(move || {
                let queue = open(&url, &number.to_string());
                let result: Vec<u8> = (0..RESULT).map(|byte| byte as u8).collect();
                let mut times = vec![];
                while !ended.load(Ordering::Relaxed) {
                    let start = Instant::now();
                    let leases = lease(&queue, at_once);
                    times.push(start.elapsed());
                    thread::sleep(shard * u32::try_from(leases.len()).expect("few"));
                    shards.fetch_add(complete(&queue, &leases, &result), Ordering::Relaxed);
                }
                times
            })
        })
        .collect();
    // All have connected by then.
    thread::sleep(Duration::from_secs(3));
    let (start, before) = (Instant::now(), shards.load(Ordering::Relaxed));
    thread::sleep(TIME);
    let rate = (shards.load(Ordering::Relaxed) - before) as f64 / start.elapsed().as_secs_f64();
    let leased = server.psql(DATABASE, LEASED);
    let queue = open(url, "bench");
    let name = format!("new {at_once} {shard:?} {rate}");
    submit(&queue, &name, SMALL.0);
    let (submitted, id) = (Instant::now(), JobId::of_recipe(&Digest::of(name.as_bytes())));
    while queue.job(id).expect("an answer").is_some_and(|job| job.started_at.is_none()) {
        thread::sleep(Duration::from_millis(1));
    }
    let waited = submitted.elapsed().as_secs_f64() * 1e3;
    ended.store(true, Ordering::Relaxed);
    let times = quantiles(workers.into_iter().flat_map(|worker| worker.join().expect("a worker")).collect());
    format!(
        "{WORKERS} workers that sleep {} ms a shard, {at_once} a lease: {rate:.0} shards a second; a job has {leased} leased; \
         a new one waits {waited:.0} ms; a lease: {times}",
        shard.as_millis()
    )
}

fn main() {
    let Some(server) = throwaway::Server::start("-c shared_buffers=256MB -c max_wal_size=4GB") else { return };
    let url = server.empty_database();
    let start = Instant::now();
    let queue = open(&url, "bench");
    println!("the schema and the first connection: {:.0} ms", start.elapsed().as_secs_f64() * 1e3);
    drop(queue);
    let start = Instant::now();
    let queue = open(&url, "bench");
    println!("connecting again: {:.0} ms", start.elapsed().as_secs_f64() * 1e3);
    for number in 0..JOBS {
        let time = submit(&queue, &format!("large {number}"), SHARDS);
        println!("submitting {SHARDS} shards: {:.0} ms", time.as_secs_f64() * 1e3);
    }
    println!("with {} shards in the queue", SHARDS * JOBS);
    println!("  a lease of 16: {}", timed(300, || assert_eq!(lease(&queue, 16).len(), 16)));
    println!("  a page of 20 jobs: {}", timed(300, || drop(queue.list(None, None, 20).expect("a page"))));
    for (at_once, shard) in [(16, 1), (16, 4), (1, 1)] {
        println!("  {}", rate(&server, at_once, Duration::from_millis(shard)));
    }
    for number in 0..SMALL.1 {
        submit(&queue, &format!("small {number}"), SMALL.0);
    }
    println!("with {} jobs of {} shards as well", SMALL.1, SMALL.0);
    println!("  a lease of 16: {}", timed(300, || drop(lease(&queue, 16))));
    println!("  a page of 20 jobs: {}", timed(300, || drop(queue.list(None, None, 20).expect("a page"))));
    println!("  {}", rate(&server, 16, Duration::from_millis(1)));
}
