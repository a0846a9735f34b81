//! Jobs as their submitters see them.

use std::time::Duration;

use tokio::sync::watch;

use super::{Expected, JobNews, Page, Service, ServiceError, Submission, SubmitError, core::Core};
use crate::{
    files::digest::Digest,
    server::{
        queue::{Job, JobId, JobState, NewJob, QueueError, StateName, Submitted},
        store::StoreError,
    },
};

/// Shortest and longest time after which a refused submitter is told to come back, seconds.
const RETRY_SECONDS: (f64, f64) = (1.0, 600.0);

/// What that is while no pace is known, seconds.
const RETRY_UNKNOWN_SECONDS: f64 = 5.0;

impl Service {
    /// Submits a recipe document. The job is durable when this returns.
    ///
    /// # Errors
    /// See [`SubmitError`].
    pub fn submit(&self, document: &[u8]) -> Result<Submission, SubmitError> {
        if self.core.is_stopping() {
            return Err(SubmitError::Stopping);
        }
        let new = self.core.engine.plan(document, self.core.config.entry_limit)?;
        let submission = self.core.submit(new);
        self.core.publish_changes();
        submission
    }

    /// What the fit of a stored recipe is expected to take and to give here; `None` for another fitter's.
    #[must_use]
    pub fn expected(&self, recipe: &str) -> Option<Expected> {
        self.core.forecast.of(recipe)
    }

    /// A job by its id, with the expected seconds to its end.
    ///
    /// # Errors
    /// When the store fails.
    pub fn job(&self, id: JobId) -> Result<Option<JobNews>, ServiceError> {
        Ok(self.core.queue.job(id)?.map(|job| self.core.hub.news(job)))
    }

    /// Jobs, newest first.
    ///
    /// # Errors
    /// When the store fails. An unknown cursor starts from the newest.
    pub fn jobs(
        &self,
        state: Option<StateName>,
        cursor: Option<&str>,
        limit: usize,
    ) -> Result<Page<JobNews>, ServiceError> {
        let before = cursor.and_then(|cursor| cursor.parse().ok());
        let (jobs, next) = self.core.queue.list(state, before, limit)?;
        let items = jobs.into_iter().map(|job| self.core.hub.news(job)).collect();
        Ok(Page { items, next: next.map(|next| next.to_string()) })
    }

    /// Cancels a job. A finished job stays as it is. Returns the job as it is afterwards.
    ///
    /// # Errors
    /// When the store fails.
    pub fn cancel(&self, id: JobId) -> Result<Option<JobNews>, ServiceError> {
        let job = self.core.queue.cancel(id)?;
        self.core.publish_changes();
        Ok(job.map(|job| self.core.hub.news(job)))
    }

    /// Follows a job: the receiver always holds the latest news.
    ///
    /// # Errors
    /// When the store fails.
    pub fn watch(&self, id: JobId) -> Result<Option<watch::Receiver<JobNews>>, ServiceError> {
        Ok(self.core.hub.watch(id, || self.core.queue.job(id))?)
    }
}

impl Core {
    fn submit(&self, new: NewJob) -> Result<Submission, SubmitError> {
        let digest = new.recipe_digest;
        let table = self.table_of(digest).map_err(ServiceError::from)?;
        if let Some(table) = table {
            let job = self.queue.adopt(self.done(new, table)).map_err(ServiceError::from)?;
            return Ok(match job.state {
                JobState::Done { .. } => Submission::Ready { job, table },
                _ => Submission::InFlight { job, joined: true },
            });
        }
        let has_table = |_| self.table_of(digest).is_ok_and(|table| table.is_some());
        match self.queue.submit(new, &has_table) {
            Ok(Submitted::Queued(job)) => Ok(Submission::InFlight { job, joined: false }),
            Ok(Submitted::Joined(job)) => Ok(Submission::InFlight { job, joined: true }),
            Ok(Submitted::Done(job, table)) => Ok(Submission::Ready { job, table }),
            Err(QueueError::Full { limit }) => Err(SubmitError::QueueFull { limit, retry_after: self.retry_after() }),
            Err(QueueError::Store(error)) => Err(SubmitError::Store(error.into())),
        }
    }

    /// The table of a recipe, if it is in the catalogue and its blob is there.
    pub(super) fn table_of(&self, recipe_digest: Digest) -> Result<Option<Digest>, StoreError> {
        let table = self.catalogue.recipe(recipe_digest)?.map(|(_, table)| table);
        Ok(table.filter(|table| self.store.blobs.contains(*table)))
    }

    /// The job of a table that is in the store, for the case that its own was lost.
    fn done(&self, new: NewJob, table: Digest) -> Job {
        let stored_at = self.catalogue.table(table).ok().flatten().map_or_else(|| (self.clock)(), |row| row.created_at);
        let entries = new.shard_entries.iter().copied().map(u64::from).sum();
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
        }
    }

    /// When the first job is expected to make room.
    fn retry_after(&self) -> Duration {
        let first = self.queue.unfinished().into_iter().next();
        let seconds = first.and_then(|job| self.hub.news(job).seconds_left).unwrap_or(RETRY_UNKNOWN_SECONDS);
        Duration::try_from_secs_f64(seconds.clamp(RETRY_SECONDS.0, RETRY_SECONDS.1)).unwrap_or(Duration::from_secs(1))
    }
}
