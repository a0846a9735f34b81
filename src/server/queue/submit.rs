//! Submitting and cancelling jobs.

use super::{
    Job, JobId, JobState, Queue, QueueError,
    active::ActiveJob,
    jobs::conclusion,
    record::{self, JobRecord},
    task::TaskState,
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
    /// The job is queued now.
    Queued(Job),
    /// An equal job was queued or running already.
    Joined(Job),
    /// The job was done before, and its table is still stored.
    Done(Job, Digest),
}

impl Queue {
    /// Submits a job, which is durable when this returns. A queued or running job is joined. A job that has failed or
    /// was cancelled, or whose table `has_table` says is gone, is queued again: its attempts are counted anew, and its
    /// finished shards are kept as far as they are still stored.
    ///
    /// # Errors
    /// When the queue is full, or the job cannot be stored; then nothing has changed.
    pub fn submit(&self, new: NewJob, has_table: &dyn Fn(Digest) -> bool) -> Result<Submitted, QueueError> {
        let id = JobId::of_recipe(&new.recipe_digest);
        let mut state = self.lock();
        if let Some(active) = state.by_id.get(&id).and_then(|submission| state.active.get(submission)) {
            return Ok(Submitted::Joined(active.job()));
        }
        self.forget_old(&mut state);
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
        let mut tasks = vec![TaskState::new(); record.shard_entries.len() + 1];
        if let Some(former) = &former {
            batch.remove(Tree::JobOrder, former.submission.to_be_bytes());
            if former.shard_entries == record.shard_entries {
                self.keep_finished(&mut batch, &record, &mut tasks)?;
            } else {
                record::remove_tasks(&mut batch, former);
            }
        }
        record::put_job(&mut batch, &record)?;
        self.commit(&mut state, Ok(batch))?;
        state.forget_concluded(former.as_ref());
        state.next_submission += 1;
        let active = ActiveJob::new(record, tasks);
        let job = active.job();
        state.by_id.insert(id, submission);
        state.active.insert(submission, active);
        state.record_change(id);
        self.changed.notify_all();
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

    /// Keeps the finished shards of an earlier submission and removes the rows of all other tasks.
    fn keep_finished(&self, batch: &mut Batch, record: &JobRecord, tasks: &mut [TaskState]) -> Result<(), StoreError> {
        for (task, state) in self.stored_tasks(record.job.id)? {
            let slot = tasks.get_mut(task as usize).filter(|_| task < record.shards());
            match (slot, state) {
                (Some(slot), Some(TaskState::Finished { .. })) => {
                    *slot = TaskState::Finished { attempt: 0 };
                }
                _ => batch.remove(Tree::Shards, record::task_key(record.job.id, task)),
            }
        }
        Ok(())
    }

    /// Records a done job whose table was found in the store although the queue did not know the job. A job that is
    /// queued, running or done already stays as it is.
    ///
    /// # Errors
    /// When it cannot be stored.
    pub fn adopt(&self, done: Job) -> Result<Job, StoreError> {
        let mut state = self.lock();
        if let Some(active) = state.by_id.get(&done.id).and_then(|submission| state.active.get(submission)) {
            return Ok(active.job());
        }
        self.forget_old(&mut state);
        let former = self.record(&state, done.id)?;
        let mut batch = Batch::default();
        if let Some(former) = &former {
            if former.job.state == done.state {
                return Ok(former.job.clone());
            }
            batch.remove(Tree::JobOrder, former.submission.to_be_bytes());
            record::remove_tasks(&mut batch, former);
        }
        let record = JobRecord { submission: state.next_submission, shard_entries: vec![], job: done };
        record::put_job(&mut batch, &record)?;
        self.commit(&mut state, Ok(batch))?;
        state.forget_concluded(former.as_ref());
        state.next_submission += 1;
        state.conclude(&record);
        Ok(record.job)
    }

    /// Cancels a job, durably when this returns, and voids its leases. A job in a final state stays as it is. Returns
    /// the job as it is afterwards.
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
        self.changed.notify_all();
        Ok(Some(record.job))
    }
}
