//! Durable jobs, shards and leases.
//!
//! Invariant: `queue` knows no HTTP and nothing of LTC: a recipe is a text, a shard's result is bytes, and a table is
//! its digest. A change is durable before it is acknowledged or seen by anyone; leases alone are not, for they end
//! with the process.

mod active;
mod job;
mod jobs;
mod lease;
#[cfg(test)]
mod model_test;
mod record;
mod resume;
mod step;
mod submit;
mod view;

pub use crate::files::job::{JobId, ParseJobIdError, StateName};
pub use job::{Failure, FailureKind, Job, JobState};
pub use jobs::{Clock, Limits, Queue, QueueError};
pub use lease::{Lease, LeaseError, Offer, Step, Work};
pub use step::StaleLease;
pub use submit::{NewJob, Submitted};
