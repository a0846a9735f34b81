//! Durable jobs, their shards, and leases on them.
//!
//! A job has a task for each shard, and one task that assembles the table. [`order`] determines which task is leased
//! first.
//!
//! Invariant: `queue` knows neither HTTP nor LTC. It treats a recipe as text, the result of a shard as bytes, and a
//! table as a digest. A change is durable before it is acknowledged or visible. Only leases may be lost.

mod embedded;
mod job;
mod leases;
mod limits;
mod order;
#[cfg(feature = "cluster")]
mod postgres;
mod submission;
#[cfg(test)]
mod tests;

use std::{fmt::Debug, num::NonZeroUsize, time::Duration};

use jiff::Timestamp;

use crate::store::{Batch, StoreError};
pub use embedded::EmbeddedQueue;
pub use job::{Failure, FailureKind, Job, JobState};
pub use leases::{Lease, LeaseError, LeasedTask, Release, StaleLease, TaskKind};
pub use limits::Limits;
use limits::{MOST_FAILURES, MOST_LEASES, failed_often, leased_often};
use ltcforge_files::digest::Digest;
pub use ltcforge_files::job::{JobId, ParseJobIdError, StateName};
#[cfg(feature = "cluster")]
pub use postgres::PostgresQueue;
pub use submission::{NewJob, QueueError, Shard, Submitted};

/// A page of jobs, newest submission first, and the value of `before` for the next page.
pub type JobPage = (Vec<Job>, Option<u64>);

/// Numbers of unfinished shards of unfinished jobs. Assemblies are not counted.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Depth {
    /// Shards that wait for a worker.
    pub waiting: u64,
    /// Shards that are leased by a worker.
    pub leased: u64,
}

/// The load of a queue.
#[derive(Debug, Clone, PartialEq)]
pub struct Statistics {
    /// Number of jobs in each state.
    pub jobs: Vec<(StateName, u64)>,
    /// Waiting and leased shards.
    pub depth: Depth,
    /// Predicted seconds to fit the unfinished shards on one core.
    pub core_seconds: f64,
    /// When the oldest unfinished job was created.
    pub oldest: Option<Timestamp>,
}

/// A queue of durable jobs. All methods block.
pub trait Queue: Send + Sync + Debug {
    /// Submits a job. It is durable when this returns. If the same job is queued or running, this returns that job. If
    /// the job has failed or was cancelled, or if its table is missing according to `has_table`, it is queued again. A
    /// failed job keeps its finished shards if it is split into the same shards again.
    ///
    /// # Errors
    /// When the queue is full, or the job cannot be stored. After an error nothing has changed.
    fn submit(&self, new: NewJob, has_table: &dyn Fn(Digest) -> bool) -> Result<Submitted, QueueError>;

    /// Cancels a job and ends its leases. The change is durable when this returns. A job in a final state does not
    /// change. Returns the job after the change. `by` is the name of the token that cancels the job.
    ///
    /// # Errors
    /// When the change cannot be stored. After an error nothing has changed.
    fn cancel(&self, id: JobId, by: Option<&str>) -> Result<Option<Job>, StoreError>;

    /// Leases up to `most` tasks, sorted by [`order`]. The list is empty if no task waits or the queue is closed.
    ///
    /// # Errors
    /// When the database fails.
    fn lease(&self, most: NonZeroUsize) -> Result<Vec<LeasedTask>, StoreError>;

    /// Renews leases, and records how many entries of each task are finished. Then ends the expired leases of all
    /// workers. Nothing else ends them, so a process that was suspended renews its own leases first. Returns a result
    /// per lease, in order. A worker must stop a task when its lease is stale.
    ///
    /// # Errors
    /// When the database fails.
    fn renew(&self, leases: &[(Lease, u64)]) -> Result<Vec<Result<(), StaleLease>>, StoreError>;

    /// Stores results of shards. Accepted results are durable when this returns. Returns a result per lease, in order.
    ///
    /// # Errors
    /// When the results cannot be stored. Then no result is accepted, and the leases stay valid.
    fn complete(&self, done: &[(Lease, Vec<u8>)]) -> Result<Vec<Result<(), StaleLease>>, StoreError>;

    /// The results of all shards in order, for the assembly. If results are lost or damaged, the lease ends, their
    /// shards are queued again, and this returns [`LeaseError::Lost`].
    ///
    /// # Errors
    /// When the lease is stale, results are lost, or the database fails.
    fn results(&self, lease: &Lease) -> Result<Vec<Vec<u8>>, LeaseError>;

    /// Ends a job after its table was stored. `rows` are committed in the same transaction. The change is durable when
    /// this returns.
    ///
    /// # Errors
    /// When the lease is stale, or the change cannot be stored. If it cannot be stored, the lease stays valid.
    fn finish(&self, lease: &Lease, table: Digest, rows: Batch) -> Result<(), LeaseError>;

    /// Ends a lease without a result. If this also ends the job, the end is durable when this returns.
    ///
    /// # Errors
    /// When the lease is stale, or the change cannot be stored. If it cannot be stored, the queue stores it later.
    fn release(&self, lease: &Lease, how: Release) -> Result<(), LeaseError>;

    /// A job by its id.
    ///
    /// # Errors
    /// When the database fails.
    fn job(&self, id: JobId) -> Result<Option<Job>, StoreError>;

    /// The job that made a table, unless the queue has removed the job.
    ///
    /// # Errors
    /// When the database fails.
    fn job_of_table(&self, table: Digest) -> Result<Option<Job>, StoreError>;

    /// Up to `limit` jobs before submission `before`, newest first, and the value of `before` for the next page. If
    /// `wanted` is given, lists only jobs in that state.
    ///
    /// # Errors
    /// When the database fails.
    fn list(&self, wanted: Option<StateName>, before: Option<u64>, limit: usize) -> Result<JobPage, StoreError>;

    /// The load of the queue.
    ///
    /// # Errors
    /// When the database fails.
    fn statistics(&self) -> Result<Statistics, StoreError>;

    /// Number of expired leases, and of failures that workers reported, since this process opened the queue.
    fn failures(&self) -> (u64, u64);

    /// Waits for a task, but at most for `most`. May return early. Returns `false` once the queue is closed.
    fn wait(&self, most: Duration) -> bool;

    /// Stops leasing tasks, and ends all calls of [`Self::wait`]. Leased tasks may still be completed or released.
    fn close(&self);
}
