//! What bounds a queue.

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
}
