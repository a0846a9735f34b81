//! Into the queue, and out of it by a user's wish.

use super::{
    Job, JobId, JobState, Queue, QueueError,
    active::Active,
    jobs::{State, conclusion},
    record::{self, JobRecord},
    step::StepState,
};
use crate::{
    files::digest::Digest,
    server::store::{Batch, StoreError, Tree},
};

/// A job to submit.
#[derive(Debug, Clone)]
pub struct NewJob {
    /// Canonical text of the recipe.
    pub recipe: String,
    /// Its digest; the job's id follows from it.
    pub recipe_digest: Digest,
    /// Entries of each shard. Equal recipes have equal shards.
    pub shard_entries: Vec<u32>,
}

/// What became of a submission.
#[derive(Debug, Clone, PartialEq)]
pub enum Submitted {
    /// It is in the queue now.
    Queued(Job),
    /// It was there already.
    Joined(Job),
    /// It was done before, and its table is still there.
    Done(Job, Digest),
}

impl Queue {
    /// Submits a job: it is durable when this returns. A job in flight is joined. One that has failed or was
    /// cancelled, or whose table is gone as `has_table` tells, is queued again: attempts start anew, and what is
    /// left of its finished shards counts.
    ///
    /// # Errors
    /// When the queue is full, or the job cannot be stored; then nothing has changed.
    pub fn submit(&self, new: NewJob, has_table: &dyn Fn(Digest) -> bool) -> Result<Submitted, QueueError> {
        let id = JobId::of_recipe(&new.recipe_digest);
        let mut state = self.lock();
        if let Some(active) = state.by_id.get(&id).and_then(|submission| state.active.get(submission)) {
            return Ok(Submitted::Joined(active.job()));
        }
        let former = self.record(&state, id)?;
        if let Some(JobRecord { job: job @ Job { state: JobState::Done { table }, .. }, .. }) = &former
            && has_table(*table)
        {
            return Ok(Submitted::Done(job.clone(), *table));
        }
        if state.active.len() >= self.limits.jobs {
            return Err(QueueError::Full { limit: self.limits.jobs });
        }
        let submission = state.next_submission;
        let record = self.new_record(new, submission);
        let mut batch = Batch::default();
        let mut steps = vec![StepState::new(); record.shard_entries.len() + 1];
        if let Some(former) = &former {
            batch.remove(Tree::JobOrder, former.submission.to_be_bytes());
            if former.shard_entries == record.shard_entries {
                self.keep_finished(&mut batch, &record, &mut steps)?;
            } else {
                record::remove_steps(&mut batch, former);
            }
        }
        record::put_job(&mut batch, &record)?;
        self.commit(&mut state, Ok(batch))?;
        state.forget_concluded(former.as_ref());
        state.next_submission += 1;
        let active = Active::new(record, steps);
        let job = active.job();
        state.by_id.insert(id, submission);
        state.active.insert(submission, active);
        state.wake(id);
        self.news.notify_all();
        Ok(Submitted::Queued(job))
    }

    fn new_record(&self, new: NewJob, submission: u64) -> JobRecord {
        let job = Job {
            id: JobId::of_recipe(&new.recipe_digest),
            recipe: new.recipe,
            recipe_digest: new.recipe_digest,
            state: JobState::Queued,
            entries_total: new.shard_entries.iter().copied().map(u64::from).sum(),
            entries_done: 0,
            attempts: 0,
            created_at: (self.clock)(),
            started_at: None,
            finished_at: None,
        };
        JobRecord { submission, shard_entries: new.shard_entries, job }
    }

    /// Takes the finished shards of an earlier submission over, and removes the rows of all other steps.
    fn keep_finished(&self, batch: &mut Batch, record: &JobRecord, steps: &mut [StepState]) -> Result<(), StoreError> {
        for (step, state) in self.stored_steps(record.job.id)? {
            let slot = steps.get_mut(step as usize).filter(|_| step < record.shards());
            match (slot, state) {
                (Some(slot), Some(StepState::Finished { .. })) => {
                    *slot = StepState::Finished { attempt: 0 };
                }
                _ => batch.remove(Tree::Shards, record::step_key(record.job.id, step)),
            }
        }
        Ok(())
    }

    /// The stored states of a job's steps; `None` for a damaged row.
    pub(super) fn stored_steps(&self, id: JobId) -> Result<Vec<(u32, Option<StepState>)>, StoreError> {
        let rows = self.rows.scan(Tree::Shards, id.as_bytes())?;
        let read = |value: Option<Vec<u8>>| serde_json::from_slice(&value?).ok();
        Ok(rows.into_iter().filter_map(|row| Some((record::step_of_key(&row.key)?, read(row.value)))).collect())
    }

    /// Enters a job that is done, though not by this queue's doing: its table was found in the store. A job that
    /// the queue has in flight or knows to be done stays as it is.
    ///
    /// # Errors
    /// When it cannot be stored.
    pub fn adopt(&self, done: Job) -> Result<Job, StoreError> {
        let mut state = self.lock();
        if let Some(active) = state.by_id.get(&done.id).and_then(|submission| state.active.get(submission)) {
            return Ok(active.job());
        }
        let former = self.record(&state, done.id)?;
        let mut batch = Batch::default();
        if let Some(former) = &former {
            if former.job.state == done.state {
                return Ok(former.job.clone());
            }
            batch.remove(Tree::JobOrder, former.submission.to_be_bytes());
            record::remove_steps(&mut batch, former);
        }
        let record = JobRecord { submission: state.next_submission, shard_entries: vec![], job: done };
        record::put_job(&mut batch, &record)?;
        self.commit(&mut state, Ok(batch))?;
        state.forget_concluded(former.as_ref());
        state.next_submission += 1;
        state.conclude(&record);
        Ok(record.job)
    }

    /// Cancels a job; it is durable when this returns. A job in a final state stays as it is. Leases of the job are
    /// void from here on. Returns the job as it is afterwards.
    ///
    /// # Errors
    /// When it cannot be stored; then nothing has changed.
    pub fn cancel(&self, id: JobId) -> Result<Option<Job>, StoreError> {
        let mut state = self.lock();
        let Some(active) = state.by_id.get(&id).and_then(|submission| state.active.get(submission)) else {
            return self.find(&state, id);
        };
        let record = active.concluded(JobState::Cancelled, (self.clock)());
        self.commit(&mut state, conclusion(&record))?;
        state.conclude(&record);
        self.news.notify_all();
        Ok(Some(record.job))
    }

    /// A job that is not active, as it was last stored.
    pub(super) fn record(&self, state: &State, id: JobId) -> Result<Option<JobRecord>, StoreError> {
        if let Some(record) = state.unsaved.get(&id) {
            return Ok(Some(record.clone()));
        }
        match self.rows.get(Tree::Jobs, id.as_bytes()) {
            Ok(value) => Ok(value.and_then(|value| serde_json::from_slice(&value).ok())),
            Err(error @ StoreError::DamagedRow { .. }) => {
                tracing::error!(job = %id, %error, "the job is lost; it can be submitted again");
                Ok(None)
            }
            Err(error) => Err(error),
        }
    }
}
