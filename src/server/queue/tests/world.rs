//! The queues under test, with clocks that the tests set.

use std::{
    sync::{
        Arc,
        atomic::{AtomicI64, Ordering},
    },
    time::Duration,
};

use jiff::Timestamp;

use crate::{
    queue::{EmbeddedQueue, JobId, LeasedTask, Limits, NewJob, Queue, Shard, Submitted, embedded::Clock},
    store::{Batch, PowerRows, Rows as _, Tree},
};
use ltcforge_files::digest::Digest;

pub(super) const FITTER: u32 = 7;
const START: i64 = 1_700_000_000;

pub(super) const LIMITS: Limits =
    Limits { jobs: 1000, lease_ttl: Duration::from_secs(10), keep_ended: None, most_ended: None };

/// A separate queue for a test, empty at first.
pub(super) trait World: Sized {
    /// Number of random histories in every test run.
    const HISTORIES: u64;
    /// The divisor of `LTCFORGE_TEST_HISTORIES` for this world.
    const PART: u64;
    /// Whether leases survive a restart of the process.
    const LEASES_SURVIVE: bool;

    /// An empty queue. Prints a message and returns `None` if a dependency is missing.
    fn new(limits: Limits) -> Option<Self>;
    fn queue(&self) -> &dyn Queue;
    /// Advances the clocks by seconds.
    fn pass(&self, seconds: i64);
    /// Simulates a killed process: a new process opens the same data.
    fn restart(&mut self, limits: Limits);
    /// Makes the disk full, so that nothing can be written. Returns `false` if this kind of queue cannot simulate it.
    fn fill(&self, is_full: bool) -> bool;
    /// Number of stored results.
    fn results(&self) -> usize;
    /// Removes the result of a shard.
    fn lose(&self, job: JobId, shard: u32);
}

pub(super) struct EmbeddedWorld {
    rows: PowerRows,
    queue: EmbeddedQueue,
    seconds: Arc<AtomicI64>,
}

impl EmbeddedWorld {
    fn open(rows: &PowerRows, limits: Limits, seconds: &Arc<AtomicI64>) -> EmbeddedQueue {
        let (wall, steady) = (Arc::clone(seconds), Arc::clone(seconds));
        let clock = Clock {
            wall: Box::new(move || Timestamp::from_second(wall.load(Ordering::Relaxed)).unwrap()),
            steady: Box::new(move || Duration::from_secs(steady.load(Ordering::Relaxed).cast_unsigned())),
        };
        EmbeddedQueue::open_with(Arc::new(rows.clone()), limits, FITTER, clock).unwrap()
    }
}

impl World for EmbeddedWorld {
    const HISTORIES: u64 = 2000;
    const PART: u64 = 1;
    const LEASES_SURVIVE: bool = false;

    fn new(limits: Limits) -> Option<Self> {
        let (rows, seconds) = (PowerRows::default(), Arc::new(AtomicI64::new(START)));
        let queue = Self::open(&rows, limits, &seconds);
        Some(Self { rows, queue, seconds })
    }

    fn queue(&self) -> &dyn Queue {
        &self.queue
    }

    fn pass(&self, seconds: i64) {
        self.seconds.fetch_add(seconds, Ordering::Relaxed);
    }

    fn restart(&mut self, limits: Limits) {
        self.queue = Self::open(&self.rows, limits, &self.seconds);
    }

    fn fill(&self, is_full: bool) -> bool {
        self.rows.is_full.store(is_full, Ordering::Relaxed);
        true
    }

    fn results(&self) -> usize {
        self.rows.scan(Tree::Results, b"").unwrap().len()
    }

    fn lose(&self, job: JobId, shard: u32) {
        let mut batch = Batch::default();
        batch.remove(Tree::Results, [&job.as_bytes()[..], &shard.to_be_bytes()].concat());
        self.rows.commit(&batch).unwrap();
    }
}

/// The queue in PostgreSQL. Each thread has its own database.
#[cfg(feature = "cluster")]
pub(super) struct PostgresWorld {
    database: Arc<crate::store::Database>,
    /// The queues of two processes, which are used alternately.
    queues: [crate::queue::PostgresQueue; 2],
    turn: std::sync::atomic::AtomicUsize,
}

#[cfg(feature = "cluster")]
thread_local! {
    static DATABASE: std::cell::OnceCell<Option<Arc<crate::store::Database>>> = const { std::cell::OnceCell::new() };
}

#[cfg(feature = "cluster")]
impl PostgresWorld {
    fn execute(&self, statements: &str) {
        self.database.run(async |client| Ok(client.batch_execute(statements).await?)).unwrap();
    }
}

#[cfg(feature = "cluster")]
impl World for PostgresWorld {
    const HISTORIES: u64 = 12;
    const PART: u64 = 10;
    const LEASES_SURVIVE: bool = true;

    fn new(limits: Limits) -> Option<Self> {
        let database = DATABASE.with(|database| database.get_or_init(crate::store::test_database::database).clone())?;
        let queues = [(); 2].map(|()| crate::queue::PostgresQueue::new(Arc::clone(&database), limits, FITTER));
        let world = Self { database, queues, turn: 0.into() };
        world.execute(&format!(
            "CREATE TABLE IF NOT EXISTS test_clock (seconds bigint NOT NULL);
            TRUNCATE test_clock, ltcforge.jobs, ltcforge.tasks, ltcforge.rows;
            INSERT INTO test_clock VALUES ({START});
            CREATE OR REPLACE FUNCTION ltcforge.clock() RETURNS timestamptz LANGUAGE sql STABLE
                AS 'SELECT to_timestamp(seconds) FROM public.test_clock'"
        ));
        Some(world)
    }

    fn queue(&self) -> &dyn Queue {
        &self.queues[self.turn.fetch_add(1, Ordering::Relaxed) % 2]
    }

    fn pass(&self, seconds: i64) {
        self.execute(&format!("UPDATE test_clock SET seconds = seconds + {seconds}"));
    }

    fn restart(&mut self, limits: Limits) {
        self.queues[0] = crate::queue::PostgresQueue::new(Arc::clone(&self.database), limits, FITTER);
    }

    fn fill(&self, _is_full: bool) -> bool {
        false
    }

    fn results(&self) -> usize {
        let count = "SELECT count(*) FROM ltcforge.tasks WHERE result IS NOT NULL";
        let count = self.database.run(async |client| Ok(client.query_one(count, &[]).await?.get::<_, i64>(0)));
        usize::try_from(count.unwrap()).unwrap()
    }

    fn lose(&self, _job: JobId, shard: u32) {
        self.execute(&format!("UPDATE ltcforge.tasks SET result = 'x' WHERE task = {shard} AND state = 'finished'"));
    }
}

/// A job with `shards` shards of two entries. Each shard takes `seconds`.
pub(super) fn new_job(name: &str, shards: usize, seconds: f64) -> NewJob {
    NewJob {
        recipe: name.to_owned(),
        recipe_digest: Digest::of(name.as_bytes()),
        shards: vec![Shard { entries: 2, seconds }; shards],
        fitter: FITTER,
        submitted_by: Some("alice".to_owned()),
    }
}

/// Submits a new job, or an ended job again.
#[track_caller]
pub(super) fn submit(queue: &dyn Queue, new: NewJob) -> JobId {
    match queue.submit(new, &|_| false) {
        Ok(Submitted::Queued(job)) => job.id,
        other => panic!("{other:?}"),
    }
}

/// Leases up to `most` tasks.
#[track_caller]
pub(super) fn lease(queue: &dyn Queue, most: usize) -> Vec<LeasedTask> {
    queue.lease(most.try_into().unwrap()).unwrap()
}

/// Stores the results of shards.
#[track_caller]
pub(super) fn complete(queue: &dyn Queue, tasks: &[LeasedTask]) {
    let done: Vec<_> = tasks.iter().map(|task| (task.lease, result(task).into_bytes())).collect();
    assert!(queue.complete(&done).unwrap().iter().all(Result::is_ok));
}

/// The result of a shard.
pub(super) fn result(task: &LeasedTask) -> String {
    format!("{}/{:?}", task.recipe, task.kind)
}
