//! A job and its states.

use jiff::Timestamp;
use serde::{Deserialize, Serialize};

use ltcforge_files::{
    digest::Digest,
    job::{JobId, StateName},
};

/// Why a job failed, by a name that is stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FailureKind {
    /// No room on the disk; of jobs of earlier versions.
    DiskFull,
    /// Reading or writing failed for another reason.
    Storage,
    /// A task failed as often as is allowed.
    Attempts,
}

/// The last error of a failed job.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Failure {
    /// Its kind.
    pub kind: FailureKind,
    /// One sentence for a person to read.
    pub detail: String,
}

/// The state of a job.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(tag = "state", rename_all = "snake_case")]
pub enum JobState {
    /// No shard has been leased yet.
    Queued,
    /// Shards are being fitted.
    Running,
    /// The table is stored.
    Done {
        /// Its digest.
        table: Digest,
    },
    /// It failed.
    Failed {
        /// Why.
        error: Failure,
    },
    /// A user cancelled it.
    Cancelled,
}

/// A recipe on its way to a table.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Job {
    /// Derived from the recipe's digest.
    pub id: JobId,
    /// Canonical JSON of the recipe, opaque to the queue.
    pub recipe: String,
    /// Its digest.
    pub recipe_digest: Digest,
    /// Its state.
    #[serde(flatten)]
    pub state: JobState,
    /// Entries of all shards.
    pub entries_total: u64,
    /// Entries of finished shards plus those that leased ones have reported.
    pub entries_done: u64,
    /// The highest number of leases of a task.
    pub attempts: u32,
    /// When it was first submitted, or submitted again after it had failed or been cancelled.
    pub created_at: Timestamp,
    /// When its first shard was leased.
    pub started_at: Option<Timestamp>,
    /// When it reached a final state.
    pub finished_at: Option<Timestamp>,
    /// Who submitted it: the name of a token; `None` without tokens.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub submitted_by: Option<String>,
    /// Who cancelled it: the name of a token.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cancelled_by: Option<String>,
}

impl JobState {
    /// The state without its data.
    #[must_use]
    pub fn name(&self) -> StateName {
        match self {
            Self::Queued => StateName::Queued,
            Self::Running => StateName::Running,
            Self::Done { .. } => StateName::Done,
            Self::Failed { .. } => StateName::Failed,
            Self::Cancelled => StateName::Cancelled,
        }
    }
}
