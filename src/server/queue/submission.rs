//! Submissions of jobs, and their results.

use serde::{Deserialize, Serialize};

use super::Job;
use crate::store::StoreError;
use ltcforge_files::digest::Digest;

/// A part of a job that one worker fits.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Shard {
    /// Number of entries.
    pub entries: u32,
    /// Predicted seconds on one core. They only determine the order of tasks.
    pub seconds: f64,
}

/// A job to submit.
#[derive(Debug, Clone)]
pub struct NewJob {
    /// The canonical text of the recipe.
    pub recipe: String,
    /// The digest of the recipe. It determines the id of the job.
    pub recipe_digest: Digest,
    /// The shards, in order.
    pub shards: Vec<Shard>,
    /// The version of the fitter.
    pub fitter: u32,
    /// The name of the submitting token; `None` if the service has no tokens.
    pub submitted_by: Option<String>,
}

impl NewJob {
    /// Number of entries of all shards.
    #[must_use]
    pub fn entries(&self) -> u64 {
        self.shards.iter().map(|shard| u64::from(shard.entries)).sum()
    }
}

/// The result of a submission.
#[derive(Debug, Clone, PartialEq)]
pub enum Submitted {
    /// The job was queued.
    Queued(Job),
    /// The same job is already queued or running.
    Joined(Job),
    /// The job is done, and its table is still stored.
    Done(Job, Digest),
}

/// Why a job was not accepted.
#[derive(Debug, thiserror::Error)]
pub enum QueueError {
    /// Too many jobs are queued or running.
    #[error("the queue is full: {0} jobs are waiting or running")]
    Full(usize),
    /// The job could not be stored.
    #[error(transparent)]
    Store(#[from] StoreError),
}
