//! Notifying the followers of jobs.

use std::{
    collections::HashMap,
    sync::{Mutex, MutexGuard, PoisonError},
};

use jiff::Timestamp;
use tokio::sync::watch;

use super::{Expected, Service, ServiceError, state::State};
use crate::queue::{Job, JobId, StateName};

/// Distance of a final state's sequence number from its time: more than a burst of snapshots within one microsecond.
const FINAL_AFTER: u64 = 1000;

/// A job at one moment. `sequence` grows with each change.
#[derive(Debug, Clone)]
pub struct JobSnapshot {
    /// Position in the history of the job.
    pub sequence: u64,
    /// The job.
    pub job: Job,
    /// Expected time to the end, once it can be estimated.
    pub seconds_left: Option<f64>,
    /// The forecast for the whole fit; `None` for a recipe of another fitter.
    pub expected: Option<Expected>,
}

/// Channels to the followers of jobs.
///
/// Invariant: a job in a final state has no channel, so memory does not grow with the number of ended jobs.
#[derive(Debug, Default)]
pub(super) struct Hub(Mutex<Channels>);

#[derive(Debug, Default)]
struct Channels {
    last_sequence: u64,
    by_job: HashMap<JobId, watch::Sender<JobSnapshot>>,
}

impl Hub {
    fn lock(&self) -> MutexGuard<'_, Channels> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Channels {
    /// Microseconds since 1970, or one more than the last number, so that numbers grow across restarts too. The number
    /// of a final state follows from the time when it was reached.
    fn sequence(&mut self, job: &Job) -> u64 {
        let micros = |time: Timestamp| u64::try_from(time.as_microsecond()).unwrap_or(0);
        if let Some(finished_at) = job.finished_at {
            return micros(finished_at) + FINAL_AFTER;
        }
        self.last_sequence = micros(Timestamp::now()).max(self.last_sequence + 1);
        self.last_sequence
    }
}

impl Service {
    /// Follows a job: the receiver always holds its latest snapshot. The receiver of an ended job gets no more.
    ///
    /// # Errors
    /// When the store fails.
    pub fn watch(&self, id: JobId) -> Result<Option<watch::Receiver<JobSnapshot>>, ServiceError> {
        let Some(job) = self.state.queue.job(id)? else { return Ok(None) };
        let is_final = job.state.name().is_final();
        let snapshot = self.state.snapshot(job);
        if is_final {
            return Ok(Some(watch::channel(snapshot).1));
        }
        let mut hub = self.state.hub.lock();
        Ok(Some(hub.by_job.entry(id).or_insert_with(|| watch::channel(snapshot).0).subscribe()))
    }
}

impl State {
    /// A snapshot of a job.
    pub(super) fn snapshot(&self, job: Job) -> JobSnapshot {
        let expected = self.fitter.planned(job.recipe_digest, &job.recipe).ok();
        let expected = expected.map(|planned| self.forecast.of(&planned));
        let sequence = self.hub.lock().sequence(&job);
        JobSnapshot { sequence, seconds_left: seconds_left(&job), job, expected }
    }

    /// Sends a snapshot of every followed job that has changed to its followers.
    pub(super) fn publish(&self) {
        let followed: Vec<_> = {
            let mut hub = self.hub.lock();
            hub.by_job.retain(|_, channel| channel.receiver_count() > 0);
            hub.by_job.iter().map(|(id, channel)| (*id, channel.clone())).collect()
        };
        for (id, channel) in followed {
            let job = match self.queue.job(id) {
                Ok(Some(job)) => job,
                Ok(None) => {
                    self.hub.lock().by_job.remove(&id);
                    continue;
                }
                Err(error) => {
                    tracing::warn!(job = %id, %error, "the followers of the job were not notified");
                    continue;
                }
            };
            let is_final = job.state.name().is_final();
            if job != channel.borrow().job {
                channel.send_replace(self.snapshot(job));
            }
            if is_final {
                self.hub.lock().by_job.remove(&id);
            }
        }
    }
}

/// The time to the end of a running job at its pace so far.
fn seconds_left(job: &Job) -> Option<f64> {
    if job.state.name() != StateName::Running || job.entries_done == 0 {
        return None;
    }
    let seconds = Timestamp::now().duration_since(job.started_at?).as_secs_f64();
    (seconds > 0.0)
        .then(|| seconds / job.entries_done as f64 * job.entries_total.saturating_sub(job.entries_done) as f64)
}

#[cfg(test)]
impl State {
    /// Number of jobs with a channel.
    pub(super) fn hub_len(&self) -> usize {
        self.hub.lock().by_job.len()
    }
}
