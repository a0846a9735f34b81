//! Durable jobs, their shards, and leases on them.
//!
//! A job has a task for each shard and one that assembles the table. Workers lease tasks in one order: see [`order`].
//!
//! Invariant: `queue` knows neither HTTP nor LTC: a recipe is a text, a shard's result is bytes, and a table is its
//! digest. A change is durable before it is acknowledged or visible; leases may be lost.

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

/// A page of jobs, last submitted first, and the submission to pass as `before` to get the next one.
pub type JobPage = (Vec<Job>, Option<u64>);

/// Shards of unfinished jobs that are not finished. Assemblies do not count.
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
    /// Shards that wait and that are leased.
    pub depth: Depth,
    /// Predicted seconds of unfinished shards, on one core.
    pub core_seconds: f64,
    /// When the oldest unfinished job was created.
    pub oldest: Option<Timestamp>,
}

/// Durable jobs, which share the workers. All methods block.
pub trait Queue: Send + Sync + Debug {
    /// Submits a job; it is durable when this returns. A queued or running job is joined. A job that has failed or was
    /// cancelled, or whose table is missing according to `has_table`, is queued again. A failed job keeps its finished
    /// shards if its shards are the same.
    ///
    /// # Errors
    /// When the queue is full, or the job cannot be stored; then nothing has changed.
    fn submit(&self, new: NewJob, has_table: &dyn Fn(Digest) -> bool) -> Result<Submitted, QueueError>;

    /// Cancels a job, durably when this returns, and voids its leases. A job in a final state stays as it is. Returns the
    /// job as it is afterwards. `by` is the name of the token that cancels it.
    ///
    /// # Errors
    /// When it cannot be stored; then nothing has changed.
    fn cancel(&self, id: JobId, by: Option<&str>) -> Result<Option<Job>, StoreError>;

    /// Leases up to `most` tasks, first in the [order] first. Empty if no task waits or the queue is closed.
    ///
    /// # Errors
    /// When the database fails.
    fn lease(&self, most: NonZeroUsize) -> Result<Vec<LeasedTask>, StoreError>;

    /// Renews leases and records how many entries each has done. Puts expired leases of any worker back. Each lease has an
    /// answer, in order; a worker stops a task whose lease is stale.
    ///
    /// # Errors
    /// When the database fails.
    fn renew(&self, leases: &[(Lease, u64)]) -> Result<Vec<Result<(), StaleLease>>, StoreError>;

    /// Stores the results of shards; the accepted ones are durable when this returns. Each has an answer, in order.
    ///
    /// # Errors
    /// When they cannot be stored. Then none is accepted, and the leases are still held.
    fn complete(&self, done: &[(Lease, Vec<u8>)]) -> Result<Vec<Result<(), StaleLease>>, StoreError>;

    /// The results of all shards in order, for the worker that assembles. If some are lost or damaged, their shards wait
    /// again, the lease ends, and the answer is [`LeaseError::Lost`].
    ///
    /// # Errors
    /// When the lease is stale, results are lost, or the database fails.
    fn results(&self, lease: &Lease) -> Result<Vec<Vec<u8>>, LeaseError>;

    /// Ends a job whose table is stored, durably when this returns; `rows` are committed with it.
    ///
    /// # Errors
    /// When the lease is stale, or this cannot be stored; then the lease is still held.
    fn finish(&self, lease: &Lease, table: Digest, rows: Batch) -> Result<(), LeaseError>;

    /// Ends a lease without a result. If this ends the job, that is durable when this returns.
    ///
    /// # Errors
    /// When the lease is stale, or this cannot be stored; then it is stored later.
    fn release(&self, lease: &Lease, how: Release) -> Result<(), LeaseError>;

    /// A job by its id.
    ///
    /// # Errors
    /// When the database fails.
    fn job(&self, id: JobId) -> Result<Option<Job>, StoreError>;

    /// The job that made a table, if the queue still remembers it.
    ///
    /// # Errors
    /// When the database fails.
    fn job_of_table(&self, table: Digest) -> Result<Option<Job>, StoreError>;

    /// Up to `limit` jobs before the submission `before`, last submitted first; and the submission to pass as `before` to
    /// get the next ones. With `wanted`, only jobs in that state.
    ///
    /// # Errors
    /// When the database fails.
    fn list(&self, wanted: Option<StateName>, before: Option<u64>, limit: usize) -> Result<JobPage, StoreError>;

    /// The load.
    ///
    /// # Errors
    /// When the database fails.
    fn statistics(&self) -> Result<Statistics, StoreError>;

    /// Number of leases that expired, and of failures that workers reported, since this process has opened the queue.
    fn failures(&self) -> (u64, u64);

    /// Waits until a task may wait for a worker, or for at most the time `most`. Returns `false` once the queue is closed.
    fn wait(&self, most: Duration) -> bool;

    /// Leases no more tasks, and ends all calls of [`Self::wait`]. Tasks may still be completed or released.
    fn close(&self);
}
