//! Which tasks are under way, and which come next.
//!
//! As many tasks are under way as there are workers. A shard may take minutes, so while all workers are in the middle
//! of long tasks, a job that no worker serves gets a thread beside them, and the operating system shares the cores.
//! While shards are short, several are leased at once, because a lease of a remote database takes milliseconds.

use std::{
    collections::{HashMap, VecDeque},
    num::NonZeroUsize,
    sync::{Condvar, Mutex, MutexGuard, PoisonError},
    time::{Duration, Instant},
};

use crate::queue::{Demand, Lease, LeasedTask, Offer, Queue};

/// How long the tasks that are leased at once take all workers, as predicted by the slowest recent task.
const AHEAD: Duration = Duration::from_millis(200);

/// Tasks leased at once, at most, where there are fewer workers.
const MOST_AHEAD: usize = 64;

/// A task that takes at least this is a long one. While all workers are busy, a thread looks this often whether they
/// are with long tasks, and for jobs without a worker: other processes submit jobs too.
const LONG: Duration = Duration::from_millis(500);

/// The tasks that this process has leased.
#[derive(Debug)]
pub(super) struct Scheduler {
    workers: usize,
    state: Mutex<State>,
    /// A task ended, or there may be a new one.
    changed: Condvar,
    /// Held by the thread that leases for all.
    leasing: Mutex<()>,
}

#[derive(Debug, Default)]
struct State {
    /// The tasks under way, and since when.
    running: HashMap<Lease, Instant>,
    /// Tasks that were leased and wait for a worker, and since when.
    ahead: VecDeque<(LeasedTask, Instant)>,
    /// How long the last task took.
    last: Option<Duration>,
    /// Leases whose results are being stored or were a moment ago, and the entries done.
    storing: HashMap<Lease, u64>,
    has_changed: bool,
}

impl Scheduler {
    pub(super) fn new(workers: NonZeroUsize) -> Self {
        let (state, changed, leasing) = Default::default();
        Self { workers: workers.get(), state, changed, leasing }
    }

    /// The next task for a thread, which calls [`Self::end`] after it; waits until there is one. `None` when the queue
    /// is closed.
    pub(super) fn next(&self, queue: &dyn Queue) -> Option<LeasedTask> {
        if let Some(task) = self.lock().begin_ahead(self.workers) {
            return Some(task);
        }
        let _leasing = self.leasing.lock().unwrap_or_else(PoisonError::into_inner);
        loop {
            let mut state = self.lock();
            if let Some(task) = state.begin_ahead(self.workers) {
                return Some(task);
            }
            state.has_changed = false;
            let Some((demand, most)) = state.demand(self.workers) else {
                self.wait(state);
                continue;
            };
            drop(state);
            match queue.lease(demand, most) {
                Offer::Tasks(tasks) => {
                    let mut state = self.lock();
                    state.ahead.extend(tasks.into_iter().map(|task| (task, Instant::now())));
                    if demand == Demand::Unserved
                        && let Some((task, _)) = state.ahead.pop_back()
                    {
                        return Some(state.begin(task));
                    }
                }
                Offer::Nothing { seen } if demand == Demand::Any => queue.wait(seen),
                Offer::Nothing { .. } => self.wait(self.lock()),
                Offer::Closed => return None,
            }
        }
    }

    /// Ends a task that was under way.
    pub(super) fn end(&self, lease: &Lease) {
        let mut state = self.lock();
        state.last = state.running.remove(lease).map(|since| since.elapsed());
        drop(state);
        self.wake();
    }

    /// Has a thread look for tasks again: there may be new ones.
    pub(super) fn wake(&self) {
        self.lock().has_changed = true;
        self.changed.notify_all();
    }

    /// The part of a core that each task under way has, if there are as many cores as workers.
    pub(super) fn share(&self) -> f64 {
        (self.workers as f64 / self.lock().running.len().max(1) as f64).min(1.0)
    }

    /// Takes out the tasks that have waited for a worker for at least `time`: the shards before them are longer than
    /// predicted.
    pub(super) fn overdue(&self, time: Duration) -> Vec<LeasedTask> {
        let mut state = self.lock();
        let overdue = state.ahead.iter().take_while(|(_, since)| since.elapsed() >= time).count();
        state.ahead.drain(..overdue).map(|(task, _)| task).collect()
    }

    /// Has a lease renewed while its result is being stored.
    pub(super) fn storing(&self, lease: Lease, entries_done: u64) {
        self.lock().storing.insert(lease, entries_done);
    }

    /// Has a lease renewed no more.
    pub(super) fn stored(&self, lease: &Lease) {
        self.lock().storing.remove(lease);
    }

    /// The leases to renew, and the entries done.
    pub(super) fn all_storing(&self) -> Vec<(Lease, u64)> {
        self.lock().storing.iter().map(|(lease, entries)| (*lease, *entries)).collect()
    }

    fn wait(&self, state: MutexGuard<'_, State>) {
        let waited = self.changed.wait_timeout_while(state, LONG, |state| !state.has_changed);
        drop(waited.unwrap_or_else(PoisonError::into_inner));
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl State {
    fn begin(&mut self, task: LeasedTask) -> LeasedTask {
        self.running.insert(task.lease, Instant::now());
        task
    }

    /// Begins the first task that waits for a worker, if one is free.
    fn begin_ahead(&mut self, workers: usize) -> Option<LeasedTask> {
        let (task, _) = (self.running.len() < workers).then(|| self.ahead.pop_front())??;
        Some(self.begin(task))
    }

    /// Which tasks to lease next, and how many; `None` if none.
    fn demand(&self, workers: usize) -> Option<(Demand, NonZeroUsize)> {
        let Some(free) = NonZeroUsize::new(workers.saturating_sub(self.running.len())) else {
            let long = self.running.values().filter(|since| since.elapsed() >= LONG).count();
            return (long >= workers).then_some((Demand::Unserved, NonZeroUsize::MIN));
        };
        let slowest = self.running.values().map(Instant::elapsed).chain(self.last).max();
        let rounds = slowest.map_or(0.0, |slowest| AHEAD.as_secs_f64() / slowest.as_secs_f64()) as usize;
        let ahead = NonZeroUsize::new(rounds.saturating_mul(workers).min(MOST_AHEAD));
        Some((Demand::Any, ahead.map_or(free, |ahead| ahead.max(free))))
    }
}

#[cfg(test)]
mod tests {
    use std::{num::NonZeroU32, sync::Arc};

    use super::*;
    use crate::{
        queue::{
            Limits, NewJob, TaskKind,
            embedded::{Clock, EmbeddedQueue},
        },
        store::memory::MemoryRows,
    };
    use ltcforge_files::digest::Digest;

    const TWO: NonZeroUsize = NonZeroUsize::MIN.saturating_add(1);

    /// A queue with a job for each name, of so many shards.
    fn queue(jobs: &[(&str, usize)]) -> EmbeddedQueue {
        let limits = Limits {
            jobs: 9,
            lease_ttl: Duration::from_secs(60),
            max_attempts: NonZeroU32::new(3).unwrap(),
            keep_ended: None,
            most_ended: None,
        };
        let queue = EmbeddedQueue::open(Arc::new(MemoryRows::default()), limits, Clock::system()).unwrap();
        for (name, shards) in jobs {
            let recipe_digest = Digest::of(name.as_bytes());
            let new = NewJob { recipe: (*name).to_owned(), recipe_digest, shard_entries: vec![1; *shards], by: None };
            queue.submit(new, &|_| false).unwrap();
        }
        queue
    }

    fn after(millis: u64) -> State {
        State { last: Some(Duration::from_millis(millis)), ..State::default() }
    }

    #[test]
    fn short_tasks_are_leased_ahead_and_long_ones_are_not() {
        let any = |most| Some((Demand::Any, NonZeroUsize::new(most).unwrap()));
        let leased_after = |millis, workers| after(millis).demand(workers);
        assert_eq!(State::default().demand(2), any(2), "nothing is known of the tasks");
        assert_eq!((leased_after(50, 2), leased_after(50, 3)), (any(8), any(12)));
        assert_eq!((leased_after(0, 2), leased_after(0, 100)), (any(MOST_AHEAD), any(100)));
        assert_eq!((leased_after(201, 1), leased_after(201, 5)), (any(1), any(5)));
        let (scheduler, queue) = (Scheduler::new(TWO), queue(&[("a", 9)]));
        scheduler.next(&queue).unwrap();
        scheduler.lock().last = Some(Duration::from_millis(50));
        scheduler.have_run(Duration::from_secs(1));
        assert_eq!(scheduler.lock().demand(2), any(1), "another one takes long");
    }

    impl Scheduler {
        /// Lets the tasks under way have begun that much earlier.
        fn have_run(&self, time: Duration) {
            self.lock().running.values_mut().for_each(|since| *since -= time);
        }
    }

    #[test]
    fn a_job_without_a_worker_is_begun_beside_long_tasks() {
        let (scheduler, queue) = (Scheduler::new(TWO), queue(&[("a", 9), ("b", 9), ("c", 9), ("d", 9)]));
        let mut begun: Vec<_> = (0..2).map(|_| scheduler.next(&queue).unwrap()).collect();
        assert_eq!(scheduler.lock().demand(2), None, "they may soon end");
        scheduler.have_run(LONG);
        begun.extend((2..4).map(|_| scheduler.next(&queue).unwrap()));
        let recipes: Vec<_> = begun.iter().map(|task| task.recipe.as_str()).collect();
        assert_eq!((recipes, scheduler.share()), (vec!["a", "b", "c", "d"], 0.5));
        // It waits until a job without a worker has a task again.
        std::thread::scope(|scope| {
            let next = scope.spawn(|| scheduler.next(&queue).unwrap());
            queue.complete(&[(begun[2].lease, b"result")]).unwrap();
            scheduler.end(&begun[2].lease);
            let next = next.join().unwrap();
            assert_eq!((next.recipe.as_str(), next.kind), ("c", TaskKind::Shard(1)));
        });
        for task in [&begun[0], &begun[1]] {
            scheduler.end(&task.lease);
        }
        assert_eq!(scheduler.share(), 1.0);
    }

    #[test]
    fn tasks_leased_ahead_begin_in_their_order_and_are_given_back_if_they_wait_too_long() {
        let (scheduler, queue) = (Scheduler::new(NonZeroUsize::MIN), queue(&[("a", 9)]));
        scheduler.lock().last = Some(Duration::from_millis(40));
        let first = scheduler.next(&queue).unwrap();
        assert_eq!(scheduler.overdue(Duration::from_secs(3600)), []);
        scheduler.end(&first.lease);
        let second = scheduler.next(&queue).unwrap();
        let waiting: Vec<_> = scheduler.overdue(Duration::ZERO).into_iter().map(|task| task.kind).collect();
        assert_eq!([first.kind, second.kind], [0, 1].map(TaskKind::Shard));
        assert_eq!(waiting, [2, 3, 4].map(TaskKind::Shard));
        assert_eq!(scheduler.overdue(Duration::ZERO), []);
    }

    #[test]
    fn all_threads_end_with_the_queue() {
        let (scheduler, queue) = (Scheduler::new(NonZeroUsize::MIN), queue(&[("a", 9)]));
        scheduler.next(&queue).unwrap();
        std::thread::scope(|scope| {
            let threads = [1, 2].map(|_| {
                scope.spawn({
                    let (scheduler, queue) = (&scheduler, &queue);
                    move || scheduler.next(queue)
                })
            });
            queue.close();
            scheduler.wake();
            assert!(threads.map(|thread| thread.join().unwrap()) == [None, None]);
        });
    }
}
