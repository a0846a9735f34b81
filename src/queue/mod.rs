//! Durable jobs, shards and leases.
//!
//! Invariant: `queue` knows no HTTP and nothing of LTC.

mod job;

pub use job::{Failure, FailureKind, Job, JobId, JobState, ParseJobIdError, StateName};
