//! A job as a service describes it.

use serde::Deserialize;
use serde_json::Value;

use super::error::ProblemDocument;
use ltcforge_files::{
    digest::Digest,
    job::{JobId, StateName},
};

/// The progress of a job.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct JobProgress {
    /// Entries fitted.
    pub entries_done: u64,
    /// Entries of the table.
    pub entries_total: u64,
    /// The expected seconds until the job ends.
    pub seconds_left: Option<f64>,
}

/// The part of a job that the client reads. The client ignores fields that newer services add.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct JobStatus {
    /// The id of the job.
    pub id: JobId,
    /// The state of the job.
    pub state: StateName,
    /// The progress of the job.
    pub progress: JobProgress,
    /// The number of leases of the task that was leased most often.
    pub attempts: u32,
    /// The table of a job that is done.
    pub table: Option<Digest>,
    /// The reason that the job failed.
    #[serde(default, deserialize_with = "detail_of_problem")]
    pub error: Option<String>,
}

/// A job, and the document that describes it.
#[derive(Debug, Clone, PartialEq)]
pub struct JobDocument {
    /// The part that the client reads.
    pub status: JobStatus,
    /// The whole document.
    pub json: Value,
}

impl JobDocument {
    /// Reads the document of a job.
    ///
    /// # Errors
    /// When the document is not a job.
    pub fn parse(json: Value) -> Result<Self, serde_json::Error> {
        Ok(Self { status: JobStatus::deserialize(&json)?, json })
    }

    /// Whether the job is in a final state.
    #[must_use]
    pub fn is_final(&self) -> bool {
        !matches!(self.status.state, StateName::Queued | StateName::Running)
    }
}

fn detail_of_problem<'de, D: serde::Deserializer<'de>>(deserializer: D) -> Result<Option<String>, D::Error> {
    Ok(Option::<ProblemDocument>::deserialize(deserializer)?.map(|problem| problem.detail))
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// A job's document in `state`.
    pub(crate) fn document(state: &str) -> Value {
        serde_json::json!({
            "id": "5f70bf18a086007016e948b04aed3b82", "state": state, "recipe": {}, "attempts": 1, "table": null,
            "progress": { "entries_done": 1, "entries_total": 4, "seconds_left": null }, "error": null, "added": 1,
        })
    }

    #[test]
    fn a_job_is_read_with_its_error_and_new_fields_are_ignored() {
        let mut json = document("failed");
        json["error"] = serde_json::json!({ "type": "/problems/disk-full", "detail": "no room", "status": 507 });
        let job = JobDocument::parse(json.clone()).expect("a job");
        assert_eq!(job.status.error.as_deref(), Some("no room"));
        assert!(job.is_final());
        assert_eq!(job.json, json);
        assert!(!JobDocument::parse(document("running")).expect("a job").is_final());
    }

    #[test]
    fn a_document_that_is_not_a_job_is_an_error() {
        assert!(JobDocument::parse(document("asleep")).is_err());
        assert!(JobDocument::parse(Value::Null).is_err());
    }
}
