//! Limits of a queue.

use std::time::Duration;

use super::{Failure, FailureKind, TaskKind};

/// Bounds of a queue.
#[derive(Debug, Clone, Copy)]
pub struct Limits {
    /// Jobs that may be queued or running at the same time.
    pub jobs: usize,
    /// How long a lease lasts unless it is renewed.
    pub lease_ttl: Duration,
    /// How long a job that has ended is remembered; `None` for ever.
    pub keep_ended: Option<Duration>,
    /// Jobs that have ended and are remembered; `None` for any number.
    pub most_ended: Option<usize>,
}

/// A task that workers report as failed so often fails its job.
pub(super) const MOST_FAILURES: u32 = 5;

/// A task that is leased so often without a result fails its job. Kills and power cuts are no fault of the task, and even
/// a bad day has fewer.
pub(super) const MOST_LEASES: u32 = 25;

fn name(kind: TaskKind) -> String {
    match kind {
        TaskKind::Shard(number) => format!("shard {number}"),
        TaskKind::Assemble => "the assembly".to_owned(),
    }
}

/// The failure of a job whose task failed too often.
pub(super) fn failed_often(kind: TaskKind, times: u32, error: &str) -> Failure {
    let detail = format!("{} failed {times} times; the last error: {error}", name(kind));
    Failure { kind: FailureKind::Attempts, detail }
}

/// The failure of a job whose task was leased too often without a result.
pub(super) fn leased_often(kind: TaskKind, times: u32) -> Failure {
    let detail = format!("{} was leased {times} times and gave no result", name(kind));
    Failure { kind: FailureKind::Attempts, detail }
}
