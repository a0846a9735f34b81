//! Tasks under leases, and their outcomes.

use super::{Failure, JobId};
use crate::store::StoreError;
use ltcforge_files::digest::Digest;

/// The right to deliver one task. Its number is the fence: nothing is written under a lease that is not the current one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Lease {
    pub(super) submission: u64,
    pub(super) task: u32,
    pub(super) number: u64,
}

/// The lease is not the task's current one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the lease has expired, or the job has ended")]
pub struct StaleLease;

/// The work of a task.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TaskKind {
    /// Fit this shard, then [`super::Queue::complete`].
    Shard(u32),
    /// Assemble the table from all shards' results, then [`super::Queue::finish`].
    Assemble,
}

/// A task under a lease.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LeasedTask {
    /// The lease to deliver under.
    pub lease: Lease,
    /// The work.
    pub kind: TaskKind,
    /// The job it belongs to.
    pub job: JobId,
    /// The job's recipe.
    pub recipe: String,
    /// Its digest.
    pub recipe_digest: Digest,
}

/// How a lease ends without a result.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Release {
    /// The worker stops. The lease does not count.
    GiveBack,
    /// The task failed. It is tried again until it has failed too often.
    Failed(String),
    /// The whole job fails: another attempt would not help.
    Abort(Failure),
}

/// Why a result was not accepted.
#[derive(Debug, thiserror::Error)]
pub enum LeaseError {
    /// The lease is not the current one.
    #[error(transparent)]
    Stale(#[from] StaleLease),
    /// Results of shards are lost or damaged. The shards wait again, and the lease has ended.
    #[error("the results of {0} shards are lost or damaged; they are fitted again")]
    Lost(usize),
    /// It could not be stored.
    #[error(transparent)]
    Store(#[from] StoreError),
}
