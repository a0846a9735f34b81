//! Leased tasks and their results.

use super::{Failure, JobId};
use crate::store::StoreError;
use ltcforge_files::digest::Digest;

/// The right to deliver the result of one task. The queue accepts a result only under the current `number` of the task.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Lease {
    pub(super) submission: u64,
    pub(super) task: u32,
    pub(super) number: u64,
}

/// The lease is no longer current.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the lease has expired, or the job has ended")]
pub struct StaleLease;

/// The kind of a task.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TaskKind {
    /// Fit this shard, then call [`super::Queue::complete`].
    Shard(u32),
    /// Assemble the table from the results of all shards, then call [`super::Queue::finish`].
    Assemble,
}

/// A leased task.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LeasedTask {
    /// The lease.
    pub lease: Lease,
    /// The kind of the task.
    pub kind: TaskKind,
    /// The job of the task.
    pub job: JobId,
    /// The job's recipe.
    pub recipe: String,
    /// The digest of the recipe.
    pub recipe_digest: Digest,
}

/// How a lease ends without a result.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Release {
    /// The worker stops. The lease does not count towards the limit of leases.
    GiveBack,
    /// The task failed. The queue leases it again until it has failed too many times.
    Failed(String),
    /// The whole job fails, because another attempt would not help.
    Abort(Failure),
}

/// Why a result was not accepted.
#[derive(Debug, thiserror::Error)]
pub enum LeaseError {
    /// The lease is no longer current.
    #[error(transparent)]
    Stale(#[from] StaleLease),
    /// Results of shards are lost or damaged. The lease has ended, and the queue leases the shards again.
    #[error("the results of {0} shards are lost or damaged; they are fitted again")]
    Lost(usize),
    /// The result could not be stored.
    #[error(transparent)]
    Store(#[from] StoreError),
}
