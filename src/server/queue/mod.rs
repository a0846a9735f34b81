//! Durable jobs, shards and leases.
//!
//! A job has a task for each shard and one that assembles the table. Workers lease tasks, oldest job first.
//!
//! Invariant: `queue` knows neither HTTP nor LTC: a recipe is a text, a shard's result is bytes, and a table is its
//! digest. A change is durable before it is acknowledged or visible.

mod claim;
pub mod embedded;
mod job;
mod leases;
mod limits;
mod operations;
pub mod postgres;
mod submission;
#[cfg(test)]
mod tests;

use claim::TURN;
pub use claim::{Claim, Priority, Submitter};
pub use job::{Failure, FailureKind, Job, JobState};
use leases::unique_number;
pub use leases::{Demand, Lease, LeaseError, LeasedTask, Offer, StaleLease, TaskKind};
pub use limits::Limits;
use limits::{MOST_DEATHS, SUSPECT_DEATHS};
pub use ltcforge_files::job::{JobId, ParseJobIdError, StateName};
pub use operations::{Depth, JobPage, Queue};
pub use submission::{NewJob, QueueError, Submitted};
