//! Submitting and cancelling jobs.

use super::{
    active::ActiveJob,
    jobs::{EmbeddedQueue, conclusion},
    record::{self, JobRecord},
    remains::Remains,
    task::TaskState,
};
use crate::{
    queue::{Job, JobId, JobState, NewJob, QueueError, Submitted},
    store::{Batch, StoreError, Tree},
};
use ltcforge_files::digest::Digest;

impl EmbeddedQueue {
    pub(super) fn submit_job(&self, new: NewJob, has_table: &dyn Fn(Digest) -> bool) -> Result<Submitted, QueueError> {
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
                self.remove_all(former)?;
            }
        }
        record::put_job(&mut batch, &record)?;
        self.commit(&mut state, batch)?;
        state.reclaim(id);
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

    pub(super) fn adopt_job(&self, done: Job) -> Result<Job, StoreError> {
        let mut state = self.lock();
        if let Some(active) = state.by_id.get(&done.id).and_then(|submission| state.active.get(submission)) {
            return Ok(active.job());
        }
        self.forget_old(&mut state);
        let former = self.record(&state, done.id)?;
        let mut batch = Batch::default();
        let mut remains = Remains::none(done.id);
        if let Some(former) = &former {
            if former.job.state == done.state {
                return Ok(former.job.clone());
            }
            batch.remove(Tree::JobOrder, former.submission.to_be_bytes());
            remains = Remains::of(former);
            remains.remove_some(&mut batch);
        }
        let record = JobRecord { submission: state.next_submission, shard_entries: vec![], job: done };
        record::put_job(&mut batch, &record)?;
        self.commit(&mut state, batch)?;
        state.forget_concluded(former.as_ref());
        state.next_submission += 1;
        state.conclude(&record, remains);
        Ok(record.job)
    }

    pub(super) fn cancel_job(&self, id: JobId) -> Result<Option<Job>, StoreError> {
        let mut state = self.lock();
        let Some(active) = state.by_id.get(&id).and_then(|submission| state.active.get(submission)) else {
            return self.find(&state, id);
        };
        let record = active.concluded(JobState::Cancelled, (self.clock)());
        let (batch, remains) = conclusion(&record)?;
        self.commit(&mut state, batch)?;
        state.conclude(&record, remains);
        self.changed.notify_all();
        Ok(Some(record.job))
    }
}
