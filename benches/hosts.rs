//! The cost of sharing a database and a table store, and the gain from a second worker.
//!
//! `cargo bench -p ltcforge-benches --bench hosts` runs every part. With `-- PART` it runs only one: `tables`, `large`,
//! `workers`, `threads` or `start`. It compares the shared service with the embedded service. The jobs of the two
//! services alternate. It also compares two workers with one, on several jobs at once and on one larger job. The bench
//! starts its own PostgreSQL, with synchronous writes. The store is a folder. Times come from the queue's clock, so
//! measuring them takes no processor time.

use std::{
    num::NonZeroUsize,
    sync::Arc,
    time::{SystemTime, UNIX_EPOCH},
};

use ltcforge::server::{
    queue::{Job, JobId, StateName},
    service::{Service, Shared, SubmitReply},
};

mod default_config;
#[path = "../src/server/store/postgres/tests/throwaway.rs"]
mod throwaway;

use default_config::config;

/// Turns for each side of a comparison.
const TURNS: u32 = 5;
/// Jobs at the same time when workers are compared.
const JOBS: u32 = 4;

/// The resolution of the default table: 3,780 entries.
const DEFAULT: [u32; 4] = [10, 6, 9, 7];
/// The resolution of a larger table: 20,160 entries.
const LARGE: [u32; 4] = [16, 10, 14, 9];

fn recipe([alpha, ratio, theta, phi]: [u32; 4], seed: u32) -> String {
    format!(
        r#"{{"preset":"paper","resolution":{{"alpha":{alpha},"ratio":{ratio},"theta":{theta},"phi":{phi}}},"fit":{{"seed":{seed}}}}}"#
    )
}

fn submit(service: &Service, recipe: &str) -> JobId {
    match service.submit(recipe.as_bytes(), None).expect("a job") {
        SubmitReply::InFlight { job, .. } | SubmitReply::Ready { job, .. } => job.id,
    }
}

/// Waits until `is_there` returns true for the state of the job, and returns the job.
fn wait(service: &Service, id: JobId, is_there: fn(StateName) -> bool) -> Job {
    let mut followed = service.watch(id).expect("an answer").expect("a job");
    let runtime = tokio::runtime::Builder::new_current_thread().build().expect("a runtime");
    let there = runtime.block_on(followed.wait_for(|snapshot| is_there(snapshot.job.state.name())));
    there.expect("the last snapshot has the final state").job.clone()
}

/// Seconds from the submission of `recipes` until all of their tables are stored.
fn seconds(service: &Service, recipes: &[String]) -> f64 {
    let ids: Vec<JobId> = recipes.iter().map(|recipe| submit(service, recipe)).collect();
    let jobs: Vec<Job> = ids.into_iter().map(|id| wait(service, id, StateName::is_final)).collect();
    assert!(jobs.iter().all(|job| job.state.name() == StateName::Done));
    let began = jobs.iter().map(|job| job.created_at).min().expect("a job");
    let ended = jobs.iter().filter_map(|job| job.finished_at).max().expect("an end");
    ended.duration_since(began).as_secs_f64()
}

/// Recipes for `jobs` default tables. No other turn has the same recipes.
fn tables(turn: u32, jobs: u32) -> Vec<String> {
    (turn * jobs..(turn + 1) * jobs).map(|seed| recipe(DEFAULT, seed)).collect()
}

/// The recipe for a larger table. No other turn has the same recipe.
fn large_table(turn: u32) -> Vec<String> {
    vec![recipe(LARGE, turn)]
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// Prints the medians of both sides, and the median of the ratios of the turns.
fn compare(name: &str, unit: &str, pairs: &[[f64; 2]]) {
    let [one, other] = [0, 1].map(|side| median(pairs.iter().map(|pair| pair[side]).collect()));
    let ratio = median(pairs.iter().map(|pair| pair[1] / pair[0]).collect());
    println!("{name}: {one:.3} and {other:.3} {unit}, ratio {ratio:.3} (medians of {} turns)", pairs.len());
}

/// Whether the command line names this part, or names no part.
fn is_wanted(part: &str) -> bool {
    let mut parts = std::env::args().skip(1).filter(|argument| !argument.starts_with('-')).peekable();
    parts.peek().is_none() || parts.any(|wanted| wanted == part)
}

/// The services of this bench. Their files are in `folder`.
struct Bench {
    server: throwaway::Server,
    folder: tempfile::TempDir,
}

impl Bench {
    /// A shared service with an empty database and the folder of tables.
    fn shared(&self) -> Shared {
        let tables = self.folder.path().join("tables");
        std::fs::create_dir_all(&tables).expect("a folder");
        let blobs = format!("file://{}", tables.display());
        let database = self.server.empty_database().parse().expect("any text");
        Shared { database, store: blobs, connections: NonZeroUsize::new(16).expect("16") }
    }

    fn embedded(&self, name: &str, threads: usize) -> Arc<Service> {
        Service::open(config(&self.folder.path().join(name), threads)).expect("a service")
    }

    fn open(&self, shared: &Shared, name: &str, threads: usize, works: bool) -> Arc<Service> {
        let config = config(&self.folder.path().join(name), if works { threads } else { 0 });
        Service::open_shared(config, shared).expect("a service")
    }

    fn tables(&self) {
        let embedded = self.embedded("embedded", 2);
        let cluster = self.open(&self.shared(), "cluster", 2, true);
        for service in [&embedded, &cluster] {
            seconds(service, &tables(0, 1));
        }
        let pairs: Vec<_> =
            (1..=TURNS).map(|turn| [&embedded, &cluster].map(|service| seconds(service, &tables(turn, 1)))).collect();
        compare("a default table, embedded and shared", "s", &pairs);
        embedded.stop();
        cluster.stop();
    }

    fn large(&self) {
        let pairs: Vec<_> = (0..TURNS)
            .map(|turn| {
                [2, 1].map(|threads| {
                    let service = self.embedded("alone", threads);
                    let seconds = seconds(&service, &large_table(2 * turn + threads as u32));
                    service.stop();
                    seconds
                })
            })
            .collect();
        compare("a larger table, embedded, with two threads and with one", "s", &pairs);
    }

    fn workers(&self) {
        let shared = self.shared();
        let front = self.open(&shared, "front", 1, false);
        let one = self.open(&shared, "one", 1, true);
        let mut pairs = vec![];
        for turn in 0..TURNS {
            let alone = seconds(&front, &tables(2 * turn, JOBS));
            let two = self.open(&shared, "two", 1, true);
            let both = seconds(&front, &tables(2 * turn + 1, JOBS));
            two.stop();
            pairs.push([both, alone]);
        }
        one.stop();
        front.stop();
        compare(&format!("{JOBS} default tables with two workers and with one, one thread each"), "s", &pairs);
    }

    fn threads(&self) {
        let shared = self.shared();
        let front = self.open(&shared, "front", 1, false);
        let mut pairs = vec![];
        for turn in 0..TURNS {
            pairs.push([2, 1].map(|threads| {
                let service = self.open(&shared, "threads", threads, true);
                let seconds = seconds(&front, &tables(2 * turn + threads as u32, JOBS));
                service.stop();
                seconds
            }));
        }
        front.stop();
        compare(&format!("{JOBS} default tables with one worker, with two threads and with one"), "s", &pairs);
    }

    fn start(&self) {
        let shared = self.shared();
        let front = self.open(&shared, "front", 1, false);
        let mut times = vec![];
        for turn in 0..TURNS {
            let id = submit(&front, &recipe(DEFAULT, 1_000_000 + turn));
            let began = SystemTime::now().duration_since(UNIX_EPOCH).expect("a clock").as_secs_f64();
            let worker = self.open(&shared, "late", 2, true);
            let job = wait(&front, id, StateName::is_final);
            times.push(job.started_at.expect("a start").as_microsecond() as f64 / 1e3 - 1e3 * began);
            worker.stop();
        }
        front.stop();
        println!("from the start of a worker to its first lease: {:.0} ms (median of {TURNS})", median(times));
    }
}

/// A part of the bench, with its name on the command line.
type Part = (&'static str, fn(&Bench));

fn main() {
    let Some(server) = throwaway::Server::start("-c shared_buffers=128MB") else { return };
    let bench = Bench { server, folder: tempfile::tempdir().expect("a folder") };
    let parts: [Part; 5] = [
        ("tables", Bench::tables),
        ("large", Bench::large),
        ("workers", Bench::workers),
        ("threads", Bench::threads),
        ("start", Bench::start),
    ];
    for (name, run) in parts {
        if is_wanted(name) {
            run(&bench);
        }
    }
}
