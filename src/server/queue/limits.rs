//! Limits of a queue.

use std::{num::NonZeroU32, time::Duration};

/// Bounds of a queue.
#[derive(Debug, Clone, Copy)]
pub struct Limits {
    /// Jobs that may be queued or running at the same time.
    pub jobs: usize,
    /// How long a lease lasts unless it is renewed.
    pub lease_ttl: Duration,
    /// How often a task may fail before its job does.
    pub max_attempts: NonZeroU32,
    /// How long a job that has ended is remembered; `None` for ever.
    pub keep_ended: Option<Duration>,
    /// Jobs that have ended and are remembered; `None` for any number.
    pub most_ended: Option<usize>,
}

impl Limits {
    /// Jobs of one team that may be queued or running at the same time: the others find room. Jobs without a team may take
    /// all of it.
    pub(super) fn jobs_of(&self, team: &str) -> usize {
        if team.is_empty() { self.jobs } else { self.jobs.div_ceil(2) }
    }
}

/// Processes that may end while a task is leased before its job fails. Kills and power cuts are no fault of the task,
/// and even a bad day has fewer; a task that ends its process each time must not go on for ever.
pub(super) const MOST_DEATHS: u32 = 20;
/// After so many, a task is suspect: of all suspect tasks one is leased at a time, so that what ends the process does
/// not bring the limit closer for the others.
pub(super) const SUSPECT_DEATHS: u32 = 3;
