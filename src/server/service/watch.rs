//! Follows jobs.

use jiff::Timestamp;
use tokio::sync::watch;

use super::{JobSnapshot, Service, ServiceError, state::State};
use crate::queue::{Job, JobId, StateName};

impl Service {
    /// Follows a job. The receiver always has the latest snapshot. It gets no more snapshots after the job has ended.
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

    /// Sends a snapshot of each changed job to its followers.
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
                    tracing::warn!(job = %id, %error, "could not notify the followers of the job");
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

/// Seconds until a running job ends, at its average speed so far.
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
    /// Number of jobs that have a channel.
    pub(super) fn hub_len(&self) -> usize {
        self.hub.lock().by_job.len()
    }
}
