//! Queues with a clock that a test sets.

use std::{
    sync::{
        Arc,
        atomic::{AtomicI64, Ordering},
        mpsc,
    },
    thread,
    time::Duration,
};

use jiff::Timestamp;

use super::actions::Fault;
use crate::{
    queue::postgres::PostgresQueue,
    store::{Database, test_database},
};
use crate::{
    queue::{
        Demand, JobId, Lease, LeaseError, LeasedTask, Limits, NewJob, Offer, Queue, StaleLease, Submitted,
        embedded::{Clock, EmbeddedQueue},
    },
    store::{
        StoreError, Tree,
        memory::{Meanwhile, MemoryRows},
    },
};
use ltcforge_files::digest::Digest;

/// Lets a result get to the disk, and returns the queue's answer.
pub(super) type Arrive = Box<dyn FnOnce() -> Result<Result<(), StaleLease>, StoreError>>;

/// A queue of its own, empty at first.
pub(super) trait World: Sized {
    /// Random histories that the model is compared with in every run of the tests.
    const HISTORIES: u64;
    /// The part of `LTCFORGE_TEST_HISTORIES` that is for this world.
    const PART: u64;
    /// Whether leases outlive the process.
    const LEASES_SURVIVE: bool;

    /// An empty queue; `None`, told loudly, where a part is missing.
    fn new(limits: Limits) -> Option<Self>;

    fn queue(&self) -> &dyn Queue;

    /// Hands over the result of a shard, which is on its way to the disk until the test lets it arrive; `None` if what
    /// a queue does meanwhile is another's business.
    fn hand_over(&self, lease: Lease, result: String) -> Option<Arrive>;

    /// Lets time pass.
    fn pass(&mut self, time: Duration);

    /// Loses everything written but not flushed; [`Self::reopen`] follows.
    fn lose_power(&mut self);

    /// The process ends without warning, and another one opens its data.
    fn reopen(&mut self, limits: Limits);

    /// While there is a fault, nothing can be written, as far as this can be had.
    fn set_fault(&self, fault: Option<Fault>);

    /// The next of the processes that share the queue acts from here on.
    fn turn(&mut self) {}

    /// Number of stored results.
    fn results(&self) -> usize;
}

/// The embedded queue on rows in memory.
pub(super) struct EmbeddedWorld {
    rows: Arc<MemoryRows>,
    queue: Arc<EmbeddedQueue>,
    seconds: Arc<AtomicI64>,
}

impl Clock {
    /// Both at the seconds that a test sets.
    pub(in crate::queue) fn at(seconds: &Arc<AtomicI64>) -> Self {
        let (wall, steady) = (Arc::clone(seconds), Arc::clone(seconds));
        Self {
            wall: Arc::new(move || Timestamp::from_second(wall.load(Ordering::Relaxed)).unwrap()),
            steady: Arc::new(move || Duration::from_secs(steady.load(Ordering::Relaxed).cast_unsigned())),
        }
    }
}

impl EmbeddedWorld {
    fn open(rows: &Arc<MemoryRows>, limits: Limits, seconds: &Arc<AtomicI64>) -> Arc<EmbeddedQueue> {
        Arc::new(EmbeddedQueue::open(rows.clone(), limits, Clock::at(seconds)).unwrap())
    }
}

impl World for EmbeddedWorld {
    const HISTORIES: u64 = 2000;
    const PART: u64 = 1;
    const LEASES_SURVIVE: bool = false;

    fn new(limits: Limits) -> Option<Self> {
        let (rows, seconds) = (Arc::new(MemoryRows::default()), Arc::new(AtomicI64::new(1_700_000_000)));
        let queue = Self::open(&rows, limits, &seconds);
        Some(Self { rows, queue, seconds })
    }

    fn queue(&self) -> &dyn Queue {
        &*self.queue
    }

    fn hand_over(&self, lease: Lease, result: String) -> Option<Arrive> {
        let ((on_its_way, looked), (arrive, arrives)) = (mpsc::channel(), mpsc::channel());
        let (queue, ended) = (Arc::clone(&self.queue), on_its_way.clone());
        *self.rows.while_settling.lock().unwrap() = Some(Meanwhile(Box::new(move || {
            on_its_way.send(()).unwrap();
            arrives.recv().ok();
        })));
        let delivering = thread::spawn(move || {
            let answers = queue.complete(&[(lease, result.as_bytes())]);
            ended.send(()).ok();
            answers.map(|answers| answers[0])
        });
        looked.recv().unwrap();
        // It is still there if the result was refused at once.
        self.rows.while_settling.lock().unwrap().take();
        Some(Box::new(move || {
            arrive.send(()).ok();
            delivering.join().unwrap()
        }))
    }

    fn pass(&mut self, time: Duration) {
        self.seconds.fetch_add(time.as_secs().cast_signed(), Ordering::Relaxed);
    }

    fn lose_power(&mut self) {
        self.rows = Arc::new(self.rows.after_power_cut());
    }

    fn reopen(&mut self, limits: Limits) {
        self.queue = Self::open(&self.rows, limits, &self.seconds);
    }

    fn set_fault(&self, fault: Option<Fault>) {
        self.rows.full.store(fault == Some(Fault::DiskFull), Ordering::Relaxed);
        self.rows.without_descriptors.store(fault == Some(Fault::NoDescriptors), Ordering::Relaxed);
    }

    fn results(&self) -> usize {
        self.rows.len(Tree::Results)
    }
}

/// Submits a job of `shards` shards that is not known yet.
#[track_caller]
pub(super) fn submit(queue: &dyn Queue, name: &str, shards: usize) -> JobId {
    let recipe_digest = Digest::of(name.as_bytes());
    let new = NewJob { recipe: name.to_owned(), recipe_digest, shard_entries: vec![1; shards], by: None };
    assert!(matches!(queue.submit(new, &|_| false), Ok(Submitted::Queued(_))));
    JobId::of_recipe(&recipe_digest)
}

/// Up to `most` tasks.
#[track_caller]
pub(super) fn tasks(queue: &dyn Queue, demand: Demand, most: usize) -> Vec<LeasedTask> {
    match queue.lease(demand, most.try_into().unwrap()) {
        Offer::Tasks(tasks) => tasks,
        Offer::Nothing { .. } => vec![],
        Offer::Closed => panic!("the queue is closed"),
    }
}

/// A task, which there must be.
#[track_caller]
pub(super) fn task(queue: &dyn Queue) -> LeasedTask {
    tasks(queue, Demand::Any, 1).pop().expect("a task")
}

/// The results that are handed to a worker that assembles; `None` if some are lost.
pub(in crate::queue) fn results(queue: &dyn Queue, lease: &Lease) -> Result<Option<Vec<Vec<u8>>>, LeaseError> {
    let mut results = Vec::new();
    let complete = queue.results(lease, &mut |result| results.push(result.to_vec()))?;
    Ok(complete.then_some(results))
}

/// Stores the result of a shard.
#[track_caller]
pub(super) fn complete(queue: &dyn Queue, task: &LeasedTask) {
    assert_eq!(queue.complete(&[(task.lease, b"result")]).unwrap(), [Ok(())]);
}

/// The queue in PostgreSQL, in a database of its own for each thread.
pub(super) struct PostgresWorld {
    database: Arc<Database>,
    /// Of two processes; the first acts.
    queues: [PostgresQueue; 2],
}

impl PostgresWorld {
    fn execute(&self, statements: &str) {
        let done = self.database.run(async |client| Ok(client.batch_execute(statements).await?));
        done.unwrap();
    }
}

thread_local! {
    static DATABASE: std::cell::OnceCell<Option<Arc<Database>>> = const { std::cell::OnceCell::new() };
}

impl World for PostgresWorld {
    const HISTORIES: u64 = 48;
    const PART: u64 = 10;
    const LEASES_SURVIVE: bool = true;

    fn new(limits: Limits) -> Option<Self> {
        let database = DATABASE.with(|database| database.get_or_init(test_database::database).clone())?;
        let queues = [(); 2].map(|()| PostgresQueue::open_eager(Arc::clone(&database), limits));
        let world = Self { database, queues };
        world.execute(
            "CREATE TABLE IF NOT EXISTS test_clock (seconds bigint NOT NULL);
            TRUNCATE test_clock, ltcforge.jobs, ltcforge.tasks, ltcforge.blocks, ltcforge.serving, ltcforge.finished_entries, ltcforge.rows;
            UPDATE ltcforge.teams SET turn = 0;
            INSERT INTO test_clock VALUES (1700000000);
            CREATE OR REPLACE FUNCTION ltcforge.clock() RETURNS timestamptz LANGUAGE sql STABLE
                AS 'SELECT to_timestamp(seconds) FROM public.test_clock'",
        );
        Some(world)
    }

    fn queue(&self) -> &dyn Queue {
        &self.queues[0]
    }

    fn turn(&mut self) {
        self.queues.swap(0, 1);
    }

    fn hand_over(&self, _lease: Lease, _result: String) -> Option<Arrive> {
        // One statement stores it.
        None
    }

    fn pass(&mut self, time: Duration) {
        self.execute(&format!("UPDATE test_clock SET seconds = seconds + {}", time.as_secs()));
    }

    fn lose_power(&mut self) {
        // The server's disk is not this process's.
    }

    fn reopen(&mut self, limits: Limits) {
        self.queues[0] = PostgresQueue::open_eager(Arc::clone(&self.database), limits);
    }

    fn set_fault(&self, _fault: Option<Fault>) {
        // The server's disk is not this process's.
    }

    fn results(&self) -> usize {
        let count = self.database.run(async |client| {
            Ok(client.query_one("SELECT count(*) FROM ltcforge.tasks WHERE result IS NOT NULL", &[]).await?)
        });
        usize::try_from(count.unwrap().get::<_, i64>(0)).unwrap()
    }
}
