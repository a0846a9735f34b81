//! Channels to the followers of jobs.

use std::{
    collections::HashMap,
    sync::{Mutex, MutexGuard, PoisonError},
};

use jiff::Timestamp;
use tokio::sync::watch;

use super::Expected;
use crate::queue::{Job, JobId};

/// The number that is added to the time of a final state to get its sequence number. It exceeds the number of snapshots
/// within a microsecond.
const FINAL_AFTER: u64 = 1000;

/// A job at one moment.
#[derive(Debug, Clone)]
pub struct JobSnapshot {
    /// The position in the history of the job. It grows with each change.
    pub sequence: u64,
    /// The job.
    pub job: Job,
    /// Expected seconds until the job ends. `None` until they can be estimated.
    pub seconds_left: Option<f64>,
    /// The forecast for the whole fit; `None` for a recipe of another fitter version.
    pub expected: Option<Expected>,
}

/// Channels to the followers of jobs.
///
/// Invariant: a job in a final state has no channel, so memory does not grow with the number of ended jobs.
#[derive(Debug, Default)]
pub(super) struct Hub(Mutex<Channels>);

#[derive(Debug, Default)]
pub(super) struct Channels {
    last_sequence: u64,
    pub(super) by_job: HashMap<JobId, watch::Sender<JobSnapshot>>,
}

impl Hub {
    pub(super) fn lock(&self) -> MutexGuard<'_, Channels> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Channels {
    /// Microseconds since 1970, or one more than the last number, so numbers also grow across restarts. The number of
    /// a final state depends only on the time when the job ended.
    pub(super) fn sequence(&mut self, job: &Job) -> u64 {
        let micros = |time: Timestamp| u64::try_from(time.as_microsecond()).unwrap_or(0);
        if let Some(finished_at) = job.finished_at {
            return micros(finished_at) + FINAL_AFTER;
        }
        self.last_sequence = micros(Timestamp::now()).max(self.last_sequence + 1);
        self.last_sequence
    }
}
