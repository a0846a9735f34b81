//! Submits and looks up jobs.

use std::{sync::PoisonError, time::Duration};

use super::{Expected, JobCursor, JobSnapshot, Page, Service, ServiceError, SubmitError, state::State};
use crate::queue::{Job, JobId, JobState, NewJob, QueueError, StateName, Submitted};
use ltcforge_files::digest::Digest;

/// Minimum and maximum number of seconds after which a refused client should try again.
const RETRY_SECONDS: (f64, f64) = (1.0, 600.0);
/// Seconds after which a refused client should try again while the end of running jobs cannot be estimated.
const RETRY_UNKNOWN_SECONDS: f64 = 5.0;

/// The result of submitting a recipe.
#[derive(Debug, Clone)]
pub enum SubmitReply {
    /// The job is queued or running.
    InFlight {
        /// The job.
        job: Job,
        /// Whether the job was already queued or running before this submission.
        joined: bool,
    },
    /// The table is already stored.
    Ready {
        /// The job that made it.
        job: Job,
        /// The table.
        table: Digest,
    },
}

/// The forecast for a submission.
#[derive(Debug)]
pub struct Foreseen {
    /// The canonical JSON of the recipe.
    pub recipe: String,
    /// The digest of the recipe.
    pub recipe_digest: Digest,
    /// Number of entries of the table.
    pub entries: u64,
    /// The table, if it is stored.
    pub table: Option<Digest>,
    /// The forecast for the fit.
    pub expected: Option<Expected>,
    /// Why the job would be refused although the recipe is valid.
    pub refused: Option<SubmitError>,
}

impl Service {
    /// Submits a recipe document. The job is durable when this returns. `by` is the name of the caller's token.
    ///
    /// # Errors
    /// See [`SubmitError`].
    pub fn submit(&self, document: &[u8], by: Option<&str>) -> Result<SubmitReply, SubmitError> {
        let state = &self.state;
        if state.is_stopping() {
            return Err(ServiceError::Stopping.into());
        }
        let _naming = state.naming.read().unwrap_or_else(PoisonError::into_inner);
        let new = state.fitter.new_job(document, state.config.entry_limit)?;
        let new = NewJob { submitted_by: by.map(str::to_owned), ..new };
        let digest = new.recipe_digest;
        if let Some(table) = state.files.of_recipe(digest).map_err(ServiceError::from)? {
            state.files.used(table);
            return Ok(SubmitReply::Ready { job: state.done(new, table)?, table });
        }
        if let Some(refused) = state.too_expensive(&new)? {
            return Err(refused);
        }
        let has_table = |table| state.files.contains(table).unwrap_or(false);
        match state.queue.submit(new, &has_table) {
            Ok(Submitted::Queued(job)) => Ok(SubmitReply::InFlight { job, joined: false }),
            Ok(Submitted::Joined(job)) => Ok(SubmitReply::InFlight { job, joined: true }),
            Ok(Submitted::Done(job, table)) => Ok(SubmitReply::Ready { job, table }),
            Err(QueueError::Full(limit)) => Err(SubmitError::QueueFull(limit, state.retry_after())),
            Err(QueueError::Store(error)) => Err(SubmitError::Store(error.into())),
        }
    }

    /// The forecast for submitting a recipe document. Stores nothing.
    ///
    /// # Errors
    /// [`SubmitError::Recipe`] if the document has faults, [`SubmitError::Store`] if the store fails.
    pub fn foresee(&self, document: &[u8]) -> Result<Foreseen, SubmitError> {
        let state = &self.state;
        let new = state.fitter.new_job(document, state.config.entry_limit)?;
        let table = state.files.of_recipe(new.recipe_digest).map_err(ServiceError::from)?;
        let refused = if table.is_none() { state.too_expensive(&new)? } else { None };
        let expected = state.expected(new.recipe_digest, &new.recipe);
        let (entries, recipe_digest) = (new.entries(), new.recipe_digest);
        Ok(Foreseen { entries, recipe: new.recipe, recipe_digest, table, expected, refused })
    }

    /// The forecast for a job. `None` if its recipe is for another fitter version.
    #[must_use]
    pub fn expected(&self, job: &Job) -> Option<Expected> {
        self.state.expected(job.recipe_digest, &job.recipe)
    }

    /// The job with this id, with its forecasts.
    ///
    /// # Errors
    /// When the store fails.
    pub fn job(&self, id: JobId) -> Result<Option<JobSnapshot>, ServiceError> {
        Ok(self.state.queue.job(id)?.map(|job| self.state.snapshot(job)))
    }

    /// The job that made a table, if it is still remembered.
    ///
    /// # Errors
    /// When the store fails.
    pub fn job_of_table(&self, table: Digest) -> Result<Option<Job>, ServiceError> {
        Ok(self.state.queue.job_of_table(table)?)
    }

    /// Jobs, newest first.
    ///
    /// # Errors
    /// When the store fails.
    pub fn jobs(
        &self,
        state: Option<StateName>,
        cursor: Option<JobCursor>,
        limit: usize,
    ) -> Result<Page<JobSnapshot>, ServiceError> {
        let (jobs, next) = self.state.queue.list(state, cursor.map(|cursor| cursor.0), limit)?;
        let items = jobs.into_iter().map(|job| self.state.snapshot(job)).collect();
        Ok(Page { items, next: next.map(|next| next.to_string()) })
    }

    /// Cancels a job. A job that has ended does not change. Returns the job after the change.
    ///
    /// # Errors
    /// When the store fails.
    pub fn cancel(&self, id: JobId, by: Option<&str>) -> Result<Option<JobSnapshot>, ServiceError> {
        let job = self.state.queue.cancel(id, by)?;
        Ok(job.map(|job| self.state.snapshot(job)))
    }
}

impl State {
    fn expected(&self, digest: Digest, recipe: &str) -> Option<Expected> {
        self.fitter.planned(digest, recipe).ok().map(|planned| self.forecast.of(&planned))
    }

    /// The error if a job without a table would take too long. A job that was accepted under another limit continues.
    fn too_expensive(&self, new: &NewJob) -> Result<Option<SubmitError>, ServiceError> {
        let predicted = self.expected(new.recipe_digest, &new.recipe).map_or(0.0, |expected| expected.seconds);
        let limit = self.config.job_seconds;
        if predicted <= limit as f64 {
            return Ok(None);
        }
        let job = self.queue.job(JobId::of_recipe(&new.recipe_digest))?;
        let is_known = job.is_some_and(|job| !job.state.name().is_final());
        Ok((!is_known).then_some(SubmitError::TooExpensive(predicted, limit)))
    }

    /// The job that made a stored table. If the queue has removed the job, the result is built from the catalogue.
    fn done(&self, new: NewJob, table: Digest) -> Result<Job, ServiceError> {
        let id = JobId::of_recipe(&new.recipe_digest);
        if let Some(job) = self.queue.job(id)?.filter(|job| job.state == JobState::Done { table }) {
            return Ok(job);
        }
        let row = self.files.catalogue.table(table)?;
        let stored_at = row.map_or_else(jiff::Timestamp::now, |row| row.created_at);
        let entries = new.entries();
        Ok(Job {
            id,
            recipe: new.recipe,
            recipe_digest: new.recipe_digest,
            state: JobState::Done { table },
            entries_total: entries,
            entries_done: entries,
            attempts: 0,
            created_at: stored_at,
            started_at: None,
            finished_at: Some(stored_at),
            submitted_by: None,
            cancelled_by: None,
        })
    }

    /// The time until the first running job is expected to end.
    fn retry_after(&self) -> Duration {
        let running = self.queue.list(Some(StateName::Running), None, self.config.queue_limit);
        let jobs = running.map(|(jobs, _)| jobs).unwrap_or_default();
        let left = jobs.into_iter().filter_map(|job| self.snapshot(job).seconds_left);
        let seconds = left.min_by(f64::total_cmp).unwrap_or(RETRY_UNKNOWN_SECONDS);
        Duration::try_from_secs_f64(seconds.clamp(RETRY_SECONDS.0, RETRY_SECONDS.1)).unwrap_or(Duration::from_secs(1))
    }
}
