//! Submitting jobs, and looking them up.

use std::{sync::PoisonError, time::Duration};

use tokio::sync::watch;

use super::{
    Expected, Foreseen, JobCursor, JobSnapshot, Page, Service, ServiceError, SubmitError, SubmitReply,
    find_brdf::named_in, state::ServiceState,
};
use crate::queue::{Claim, Job, JobId, JobState, NewJob, QueueError, StateName, Submitted, Submitter};
use ltcforge_files::digest::Digest;

/// Shortest and longest time, in seconds, after which a refused client is asked to try again.
const RETRY_SECONDS: (f64, f64) = (1.0, 600.0);

/// That time while the speed of the first job is not known, in seconds.
const RETRY_UNKNOWN_SECONDS: f64 = 5.0;

impl Service {
    /// Submits a recipe document. The job is durable when this returns.
    ///
    /// # Errors
    /// See [`SubmitError`].
    pub fn submit(&self, document: &[u8], by: Option<&Submitter>) -> Result<SubmitReply, SubmitError> {
        if self.state.is_stopping() {
            return Err(SubmitError::Stopping);
        }
        let _naming = self.state.naming.read().unwrap_or_else(PoisonError::into_inner);
        let new = self.state.backend.plan(document, self.state.config.entry_limit)?;
        let new = NewJob { by: by.cloned(), ..new };
        let file = self.state.old_file(&new.recipe)?;
        let submission = self.state.submit(new);
        self.state.scheduler.wake();
        self.state.publish_changes();
        let reply = submission?;
        if let Some(file) = file {
            self.state.tables.store.blobs.put(&file).map_err(ServiceError::from)?;
        }
        Ok(reply)
    }

    /// What submitting a recipe document would begin. Nothing is stored.
    ///
    /// # Errors
    /// [`SubmitError::Recipe`] for a document that is refused, [`SubmitError::Store`] when the store fails.
    pub fn foresee(&self, document: &[u8]) -> Result<Foreseen, SubmitError> {
        let new = self.state.backend.plan(document, self.state.config.entry_limit)?;
        let table = self.state.tables.of_recipe(new.recipe_digest).map_err(ServiceError::from)?;
        let refused = if table.is_none() { self.state.too_expensive(&new)? } else { None };
        let expected = self.state.forecast.of((&new).into());
        Ok(Foreseen {
            entries: new.entries(),
            recipe: new.recipe,
            recipe_digest: new.recipe_digest,
            table,
            expected,
            refused,
        })
    }

    /// The forecast for a job; `None` for a recipe of another fitter.
    #[must_use]
    pub fn expected(&self, job: &Job) -> Option<Expected> {
        self.state.forecast.of(job.into())
    }

    /// A job by its id, with its forecasts.
    ///
    /// # Errors
    /// When the store fails.
    pub fn job(&self, id: JobId) -> Result<Option<JobSnapshot>, ServiceError> {
        Ok(self.state.queue.job(id)?.map(|job| self.state.hub.snapshot(job)))
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
        let items = jobs.into_iter().map(|job| self.state.hub.snapshot(job)).collect();
        Ok(Page { items, next: next.map(|next| JobCursor(next).to_string()) })
    }

    /// Cancels a job. A finished job stays as it is. Returns the job as it is afterwards.
    ///
    /// # Errors
    /// When the store fails.
    pub fn cancel(&self, id: JobId, by: Option<&str>) -> Result<Option<JobSnapshot>, ServiceError> {
        let job = self.state.queue.cancel(id, by)?;
        self.state.publish_changes();
        Ok(job.map(|job| self.state.hub.snapshot(job)))
    }

    /// Follows a job: the receiver always holds its latest snapshot.
    ///
    /// # Errors
    /// When the store fails.
    pub fn watch(&self, id: JobId) -> Result<Option<watch::Receiver<JobSnapshot>>, ServiceError> {
        Ok(self.state.hub.watch(id, || self.state.queue.job_now(id))?)
    }
}

impl ServiceState {
    /// The file of a tabulated BRDF that a recipe names, on a store that other processes share. It is stored again once
    /// the job is known: one of them may be about to remove files that no recipe names.
    fn old_file(&self, recipe: &str) -> Result<Option<Vec<u8>>, ServiceError> {
        if self.queue.is_local() {
            return Ok(None);
        }
        named_in(recipe).map_or(Ok(None), |named| Ok(self.tables.store.blobs.get(named)?))
    }

    fn submit(&self, new: NewJob) -> Result<SubmitReply, SubmitError> {
        let digest = new.recipe_digest;
        let table = self.tables.of_recipe(digest).map_err(ServiceError::from)?;
        if let Some(table) = table {
            let job = self.queue.adopt(self.done(new, table)).map_err(ServiceError::from)?;
            return Ok(match job.state {
                JobState::Done { .. } => SubmitReply::Ready { job, table },
                _ => SubmitReply::InFlight { job, joined: true },
            });
        }
        if let Some(refused) = self.too_expensive(&new)? {
            return Err(refused);
        }
        let has_table = |_| self.tables.of_recipe(digest).is_ok_and(|table| table.is_some());
        match self.queue.submit(new, &has_table) {
            Ok(Submitted::Queued(job)) => Ok(SubmitReply::InFlight { job, joined: false }),
            Ok(Submitted::Joined(job)) => Ok(SubmitReply::InFlight { job, joined: true }),
            Ok(Submitted::Done(job, table)) => Ok(SubmitReply::Ready { job, table }),
            Err(QueueError::Full { limit, team }) => {
                Err(SubmitError::QueueFull { limit, team, retry_after: self.retry_after() })
            }
            Err(QueueError::Store(error)) => Err(SubmitError::Store(error.into())),
        }
    }

    /// Why a job without a table is not begun. One that was begun under another limit goes on.
    fn too_expensive(&self, new: &NewJob) -> Result<Option<SubmitError>, ServiceError> {
        let predicted = self.forecast.of(new.into()).map_or(0.0, |expected| expected.seconds);
        let limit = self.config.job_seconds;
        let is_refused = predicted > limit as f64 && !self.queue.is_active(JobId::of_recipe(&new.recipe_digest))?;
        Ok(is_refused.then_some(SubmitError::TooExpensive { predicted, limit }))
    }

    /// The done job of a stored table whose own job was lost.
    fn done(&self, new: NewJob, table: Digest) -> Job {
        let stored_at =
            self.tables.catalogue.table(table).ok().flatten().map_or_else(|| self.queue.now(), |row| row.created_at);
        let entries = new.entries();
        Job {
            id: JobId::of_recipe(&new.recipe_digest),
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
            claim: Claim::default(),
        }
    }

    /// When the first job is expected to end.
    fn retry_after(&self) -> Duration {
        let first = self.queue.first_unfinished().ok().flatten();
        let seconds = first.and_then(|job| self.hub.snapshot(job).seconds_left).unwrap_or(RETRY_UNKNOWN_SECONDS);
        Duration::try_from_secs_f64(seconds.clamp(RETRY_SECONDS.0, RETRY_SECONDS.1)).unwrap_or(Duration::from_secs(1))
    }
}
