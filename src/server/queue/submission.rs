//! A submitted job, and the queue's answer.

use super::{Claim, Job, Submitter};
use crate::store::StoreError;
use ltcforge_files::digest::Digest;

/// A job to submit.
#[derive(Debug, Clone)]
pub struct NewJob {
    /// Canonical text of the recipe.
    pub recipe: String,
    /// Its digest; the job's id follows from it.
    pub recipe_digest: Digest,
    /// Entries of each shard. Equal recipes have equal shards.
    pub shard_entries: Vec<u32>,
    /// Who submits it; `None` where no token is needed.
    pub by: Option<Submitter>,
}

impl NewJob {
    /// Entries of all shards.
    #[must_use]
    pub fn entries(&self) -> u64 {
        self.shard_entries.iter().copied().map(u64::from).sum()
    }

    /// What it may have of the workers.
    #[must_use]
    pub(super) fn claim(&self) -> Claim {
        self.by.as_ref().map(|by| by.claim.clone()).unwrap_or_default()
    }

    /// The name of the token that it came with.
    #[must_use]
    pub(super) fn submitted_by(&self) -> Option<String> {
        self.by.as_ref().map(|by| by.name.clone())
    }
}

/// The queue's answer to a submission.
#[derive(Debug, Clone, PartialEq)]
pub enum Submitted {
    /// The job is queued now.
    Queued(Job),
    /// An equal job was queued or running already.
    Joined(Job),
    /// The job was done before, and its table is still stored.
    Done(Job, Digest),
}

/// Why a job was not accepted.
#[derive(Debug, thiserror::Error)]
pub enum QueueError {
    /// Too many jobs are queued or running.
    #[error("the queue is full: {limit} jobs are waiting or running")]
    Full {
        /// The limit.
        limit: usize,
        /// The team whose jobs they are, if it is the team's limit.
        team: Option<String>,
    },
    /// It could not be stored.
    #[error(transparent)]
    Store(#[from] StoreError),
}
