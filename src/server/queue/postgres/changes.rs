//! Changes that this process knows of, and the threads that wait for one.

use std::{
    collections::BTreeSet,
    sync::{Condvar, Mutex, MutexGuard, PoisonError},
    time::{Duration, Instant},
};

use crate::queue::JobId;

/// How long a worker waits for a notification before it asks anyway.
const POLL: Duration = Duration::from_secs(1);

/// Changes of the queue, by this process or by others as far as it was notified.
#[derive(Debug, Default)]
pub(super) struct Changes {
    known: Mutex<Known>,
    changed: Condvar,
}

#[derive(Debug, Default)]
struct Known {
    generation: u64,
    jobs: BTreeSet<JobId>,
    is_closed: bool,
}

impl Changes {
    fn known(&self) -> MutexGuard<'_, Known> {
        self.known.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Number of changes so far that may have made a task available; `None` once the queue is closed.
    pub(super) fn generation(&self) -> Option<u64> {
        let known = self.known();
        (!known.is_closed).then_some(known.generation)
    }

    /// Records that a job, or some job, may have changed.
    pub(super) fn note(&self, job: Option<JobId>) {
        let mut known = self.known();
        known.generation += 1;
        known.jobs.extend(job);
        self.changed.notify_all();
    }

    /// The jobs that have changed since the last call.
    pub(super) fn take_jobs(&self) -> BTreeSet<JobId> {
        std::mem::take(&mut self.known().jobs)
    }

    pub(super) fn close(&self) {
        self.known().is_closed = true;
        self.changed.notify_all();
    }

    /// Waits for a change since the generation `seen`, a second at most.
    pub(super) fn wait(&self, seen: u64) {
        self.wait_while(POLL, |known| known.generation == seen && !known.is_closed);
    }

    /// Waits for `time`, or until the queue is closed.
    pub(super) fn pause(&self, time: Duration) {
        self.wait_while(time, |known| !known.is_closed);
    }

    fn wait_while(&self, time: Duration, waits: impl FnMut(&mut Known) -> bool) {
        drop(self.changed.wait_timeout_while(self.known(), time, waits).unwrap_or_else(PoisonError::into_inner));
    }
}

/// Work that a process does periodically.
#[derive(Debug)]
pub(super) struct Periodic {
    every: Duration,
    last: Mutex<Option<Instant>>,
}

impl Periodic {
    pub(super) fn new(every: Duration) -> Self {
        Self { every, last: Mutex::new(None) }
    }

    /// Whether it is to be done now.
    pub(super) fn is_due(&self) -> bool {
        let mut last = self.last.lock().unwrap_or_else(PoisonError::into_inner);
        let is_due = last.is_none_or(|last| self.every <= last.elapsed());
        if is_due {
            *last = Some(Instant::now());
        }
        is_due
    }
}
