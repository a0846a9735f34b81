//! The JSON documents of the interface.

use jiff::Timestamp;
use serde::Serialize;
use serde_json::value::RawValue;

use super::problem::Problem;
use crate::{
    queue::{Job, JobId, JobState, StateName},
    service::{Expected, Foreseen, JobSnapshot},
};
use ltcforge_files::digest::Digest;

/// A job.
#[derive(Debug, Serialize)]
pub(super) struct JobView {
    id: JobId,
    state: StateName,
    /// The stored canonical text. It is not parsed, so no digit changes.
    recipe: Box<RawValue>,
    recipe_digest: Digest,
    progress: ProgressView,
    expected: Option<Expected>,
    attempts: u32,
    table: Option<Digest>,
    error: Option<Problem>,
    created_at: Timestamp,
    started_at: Option<Timestamp>,
    finished_at: Option<Timestamp>,
    #[serde(skip_serializing_if = "Option::is_none")]
    submitted_by: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    cancelled_by: Option<String>,
}

#[derive(Debug, Serialize)]
struct ProgressView {
    entries_done: u64,
    entries_total: u64,
    seconds_left: Option<f64>,
}

/// A known recipe and its table.
#[derive(Debug, Serialize)]
pub(super) struct RecipeView {
    recipe_digest: Digest,
    recipe: Box<RawValue>,
    table: Option<Digest>,
}

/// The forecast for a recipe document.
#[derive(Debug, Default, Serialize)]
pub(super) struct ForeseenView {
    recipe: Option<Box<RawValue>>,
    recipe_digest: Option<Digest>,
    entries: Option<u64>,
    table: Option<Digest>,
    expected: Option<Expected>,
    /// The problem that submitting this recipe would cause.
    problem: Option<Problem>,
}

impl JobView {
    /// The current state of a job.
    ///
    /// # Errors
    /// When the stored recipe is not JSON.
    pub(super) fn new(job: &Job, seconds_left: Option<f64>, expected: Option<Expected>) -> Result<Self, Problem> {
        let (table, error) = match &job.state {
            JobState::Done { table } => (Some(*table), None),
            JobState::Failed { error } => (None, Some(error.into())),
            JobState::Queued | JobState::Running | JobState::Cancelled => (None, None),
        };
        Ok(Self {
            id: job.id,
            state: job.state.name(),
            recipe: raw(&job.recipe)?,
            recipe_digest: job.recipe_digest,
            progress: ProgressView {
                entries_done: job.entries_done,
                entries_total: job.entries_total,
                seconds_left: seconds_left.filter(|seconds| seconds.is_finite()),
            },
            expected,
            attempts: job.attempts,
            table,
            error,
            created_at: job.created_at,
            started_at: job.started_at,
            finished_at: job.finished_at,
            submitted_by: job.submitted_by.clone(),
            cancelled_by: job.cancelled_by.clone(),
        })
    }

    /// A job and its forecasts.
    ///
    /// # Errors
    /// See [`Self::new`].
    pub(super) fn of_snapshot(snapshot: &JobSnapshot) -> Result<Self, Problem> {
        Self::new(&snapshot.job, snapshot.seconds_left, snapshot.expected)
    }
}

impl RecipeView {
    /// A stored recipe.
    ///
    /// # Errors
    /// When the stored recipe is not JSON.
    pub(super) fn new(recipe_digest: Digest, recipe: &str, table: Option<Digest>) -> Result<Self, Problem> {
        Ok(Self { recipe_digest, recipe: raw(recipe)?, table })
    }
}

impl ForeseenView {
    /// The forecast for a valid recipe.
    ///
    /// # Errors
    /// When the canonical recipe is not JSON.
    pub(super) fn new(foreseen: Foreseen) -> Result<Self, Problem> {
        Ok(Self {
            recipe: Some(raw(&foreseen.recipe)?),
            recipe_digest: Some(foreseen.recipe_digest),
            entries: Some(foreseen.entries),
            table: foreseen.table,
            expected: foreseen.expected,
            problem: foreseen.refused.map(Into::into),
        })
    }

    /// The forecast for a recipe with faults.
    pub(super) fn refused(problem: Problem) -> Self {
        Self { problem: Some(problem), ..Self::default() }
    }
}

fn raw(json: &str) -> Result<Box<RawValue>, Problem> {
    RawValue::from_string(json.to_owned()).map_err(|error| super::error::internal(&error))
}

/// Jobs for tests.
#[cfg(test)]
pub(super) mod samples {
    use super::*;

    /// A job with a made-up recipe.
    pub(crate) fn job(state: JobState) -> Job {
        let recipe = r#"{"range":{"theta":[0,1.5707963267948966]}}"#.to_owned();
        let recipe_digest = Digest::of(recipe.as_bytes());
        Job {
            id: JobId::of_recipe(&recipe_digest),
            recipe,
            recipe_digest,
            state,
            entries_total: 16,
            entries_done: 4,
            attempts: 1,
            created_at: Timestamp::UNIX_EPOCH,
            started_at: None,
            finished_at: None,
            submitted_by: None,
            cancelled_by: None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::queue::{Failure, FailureKind};

    fn json(state: JobState) -> serde_json::Value {
        let view = JobView::new(&samples::job(state), Some(f64::INFINITY), None).expect("the recipe is JSON");
        serde_json::to_value(view).expect("a job serialises")
    }

    #[test]
    fn a_job_shows_table_or_error_by_its_state() {
        let table = Digest::of(b"table");
        let done = json(JobState::Done { table });
        assert_eq!((&done["state"], &done["table"]), (&"done".into(), &table.to_string().into()));
        assert!(done["error"].is_null());

        let error = Failure { kind: FailureKind::DiskFull, detail: "no room".into() };
        let failed = json(JobState::Failed { error });
        assert_eq!(failed["error"]["type"], "/problems/disk-full");
        assert_eq!(failed["error"]["detail"], "no room");
        assert!(failed["table"].is_null());
    }

    #[test]
    fn a_job_keeps_every_digit_of_its_recipe_and_shows_no_infinity() {
        let view =
            JobView::new(&samples::job(JobState::Queued), Some(f64::INFINITY), None).expect("the recipe is JSON");
        let text = serde_json::to_string(&view).expect("a job serialises");
        assert!(text.contains("1.5707963267948966"), "{text}");
        assert!(text.contains(r#""seconds_left":null"#), "{text}");
        assert!(text.contains(r#""created_at":"1970-01-01T00:00:00Z""#), "{text}");
    }

    #[test]
    fn a_recipe_that_is_not_json_is_a_problem_not_a_panic() {
        let job = Job { recipe: "{".into(), ..samples::job(JobState::Queued) };
        assert!(JobView::new(&job, None, None).is_err());
    }
}
