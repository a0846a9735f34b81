//! A job and its states.

use jiff::Timestamp;
use serde::{Deserialize, Serialize};

use ltcforge_files::{
    digest::Digest,
    job::{JobId, StateName},
};

/// Why a job failed. The names are stored in the database.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FailureKind {
    /// The disk was full. Only jobs of earlier versions failed for this reason.
    DiskFull,
    /// Reading or writing failed.
    Storage,
    /// A task failed too many times.
    Attempts,
}

/// The last error of a failed job.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Failure {
    /// The kind of the failure.
    pub kind: FailureKind,
    /// A sentence for people to read.
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
        /// The digest of the table.
        table: Digest,
    },
    /// The job failed.
    Failed {
        /// The last error.
        error: Failure,
    },
    /// A user cancelled the job.
    Cancelled,
}

/// A job. It fits the table of a recipe.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Job {
    /// The id, which is derived from the recipe's digest.
    pub id: JobId,
    /// The canonical JSON of the recipe. The queue does not parse it.
    pub recipe: String,
    /// The digest of the recipe.
    pub recipe_digest: Digest,
    /// The state of the job.
    #[serde(flatten)]
    pub state: JobState,
    /// Number of entries of all shards.
    pub entries_total: u64,
    /// Number of entries of finished shards, plus the entries that workers have reported for leased shards.
    pub entries_done: u64,
    /// The number of leases of the task that was leased most often.
    pub attempts: u32,
    /// When the job was last queued, by its first submission or by a submission after it had ended.
    pub created_at: Timestamp,
    /// When the first shard of the job was leased.
    pub started_at: Option<Timestamp>,
    /// When the job reached a final state.
    pub finished_at: Option<Timestamp>,
    /// The name of the token that submitted the job; `None` if the service has no tokens.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub submitted_by: Option<String>,
    /// The name of the token that cancelled the job.
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
