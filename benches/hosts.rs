//! What it costs to share a database and a store of tables, and what a second worker gains.
//!
//! `cargo bench -p ltcforge-benches --bench hosts`. The shared service is compared with the embedded one, job by job in turn;
//! two workers with one, on several jobs at once. PostgreSQL is one of the bench's own that waits for its disk, the store a
//! folder.

use std::{
    num::NonZeroUsize,
    thread,
    time::{Duration, Instant},
};

use ltcforge::server::{
    queue::{JobId, StateName},
    service::{Service, Shared, SubmitReply},
};

mod default_config;
#[path = "../src/server/store/postgres/throwaway.rs"]
mod throwaway;

use default_config::config;

/// Turns of each.
const TURNS: u32 = 5;
/// Jobs at once when workers are compared.
const JOBS: u32 = 4;
/// Bytes of tables that a process keeps in its folder.
const CACHE_BYTES: u64 = 16 << 20;

fn workers(threads: usize) -> NonZeroUsize {
    NonZeroUsize::new(threads).expect("at least one")
}

/// A default table of its own.
fn recipe(seed: u32) -> String {
    format!(r#"{{"preset":"paper","fit":{{"seed":{seed}}}}}"#)
}

fn submit(service: &Service, recipe: &str) -> JobId {
    match service.submit(recipe.as_bytes()).expect("a job") {
        SubmitReply::InFlight { job, .. } | SubmitReply::Ready { job, .. } => job.id,
    }
}

fn wait(service: &Service, id: JobId, is_there: fn(StateName) -> bool) {
    while !service.job(id).expect("an answer").is_some_and(|found| is_there(found.job.state.name())) {
        thread::sleep(Duration::from_millis(20));
    }
}

/// Seconds until the tables of `seeds`, submitted together, are stored.
fn seconds(service: &Service, seeds: impl Iterator<Item = u32>) -> f64 {
    let start = Instant::now();
    let jobs: Vec<JobId> = seeds.map(|seed| submit(service, &recipe(seed))).collect();
    for id in jobs {
        wait(service, id, StateName::is_final);
        assert_eq!(service.job(id).expect("an answer").expect("a job").job.state.name(), StateName::Done);
    }
    start.elapsed().as_secs_f64()
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// Prints the medians of both, and of their ratio in each turn.
fn compare(name: &str, unit: &str, pairs: &[[f64; 2]]) {
    let [one, other] = [0, 1].map(|side| median(pairs.iter().map(|pair| pair[side]).collect()));
    let ratio = median(pairs.iter().map(|pair| pair[1] / pair[0]).collect());
    println!("{name}: {one:.3} and {other:.3} {unit}, ratio {ratio:.3} (medians of {} turns)", pairs.len());
}

fn main() {
    let Some(server) = throwaway::Server::start("-c shared_buffers=128MB") else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let database = || server.empty_database().parse().expect("any text");
    let blobs = format!("file://{}", folder.path().join("tables").display());
    let shared = Shared { database: database(), blobs: blobs.clone(), cache_bytes: CACHE_BYTES };
    let open = |shared: &Shared, name: &str, threads, works| {
        Service::open_shared(config(&folder.path().join(name), workers(threads)), shared, works).expect("a service")
    };

    let embedded = Service::open(config(&folder.path().join("embedded"), workers(2))).expect("a service");
    let cluster = open(&shared, "cluster", 2, true);
    seconds(&embedded, 0..1);
    seconds(&cluster, 0..1);
    let pairs: Vec<_> =
        (1..=TURNS).map(|seed| [&embedded, &cluster].map(|service| seconds(service, seed..=seed))).collect();
    compare("a default table, embedded and shared", "s", &pairs);
    embedded.stop();
    cluster.stop();

    // A database of their own: no table is known yet.
    let replica = Shared { database: database(), ..shared.clone() };
    let front = open(&replica, "front", 1, false);
    let one = open(&replica, "one", 1, true);
    let mut pairs = vec![];
    for turn in 0..TURNS {
        let first = 2 * turn * JOBS;
        let alone = seconds(&front, first..first + JOBS);
        let two = open(&replica, "two", 1, true);
        let both = seconds(&front, first + JOBS..first + 2 * JOBS);
        two.stop();
        pairs.push([both, alone]);
    }
    one.stop();
    compare(&format!("{JOBS} default tables by two workers and by one, a thread each"), "s", &pairs);
    let mut pairs = vec![];
    for turn in 0..TURNS {
        let first = (2 * TURNS + 2 * turn) * JOBS;
        let times = [2, 1].map(|threads| {
            let service = open(&replica, "threads", threads, true);
            let seconds = seconds(&front, (first + threads as u32 * JOBS)..(first + (threads as u32 + 1) * JOBS));
            service.stop();
            seconds
        });
        pairs.push(times);
    }
    compare(&format!("{JOBS} default tables by two threads of one worker and by one"), "s", &pairs);

    let mut times = vec![];
    for turn in 0..TURNS {
        let id = submit(&front, &recipe(1_000_000 + turn));
        let start = Instant::now();
        let worker = open(&replica, "late", 2, true);
        wait(&front, id, |state| state != StateName::Queued);
        times.push(1e3 * start.elapsed().as_secs_f64());
        wait(&front, id, StateName::is_final);
        worker.stop();
    }
    println!("from the start of a worker to its first lease: {:.0} ms (median of {TURNS})", median(times));
    front.stop();
}
