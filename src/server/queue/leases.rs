//! Tasks under leases, and their outcomes.

use std::hash::{BuildHasher as _, RandomState};

use super::JobId;
use crate::store::StoreError;
use ltcforge_files::digest::Digest;

/// The right to deliver one task, under a name that is given once. A lease that has expired, one from before the job was
/// submitted again and one of a database that was restored since are not taken for the current one: numbers of
/// submissions come again.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Lease {
    pub(super) submission: u64,
    pub(super) task: u32,
    pub(super) name: u64,
}

/// A number that no other call gives, of this process or another. Names of leases are counted from there.
pub(super) fn unique_number() -> u64 {
    RandomState::new().hash_one(())
}

/// A transition that the task's state does not allow, because the lease is not the current one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the lease has expired or was taken back")]
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
#[derive(Debug, Clone, PartialEq)]
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
    /// Entries of all its shards.
    pub entries_total: u64,
}

/// Which tasks a worker asks for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Demand {
    /// Any task.
    Any,
    /// A task of a job that no worker works for, of the highest priority of all unfinished jobs, and of a team that has no
    /// more than its share of all leases.
    Unserved,
}

/// The answer to a worker that asks for tasks.
#[derive(Debug, Clone, PartialEq)]
pub enum Offer {
    /// At least one task, each under its own lease.
    Tasks(Vec<LeasedTask>),
    /// No task is available now: pass `seen` to [`super::Queue::wait`].
    Nothing {
        /// The generation of the queue that was seen.
        seen: u64,
    },
    /// The queue is closed.
    Closed,
}

/// Why a result was not accepted.
#[derive(Debug, thiserror::Error)]
pub enum LeaseError {
    /// The lease is not the current one.
    #[error(transparent)]
    Stale(#[from] StaleLease),
    /// It could not be stored; the lease is still held.
    #[error(transparent)]
    Store(#[from] StoreError),
}
