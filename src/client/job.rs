//! A job as a service tells it.

use serde::Deserialize;
use serde_json::Value;

use super::error::ProblemDocument;
use crate::files::{
    digest::Digest,
    job::{JobId, StateName},
};

/// How far a job is.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct Progress {
    /// Entries fitted.
    pub entries_done: u64,
    /// Entries of the table.
    pub entries_total: u64,
    /// Expected time to the end.
    pub seconds_left: Option<f64>,
}

/// What the client reads of a job. Fields that a later service adds are passed over.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct JobStatus {
    /// The job.
    pub id: JobId,
    /// Where it stands.
    pub state: StateName,
    /// How far it is.
    pub progress: Progress,
    /// The highest attempt number among its shards.
    pub attempts: u32,
    /// The table of a job that is done.
    pub table: Option<Digest>,
    /// Why it failed.
    #[serde(default, deserialize_with = "detail_of_problem")]
    pub error: Option<String>,
}

/// A job, and the very document that said so.
#[derive(Debug, Clone, PartialEq)]
pub struct JobDocument {
    /// What the client reads of it.
    pub status: JobStatus,
    /// All of it.
    pub json: Value,
}

impl JobDocument {
    /// Reads a job's document.
    ///
    /// # Errors
    /// When it is not one.
    pub fn parse(json: Value) -> Result<Self, serde_json::Error> {
        Ok(Self { status: JobStatus::deserialize(&json)?, json })
    }

    /// Whether nothing will change any more.
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
    fn a_job_is_read_with_its_error_and_passes_over_what_is_new() {
        let mut json = document("failed");
        json["error"] = serde_json::json!({ "type": "/problems/disk-full", "detail": "no room", "status": 507 });
        let job = JobDocument::parse(json.clone()).expect("a job");
        assert_eq!(job.status.error.as_deref(), Some("no room"));
        assert!(job.is_final());
        assert_eq!(job.json, json);
        assert!(!JobDocument::parse(document("running")).expect("a job").is_final());
    }

    #[test]
    fn what_is_not_a_job_is_an_error() {
        assert!(JobDocument::parse(document("asleep")).is_err());
        assert!(JobDocument::parse(Value::Null).is_err());
    }
}
