//! Notifying the followers of jobs.

use std::{
    collections::HashMap,
    sync::{Arc, Mutex, MutexGuard, PoisonError},
    time::Instant,
};

use jiff::Timestamp;
use tokio::sync::watch;

use super::{JobSnapshot, forecast::Forecast};
use crate::{
    queue::{Job, JobId, StateName},
    store::StoreError,
};

/// How far the sequence number of a final state is ahead of its time: further than a burst of snapshots within one
/// microsecond.
const FINAL_AFTER: u64 = 1000;

/// Channels to the followers of jobs, and the pace of running jobs.
///
/// Invariant: a job in a final state has neither, so that memory does not grow with the number of finished jobs.
pub(super) struct Hub {
    forecast: Arc<Forecast>,
    inner: Mutex<Inner>,
    /// Locks by the first byte of a job's id. The lock is held while the job is read for its followers, so that an
    /// older snapshot never follows a newer one. A slow database holds up no other lock.
    reading: [Mutex<()>; 64],
}

#[derive(Default)]
struct Inner {
    last_sequence: u64,
    paces: HashMap<JobId, Pace>,
    channels: HashMap<JobId, watch::Sender<JobSnapshot>>,
}

/// How far a job was when this process began to work on it.
struct Pace {
    since: Instant,
    entries_done: u64,
}

impl Hub {
    pub(super) fn new(forecast: Arc<Forecast>) -> Self {
        Self { forecast, inner: Mutex::new(Inner::default()), reading: [const { Mutex::new(()) }; 64] }
    }

    /// A snapshot of `job`.
    pub(super) fn snapshot(&self, job: Job) -> JobSnapshot {
        self.lock().snapshot(job, &self.forecast, None)
    }

    /// The jobs that anyone follows.
    pub(super) fn watched(&self) -> Vec<JobId> {
        let inner = self.lock();
        let followed = inner.channels.iter().filter(|(_, channel)| channel.receiver_count() > 0);
        followed.map(|(id, _)| *id).collect()
    }

    /// Whether the job has a channel or a pace.
    pub(super) fn knows(&self, id: JobId) -> bool {
        let inner = self.lock();
        inner.channels.contains_key(&id) || inner.paces.contains_key(&id)
    }

    /// Whether anyone follows the job.
    pub(super) fn is_watched(&self, id: JobId) -> bool {
        self.lock().channels.contains_key(&id)
    }

    /// Notifies the followers of a job. `read` gives the job as it is, and the time by the clock that all processes
    /// share.
    pub(super) fn publish(
        &self,
        id: JobId,
        read: impl FnOnce() -> Result<Option<(Job, Timestamp)>, StoreError>,
    ) -> Result<(), StoreError> {
        let _reading = self.reading(id);
        let Some((job, now)) = read()? else { return Ok(()) };
        let is_final = job.state.name().is_final();
        let mut inner = self.lock();
        let snapshot = inner.snapshot(job, &self.forecast, Some(now));
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
        read: impl FnOnce() -> Result<Option<(Job, Timestamp)>, StoreError>,
    ) -> Result<Option<watch::Receiver<JobSnapshot>>, StoreError> {
        let _reading = self.reading(id);
        let Some((job, now)) = read()? else { return Ok(None) };
        let is_final = job.state.name().is_final();
        let mut inner = self.lock();
        if let Some(channel) = inner.channels.get(&id).filter(|_| !is_final) {
            return Ok(Some(channel.subscribe()));
        }
        let snapshot = inner.snapshot(job, &self.forecast, Some(now));
        let (sender, receiver) = watch::channel(snapshot);
        if !is_final {
            inner.channels.insert(id, sender);
        }
        Ok(Some(receiver))
    }

    fn reading(&self, id: JobId) -> MutexGuard<'_, ()> {
        let at = usize::from(id.as_bytes()[0]) % self.reading.len();
        self.reading[at].lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn lock(&self) -> MutexGuard<'_, Inner> {
        self.inner.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Inner {
    /// A snapshot; with a new number if it is of `now`.
    fn snapshot(&mut self, job: Job, forecast: &Forecast, now: Option<Timestamp>) -> JobSnapshot {
        let seconds_left = if job.state.name() == StateName::Running {
            let start = Pace { since: Instant::now(), entries_done: job.entries_done };
            self.paces.entry(job.id).or_insert(start).seconds_left(&job)
        } else {
            self.paces.remove(&job.id);
            None
        };
        let expected = forecast.of((&job).into());
        JobSnapshot { sequence: self.sequence(&job, now), job, seconds_left, expected }
    }

    /// Microseconds since 1970, or one more than the last number, so that numbers grow across restarts too. The number
    /// of a final state follows from the time when it was reached, and is the same on each call.
    fn sequence(&mut self, job: &Job, now: Option<Timestamp>) -> u64 {
        let micros = |time: Timestamp| u64::try_from(time.as_microsecond()).unwrap_or(0);
        if let Some(finished_at) = job.finished_at {
            return micros(finished_at) + FINAL_AFTER;
        }
        if let Some(now) = now {
            self.last_sequence = micros(now).max(self.last_sequence + 1);
        }
        self.last_sequence
    }
}

impl Pace {
    fn seconds_left(&self, job: &Job) -> Option<f64> {
        let done = job.entries_done.checked_sub(self.entries_done).filter(|done| *done > 0)?;
        let seconds = self.since.elapsed().as_secs_f64();
        (seconds > 0.0).then(|| seconds / done as f64 * job.entries_total.saturating_sub(job.entries_done) as f64)
    }
}
