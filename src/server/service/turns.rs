//! Turns: which of the threads that are in the middle of a task may work.
//!
//! A shard may take minutes and nothing of it would be left if it were given back, so a job that arrives meanwhile gets a
//! thread of its own. As many threads work at once as there are workers; they take turns, first come, first served.

use std::{
    collections::VecDeque,
    sync::{Condvar, Mutex, MutexGuard, PoisonError},
    time::{Duration, Instant},
};

use crate::server::queue::Offer;

/// How long a thread works before it lets another have its turn.
const SLICE: Duration = Duration::from_millis(100);

/// Who works and who waits.
#[derive(Debug)]
pub(super) struct Turns {
    state: Mutex<State>,
    changed: Condvar,
    /// Threads that work at once.
    at_once: usize,
    /// How often a thread that waits renews its lease.
    renewal: Duration,
}

#[derive(Debug, Default)]
struct State {
    /// Threads that have a task.
    busy: usize,
    /// Those of them that work.
    working: usize,
    /// Tickets of those that wait; the front one is next.
    waiting: VecDeque<u64>,
    tickets: u64,
    is_closed: bool,
}

/// The turns of a thread during one task.
#[derive(Debug)]
pub(super) struct Turn<'a> {
    turns: &'a Turns,
    /// Whether it works now.
    works: bool,
    since: Instant,
    waited: Duration,
}

impl Turns {
    pub(super) fn new(at_once: usize, renewal: Duration) -> Self {
        Self { state: Mutex::default(), changed: Condvar::new(), at_once, renewal }
    }

    /// Asks for a task: any while fewer threads have one than may work, else one of a job that no thread works for.
    pub(super) fn offer(&self, lease: impl FnOnce(bool) -> Offer) -> Offer {
        let mut state = self.lock();
        let offer = lease(state.busy < self.at_once);
        if matches!(offer, Offer::Task(_)) {
            state.busy += 1;
        }
        offer
    }

    /// Begins a task that was offered, as soon as a thread that works lets it. `renew` is called now and then until then.
    pub(super) fn begin(&self, renew: &mut dyn FnMut()) -> Turn<'_> {
        let mut turn = Turn { turns: self, works: false, since: Instant::now(), waited: Duration::ZERO };
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

    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl State {
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
            let waited = turns.changed.wait_timeout(state, turns.renewal);
            let (held, timeout) = waited.unwrap_or_else(PoisonError::into_inner);
            state = held;
            if timeout.timed_out() {
                drop(state);
                renew();
                state = turns.lock();
            }
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
        self.give();
        self.turns.lock().busy -= 1;
    }
}
