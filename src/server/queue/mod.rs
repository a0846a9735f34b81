//! Durable jobs, shards and leases.
//!
//! A job has a task for each shard and one that assembles the table. Workers lease tasks, oldest job first.
//!
//! Invariant: `queue` knows neither HTTP nor LTC: a recipe is a text, a shard's result is bytes, and a table is its
//! digest. A change is durable before it is acknowledged or visible. Leases are not durable; they end with the process.

mod active;
mod forget;
mod job;
mod jobs;
mod lease;
mod lookup;
#[cfg(test)]
mod model_test;
mod reconcile;
mod record;
mod resume;
mod submit;
mod task;

pub use crate::files::job::{JobId, ParseJobIdError, StateName};
pub use job::{Failure, FailureKind, Job, JobState};
pub use jobs::{Clock, Limits, Queue, QueueError};
pub use lease::{LeaseError, LeasedTask, Offer, TaskKind};
pub use reconcile::{ReconciledJobs, reconcile};
pub use submit::{NewJob, Submitted};
pub use task::{Lease, StaleLease};
