//! Durable jobs, their shards, and leases on them.
//!
//! A job has a task for each shard, and one task that assembles the table. [`order`] determines which
//! task is leased first.
//!
//! Invariant: `queue` knows neither HTTP nor LTC. A recipe is a text, the result of a shard is bytes, and a table is its
//! digest. A change is durable before it is acknowledged or visible. Leases may be lost.

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

/// Unfinished shards of unfinished jobs, without assemblies.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Depth {
    /// Shards that no worker has.
    pub waiting: u64,
    /// Shards that a worker has.
    pub leased: u64,
}

/// The load of a queue.
#[derive(Debug, Clone, PartialEq)]
pub struct Statistics {
    /// Number of jobs in each state.
    pub jobs: Vec<(StateName, u64)>,
    /// Waiting and leased shards.
    pub depth: Depth,
    /// Predicted seconds of unfinished shards, on one core.
    pub core_seconds: f64,
    /// When the oldest unfinished job was created.
    pub oldest: Option<Timestamp>,
}

/// A queue of durable jobs. All methods block.
pub trait Queue: Send + Sync + Debug {
    /// Submits a job; it is durable when this returns. A queued or running job is joined. A job that has failed or was
    /// cancelled, or whose table is missing according to `has_table`, is queued again. A failed job keeps its finished
    /// shards if its shards are the same.
    ///
    /// # Errors
    /// When the queue is full, or the job cannot be stored; then nothing has changed.
    fn submit(&self, new: NewJob, has_table: &dyn Fn(Digest) -> bool) -> Result<Submitted, QueueError>;

    /// Cancels a job, durably when this returns, and voids its leases. A job in a final state stays as it is. Returns
    /// the job as it is afterwards. `by` is the name of the token that cancels it.
    ///
    /// # Errors
    /// When it cannot be stored; then nothing has changed.
    fn cancel(&self, id: JobId, by: Option<&str>) -> Result<Option<Job>, StoreError>;

    /// Leases up to `most` tasks, sorted by [`order`]. Empty if no task waits or the queue is closed.
    ///
    /// # Errors
    /// When the database fails.
    fn lease(&self, most: NonZeroUsize) -> Result<Vec<LeasedTask>, StoreError>;

    /// Renews leases, and records the number of finished entries of each. Expired leases of all workers end. Returns a
    /// result per lease, in order. A worker stops a task whose lease is stale.
    ///
    /// # Errors
    /// When the database fails.
    fn renew(&self, leases: &[(Lease, u64)]) -> Result<Vec<Result<(), StaleLease>>, StoreError>;

    /// Stores results of shards. Accepted results are durable when this returns. Returns a result per lease, in order.
    ///
    /// # Errors
    /// When they cannot be stored. Then no result is accepted, and the leases stay valid.
    fn complete(&self, done: &[(Lease, Vec<u8>)]) -> Result<Vec<Result<(), StaleLease>>, StoreError>;

    /// The results of all shards in order, for the assembly. If results are lost or damaged, their shards must be fitted
    /// again, the lease ends, and this returns [`LeaseError::Lost`].
    ///
    /// # Errors
    /// When the lease is stale, results are lost, or the database fails.
    fn results(&self, lease: &Lease) -> Result<Vec<Vec<u8>>, LeaseError>;

    /// Ends a job whose table is stored, durably when this returns. `rows` are committed in the same transaction.
    ///
    /// # Errors
    /// When the lease is stale, or the change cannot be stored. In the second case the lease stays valid.
    fn finish(&self, lease: &Lease, table: Digest, rows: Batch) -> Result<(), LeaseError>;

    /// Ends a lease without a result. If the job ends, its end is durable when this returns.
    ///
    /// # Errors
    /// When the lease is stale, or the change cannot be stored. In the second case it is stored later.
    fn release(&self, lease: &Lease, how: Release) -> Result<(), LeaseError>;

    /// A job by its id.
    ///
    /// # Errors
    /// When the database fails.
    fn job(&self, id: JobId) -> Result<Option<Job>, StoreError>;

    /// The job that made a table, unless the queue has forgotten it.
    ///
    /// # Errors
    /// When the database fails.
    fn job_of_table(&self, table: Digest) -> Result<Option<Job>, StoreError>;

    /// Up to `limit` jobs before submission `before`, newest first, and the value of `before` for the next page. With
    /// `wanted`, only jobs in this state.
    ///
    /// # Errors
    /// When the database fails.
    fn list(&self, wanted: Option<StateName>, before: Option<u64>, limit: usize) -> Result<JobPage, StoreError>;

    /// The load.
    ///
    /// # Errors
    /// When the database fails.
    fn statistics(&self) -> Result<Statistics, StoreError>;

    /// Number of expired leases, and of failures that workers reported, since this process opened the queue.
    fn failures(&self) -> (u64, u64);

    /// Waits until there may be a waiting task, but at most for `most`. Returns `false` once the queue is closed.
    fn wait(&self, most: Duration) -> bool;

    /// Leases no more tasks, and ends all calls of [`Self::wait`]. Tasks may still be completed or released.
    fn close(&self);
}
