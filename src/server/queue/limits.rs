//! The limits of a queue.

use std::time::Duration;

use super::{Failure, FailureKind, TaskKind};

/// The limits of a queue.
#[derive(Debug, Clone, Copy)]
pub struct Limits {
    /// Maximum number of queued and running jobs.
    pub jobs: usize,
    /// How long a lease lasts unless it is renewed.
    pub lease_ttl: Duration,
    /// How long an ended job is remembered; `None` means forever.
    pub keep_ended: Option<Duration>,
    /// Maximum number of ended jobs that are remembered; `None` means no limit.
    pub most_ended: Option<usize>,
}

/// A job fails when workers have reported one of its tasks as failed this many times.
pub(super) const MOST_FAILURES: u32 = 5;

/// A job fails when one of its tasks was leased this many times without a result. The limit is high, because killed
/// processes and power cuts are not the task's fault.
pub(super) const MOST_LEASES: u32 = 25;

fn name(kind: TaskKind) -> String {
    match kind {
        TaskKind::Shard(number) => format!("shard {number}"),
        TaskKind::Assemble => "the assembly".to_owned(),
    }
}

/// The failure of a job after a task has failed too often.
pub(super) fn failed_often(kind: TaskKind, times: u32, error: &str) -> Failure {
    let detail = format!("{} failed {times} times; the last error: {error}", name(kind));
    Failure { kind: FailureKind::Attempts, detail }
}

/// The failure of a job after a task was leased too often without a result.
pub(super) fn leased_often(kind: TaskKind, times: u32) -> Failure {
    let detail = format!("{} was leased {times} times without a result", name(kind));
    Failure { kind: FailureKind::Attempts, detail }
}
