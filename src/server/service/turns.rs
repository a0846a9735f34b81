//! Turns: which of the threads that are in the middle of a task may work.
//!
//! A shard may take minutes and nothing of it would be left if it were given back, so a job that arrives meanwhile gets a
//! thread of its own. As many threads work at once as there are workers; they take turns, first come, first served.
//!
//! A thread that has ended a shard goes on with a task that was leased ahead, see [`super::places`], and leaves the result to
//! one that sleeps: its core would be idle otherwise until the system has found another thread for it.

use std::{
    collections::VecDeque,
    num::NonZeroUsize,
    sync::{Condvar, Mutex, MutexGuard, PoisonError},
    time::{Duration, Instant},
};

use super::places::{Place, Places};
use crate::queue::{Demand, JobId, LeasedTask, Offer};

/// Results that wait for a thread that stores them, at most, while tasks are begun.
const MOST_RESULTS: usize = 64;

/// How long a thread works before it lets another have its turn.
const SLICE: Duration = Duration::from_millis(100);

/// Who works and who waits.
#[derive(Debug)]
pub(super) struct Turns {
    state: Mutex<State>,
    /// A turn is free.
    changed: Condvar,
    /// One of the threads that ask has leased.
    leased: Condvar,
    /// Something is to be done by one of those that sleep.
    idle: Condvar,
    /// Threads that work at once.
    at_once: usize,
    /// How often a thread that waits renews its lease.
    renewal: Duration,
}

#[derive(Debug)]
struct State {
    /// The tasks that were leased.
    places: Places,
    /// Those that were leased ahead, by ticket of their place, and when their leases were renewed.
    ahead: VecDeque<(u64, Box<LeasedTask>, Instant)>,
    /// Threads that work.
    working: usize,
    /// Tickets of those that wait; the front one is next.
    waiting: VecDeque<u64>,
    tickets: u64,
    is_closed: bool,
    asking: Asking,
}

/// The threads that ask for a task. One of them leases for all. While there is none, one of them waits for the queue and the
/// others sleep: woken together, they would hold up each other and the threads that work.
#[derive(Debug, Default)]
struct Asking {
    threads: usize,
    /// Whether one of them is leasing now.
    is_leasing: bool,
    /// Whether one of them is waiting for the queue now.
    is_waiting: bool,
    /// How often one of them has begun to lease.
    rounds: u64,
    /// The last round that found nothing.
    nothing: u64,
    /// Tasks under way that no thread has taken yet.
    tasks: VecDeque<Box<LeasedTask>>,
    /// Results of shards that no thread has taken yet, and when their leases were renewed.
    results: VecDeque<(ShardResult, Instant)>,
    /// Whether the queue is closed.
    is_closed: bool,
}

/// What a thread is to do.
#[derive(Debug)]
pub(super) enum Asked {
    /// Begin a task.
    Task(Box<LeasedTask>),
    /// Store a result.
    Result(ShardResult),
}

/// The result of a shard, on its way to the queue.
#[derive(Debug)]
pub(super) struct ShardResult {
    pub(super) task: Box<LeasedTask>,
    pub(super) bytes: Vec<u8>,
}

/// The turns of a thread during one task.
#[derive(Debug)]
pub(super) struct Turn<'a> {
    turns: &'a Turns,
    job: JobId,
    /// Whether its task is under way.
    is_busy: bool,
    /// Whether it works now.
    works: bool,
    since: Instant,
    waited: Duration,
}

impl Turns {
    pub(super) fn new(at_once: usize, renewal: Duration) -> Self {
        Self {
            state: Mutex::new(State {
                places: Places::new(at_once),
                ahead: VecDeque::new(),
                working: 0,
                waiting: VecDeque::new(),
                tickets: 0,
                is_closed: false,
                asking: Asking::default(),
            }),
            changed: Condvar::new(),
            leased: Condvar::new(),
            idle: Condvar::new(),
            at_once,
            renewal,
        }
    }

    /// Asks for a task, to be passed to [`Self::begin`], or for a result to store. Of threads that ask at the same time, one
    /// calls `lease` for all, and while there is nothing, one calls `wait` with the generation of the queue that was seen.
    /// `None` when the queue is closed.
    pub(super) fn ask(&self, lease: impl Fn(Demand, NonZeroUsize) -> Offer, wait: impl Fn(u64)) -> Option<Asked> {
        let mut state = self.lock();
        let mut arrived = state.asking.rounds;
        state.asking.threads += 1;
        let asked = loop {
            if let Some(asked) = state.asking.next() {
                break Some(asked);
            }
            if state.asking.is_closed {
                break None;
            }
            if state.asking.is_leasing {
                state = self.leased.wait(state).unwrap_or_else(PoisonError::into_inner);
                continue;
            }
            // A round that began before this thread came may have missed what it was woken for.
            if state.asking.nothing > arrived && state.asking.is_waiting {
                state = self.idle.wait(state).unwrap_or_else(PoisonError::into_inner);
                arrived = state.asking.rounds;
                continue;
            }
            let (demand, most) = state.places.demand(state.asking.threads);
            state.asking.rounds += 1;
            state.asking.is_leasing = true;
            drop(state);
            let offer = lease(demand, most);
            state = self.lock();
            state.asking.is_leasing = false;
            self.leased.notify_all();
            match offer {
                Offer::Tasks(tasks) => {
                    for task in tasks {
                        match state.places.add(task.job) {
                            Place::UnderWay => state.asking.tasks.push_back(Box::new(task)),
                            Place::Ahead(ticket) => state.ahead.push_back((ticket, Box::new(task), Instant::now())),
                        }
                    }
                }
                Offer::Nothing { seen } => {
                    state.asking.nothing = state.asking.rounds;
                    if !state.asking.is_waiting {
                        state.asking.is_waiting = true;
                        drop(state);
                        wait(seen);
                        state = self.lock();
                        state.asking.is_waiting = false;
                        arrived = state.asking.rounds;
                    }
                }
                Offer::Closed => {
                    state.asking.is_closed = true;
                    // They are given back.
                    let ahead = std::mem::take(&mut state.ahead);
                    state.asking.tasks.extend(ahead.into_iter().map(|(_, task, _)| task));
                    self.idle.notify_all();
                }
            }
        };
        state.asking.threads -= 1;
        if !state.asking.is_waiting || !state.asking.is_empty() {
            // Somebody has to wait for the queue, or there is more to do.
            self.idle.notify_one();
        }
        asked
    }

    /// Renews the leases of tasks that wait for their place, and of results that wait for a thread, now and then.
    pub(super) fn renew_held(&self, mut renew: impl FnMut(&LeasedTask)) {
        let due = self.lock().due(self.renewal);
        for task in &due {
            renew(task);
        }
    }

    /// Begins a task that was leased, as soon as a thread that works lets it. `renew` is called now and then until then.
    pub(super) fn begin(&self, job: JobId, renew: &mut dyn FnMut()) -> Turn<'_> {
        let since = Instant::now();
        let mut turn = Turn { turns: self, job, is_busy: true, works: false, since, waited: Duration::ZERO };
        let mut state = self.lock();
        let ticket = state.ticket();
        state.waiting.push_front(ticket);
        turn.wait(state, ticket, renew);
        turn
    }

    /// Ends all waiting: who waits goes on without a turn, and has to stop.
    pub(super) fn close(&self) {
        self.lock().is_closed = true;
        self.changed.notify_all();
    }

    /// Waits for a change, but not so long that a lease ends meanwhile.
    fn wait_on<'a>(
        &'a self,
        changed: &Condvar,
        state: MutexGuard<'a, State>,
        renew: &mut dyn FnMut(),
    ) -> MutexGuard<'a, State> {
        let waited = changed.wait_timeout(state, self.renewal);
        let (held, timeout) = waited.unwrap_or_else(PoisonError::into_inner);
        if !timeout.timed_out() {
            return held;
        }
        drop(held);
        renew();
        self.lock()
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Asking {
    /// What there is to do.
    fn next(&mut self) -> Option<Asked> {
        if self.results.len() <= MOST_RESULTS
            && let Some(task) = self.tasks.pop_front()
        {
            return Some(Asked::Task(task));
        }
        self.results.pop_front().map(|(result, _)| Asked::Result(result))
    }

    fn is_empty(&self) -> bool {
        self.tasks.is_empty() && self.results.is_empty()
    }
}

impl State {
    /// The tasks whose leases nobody else renews and which were renewed longest ago; they count as renewed now.
    fn due(&mut self, renewal: Duration) -> Vec<LeasedTask> {
        let now = Instant::now();
        let ahead = self.ahead.iter_mut().map(|(_, task, renewed)| (&**task, renewed));
        let results = self.asking.results.iter_mut().map(|(result, renewed)| (&*result.task, renewed));
        let due = ahead.chain(results).filter(|(_, renewed)| renewal <= now.duration_since(**renewed));
        due.map(|(task, renewed)| {
            *renewed = now;
            task.clone()
        })
        .collect()
    }

    fn ticket(&mut self) -> u64 {
        self.tickets += 1;
        self.tickets
    }
}

impl<'a> Turn<'a> {
    /// Whether it has a turn: always, unless the service is stopping.
    pub(super) fn works(&self) -> bool {
        self.works
    }

    /// Time that the task was not worked on.
    pub(super) fn waited(&self) -> Duration {
        self.waited
    }

    /// In the middle of a task: lets a thread that waits work, after a while of one's own.
    pub(super) fn pass(&mut self, renew: &mut dyn FnMut()) {
        if !self.works || self.since.elapsed() < SLICE {
            return;
        }
        let turns = self.turns;
        let mut state = turns.lock();
        if state.waiting.is_empty() {
            self.since = Instant::now();
            return;
        }
        state.working -= 1;
        self.works = false;
        let ticket = state.ticket();
        state.waiting.push_back(ticket);
        turns.changed.notify_all();
        self.wait(state, ticket, renew);
    }

    /// Does what is worked on elsewhere without a turn of its own.
    pub(super) fn leave<T>(&mut self, work: impl FnOnce() -> T, renew: &mut dyn FnMut()) -> T {
        self.give();
        let done = work();
        let turns = self.turns;
        let mut state = turns.lock();
        let ticket = state.ticket();
        state.waiting.push_back(ticket);
        self.wait(state, ticket, renew);
        done
    }

    /// After the last work on a shard, which `took` so long. Another thread stores its result; the answer is the task to go on
    /// with, if there is one.
    pub(super) fn end(&mut self, took: Duration, result: ShardResult) -> Option<Box<LeasedTask>> {
        let next = self.leave_place(Some(took));
        let mut state = self.turns.lock();
        state.asking.results.push_back((result, Instant::now()));
        self.turns.idle.notify_one();
        if state.asking.results.len() <= MOST_RESULTS {
            return next;
        }
        // The disk or the database is behind: this thread stores one of them first.
        state.asking.tasks.extend(next);
        None
    }

    fn leave_place(&mut self, took: Option<Duration>) -> Option<Box<LeasedTask>> {
        self.give();
        if !std::mem::take(&mut self.is_busy) {
            return None;
        }
        let mut state = self.turns.lock();
        let ticket = state.places.end(self.job, took)?;
        let at = state.ahead.iter().position(|(of, ..)| *of == ticket)?;
        state.ahead.remove(at).map(|(_, task, _)| task)
    }

    fn give(&mut self) {
        if self.works {
            self.turns.lock().working -= 1;
            self.works = false;
            self.turns.changed.notify_all();
        }
    }

    /// Waits until the ticket is the next and fewer than all work, or the service is stopping.
    fn wait(&mut self, mut state: MutexGuard<'a, State>, ticket: u64, renew: &mut dyn FnMut()) {
        let (turns, begun) = (self.turns, Instant::now());
        let is_next = |state: &State| state.working < turns.at_once && state.waiting.front() == Some(&ticket);
        while !(state.is_closed || is_next(&state)) {
            state = turns.wait_on(&turns.changed, state, renew);
        }
        state.waiting.retain(|waiting| *waiting != ticket);
        self.works = !state.is_closed;
        state.working += usize::from(self.works);
        // The next one may have a turn as well.
        turns.changed.notify_all();
        self.since = Instant::now();
        self.waited += begun.elapsed();
    }
}

impl Drop for Turn<'_> {
    fn drop(&mut self) {
        if let Some(next) = self.leave_place(None) {
            self.turns.lock().asking.tasks.push_back(next);
        }
        self.turns.idle.notify_one();
    }
}

#[cfg(test)]
mod tests;
