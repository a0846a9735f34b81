//! Notifying the followers of jobs.

use std::{
    collections::HashMap,
    sync::{Arc, Mutex, MutexGuard, PoisonError},
};

use jiff::Timestamp;
use tokio::sync::watch;

use super::{JobSnapshot, forecast::Forecast};
use crate::server::{
    queue::{Job, JobId, StateName, embedded::Clock},
    store::StoreError,
};

/// How far a final state's sequence number is ahead of the time: more than a burst of snapshots within one microsecond
/// can be.
const FINAL_AFTER: u64 = 1000;

/// Channels to the followers of jobs, and the pace of running jobs.
///
/// Invariant: a job in a final state has neither, so that memory does not grow with the number of finished jobs.
pub(super) struct Hub {
    clock: Clock,
    forecast: Arc<Forecast>,
    inner: Mutex<Inner>,
}

#[derive(Default)]
struct Inner {
    last_sequence: u64,
    paces: HashMap<JobId, Pace>,
    channels: HashMap<JobId, watch::Sender<JobSnapshot>>,
}

/// How far a job was when this process began to work on it.
struct Pace {
    since: Timestamp,
    entries_done: u64,
}

impl Hub {
    pub(super) fn new(clock: Clock, forecast: Arc<Forecast>) -> Self {
        Self { clock, forecast, inner: Mutex::new(Inner::default()) }
    }

    /// A snapshot of `job`.
    pub(super) fn snapshot(&self, job: Job) -> JobSnapshot {
        let now = (self.clock)();
        self.lock().snapshot(job, &self.forecast, now)
    }

    /// The jobs that anyone follows.
    #[cfg(feature = "cluster")]
    pub(super) fn watched(&self) -> Vec<JobId> {
        let inner = self.lock();
        let followed = inner.channels.iter().filter(|(_, channel)| channel.receiver_count() > 0);
        followed.map(|(id, _)| *id).collect()
    }

    /// Whether anyone follows the job.
    pub(super) fn is_watched(&self, id: JobId) -> bool {
        self.lock().channels.contains_key(&id)
    }

    /// Notifies the followers of a job. `read` is called under the hub's lock, so that an older snapshot never follows
    /// a newer one.
    pub(super) fn publish(
        &self,
        id: JobId,
        read: impl FnOnce() -> Result<Option<Job>, StoreError>,
    ) -> Result<(), StoreError> {
        let mut inner = self.lock();
        // The time is read before the job, so that a job that ends in between has a later number.
        let now = (self.clock)();
        let Some(job) = read()? else { return Ok(()) };
        let is_final = job.state.name().is_final();
        let snapshot = inner.snapshot(job, &self.forecast, now);
        let followed = inner.channels.get(&id).is_some_and(|channel| channel.send(snapshot).is_ok());
        if is_final || !followed {
            inner.channels.remove(&id);
        }
        Ok(())
    }

    /// Follows a job. The receiver of a job in a final state holds that state and gets no more snapshots.
    pub(super) fn watch(
        &self,
        id: JobId,
        read: impl FnOnce() -> Result<Option<Job>, StoreError>,
    ) -> Result<Option<watch::Receiver<JobSnapshot>>, StoreError> {
        let mut inner = self.lock();
        let now = (self.clock)();
        let Some(job) = read()? else { return Ok(None) };
        let is_final = job.state.name().is_final();
        if let Some(channel) = inner.channels.get(&id).filter(|_| !is_final) {
            return Ok(Some(channel.subscribe()));
        }
        let snapshot = inner.snapshot(job, &self.forecast, now);
        let (sender, receiver) = watch::channel(snapshot);
        if !is_final {
            inner.channels.insert(id, sender);
        }
        Ok(Some(receiver))
    }

    fn lock(&self) -> MutexGuard<'_, Inner> {
        self.inner.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Inner {
    fn snapshot(&mut self, job: Job, forecast: &Forecast, now: Timestamp) -> JobSnapshot {
        let seconds_left = if job.state.name() == StateName::Running {
            let start = Pace { since: now, entries_done: job.entries_done };
            self.paces.entry(job.id).or_insert(start).seconds_left(&job, now)
        } else {
            self.paces.remove(&job.id);
            None
        };
        let expected = forecast.of(&job.recipe);
        JobSnapshot { sequence: self.sequence(&job, now), job, seconds_left, expected }
    }

    /// Microseconds since 1970, or one more than the last number, so that numbers grow across restarts too. The number
    /// of a final state follows from the time when it was reached, and is the same on each call.
    fn sequence(&mut self, job: &Job, now: Timestamp) -> u64 {
        let micros = |time: Timestamp| u64::try_from(time.as_microsecond()).unwrap_or(0);
        if let Some(finished_at) = job.finished_at {
            return micros(finished_at) + FINAL_AFTER;
        }
        self.last_sequence = micros(now).max(self.last_sequence + 1);
        self.last_sequence
    }
}

impl Pace {
    fn seconds_left(&self, job: &Job, now: Timestamp) -> Option<f64> {
        let done = job.entries_done.checked_sub(self.entries_done).filter(|done| *done > 0)?;
        let seconds = now.duration_since(self.since).as_secs_f64();
        (seconds > 0.0).then(|| seconds / done as f64 * job.entries_total.saturating_sub(job.entries_done) as f64)
    }
}
