//! What is left to do, for `/metrics`: an autoscaler goes by it.

use super::{Backlog, state::ServiceState};
use crate::{
    queue::{Job, StateName},
    store::StoreError,
};

/// Unfinished jobs of each state that are looked at, last submitted first. Few services allow as many.
const MOST_JOBS: usize = 1000;

impl ServiceState {
    /// What the queue has to do. Jobs of another version's fitter count as shards and not in seconds.
    pub(super) fn backlog(&self) -> Result<Backlog, StoreError> {
        let mut jobs = Vec::new();
        for state in [StateName::Queued, StateName::Running] {
            jobs.extend(self.queue.list(Some(state), None, MOST_JOBS)?.0);
        }
        let now = self.queue.now();
        let age = |job: &Job| now.duration_since(job.created_at).as_secs_f64().max(0.0);
        let seconds = |job: &Job| {
            let left = job.entries_total.saturating_sub(job.entries_done) as f64 / job.entries_total.max(1) as f64;
            self.forecast.on_one_core(job.into()).map_or(0.0, |whole| whole.seconds * left)
        };
        Ok(Backlog {
            shards: self.queue.depth()?,
            // Unlike `sum`, which is -0 of nothing.
            core_seconds: jobs.iter().map(seconds).fold(0.0, |sum, seconds| sum + seconds),
            oldest_seconds: jobs.iter().map(age).fold(0.0, f64::max),
        })
    }
}
