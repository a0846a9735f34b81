//! Submitting jobs.

use super::{
    active::ActiveJob,
    record::{self, JobRecord},
    state::{EmbeddedQueue, QueueState},
    task::{Task, TaskState},
};
use crate::{
    queue::{Claim, Job, JobId, JobState, NewJob, QueueError, Submitted},
    store::{Batch, StoreError},
};
use ltcforge_files::digest::Digest;

impl EmbeddedQueue {
    pub(super) fn submit_job(&self, new: NewJob, has_table: &dyn Fn(Digest) -> bool) -> Result<Submitted, QueueError> {
        let id = JobId::of_recipe(&new.recipe_digest);
        let mut state = self.lock();
        let claim = new.claim();
        if let Some(joined) = self.join(&mut state, id, &claim)? {
            return Ok(Submitted::Joined(joined));
        }
        self.forget_old(&mut state);
        let former = state.ended_job(id);
        if let Some(JobRecord { job: job @ Job { state: JobState::Done { table }, .. }, .. }) = former
            && has_table(*table)
        {
            return Ok(Submitted::Done(job.clone(), *table));
        }
        if state.active.len() >= self.limits.jobs {
            return Err(QueueError::Full { limit: self.limits.jobs, team: None });
        }
        let limit = self.limits.jobs_of(&claim.team);
        if state.active.values().filter(|active| active.claim().team == claim.team).count() >= limit {
            return Err(QueueError::Full { limit, team: Some(claim.team) });
        }
        let submission = state.next_submission;
        let record = self.new_record(new, submission);
        let (mut batch, mut tasks) = (Batch::default(), vec![Task::default(); record.shard_entries.len() + 1]);
        if let Some(former) = former {
            self.keep_finished(&mut batch, former, &record, &mut tasks)?;
        }
        record::put_job(&mut batch, &record)?;
        self.commit(&mut state, batch)?;
        state.forget(id);
        state.leftovers.retain(|(job, _)| *job != id);
        state.next_submission += 1;
        let active = ActiveJob::new(record, tasks);
        let job = active.job();
        state.by_id.insert(id, submission);
        state.activate(submission, active);
        state.record_change(id);
        self.changed.notify_all();
        Ok(Submitted::Queued(job))
    }

    /// The unfinished job of this id, if there is one; served from now on as `claim` says if its priority is higher.
    fn join(&self, state: &mut QueueState, id: JobId, claim: &Claim) -> Result<Option<Job>, StoreError> {
        let Some(active) = state.active_job(id) else { return Ok(None) };
        if active.claim().priority < claim.priority {
            let mut record = active.record.clone();
            record.job.claim = claim.clone();
            let mut batch = Batch::default();
            record::put_job(&mut batch, &record)?;
            self.commit(state, batch)?;
            if let Some(mut active) = state.active.remove(&record.submission) {
                active.record = record;
                state.activate(active.record.submission, active);
            }
        }
        Ok(state.active_job(id).map(ActiveJob::job))
    }

    fn new_record(&self, new: NewJob, submission: u64) -> JobRecord {
        let job = Job {
            id: JobId::of_recipe(&new.recipe_digest),
            recipe_digest: new.recipe_digest,
            state: JobState::Queued,
            entries_total: new.entries(),
            entries_done: 0,
            attempts: 0,
            created_at: (self.clock.wall)(),
            started_at: None,
            finished_at: None,
            submitted_by: new.submitted_by(),
            cancelled_by: None,
            claim: new.claim(),
            recipe: new.recipe,
        };
        JobRecord { submission, shard_entries: new.shard_entries, job }
    }

    /// Keeps the finished shards of an earlier submission, if its shards were the same, and removes the rows of all
    /// other tasks.
    fn keep_finished(
        &self,
        batch: &mut Batch,
        former: &JobRecord,
        record: &JobRecord,
        tasks: &mut [Task],
    ) -> Result<(), StoreError> {
        let has_same_shards = former.shard_entries == record.shard_entries;
        for (number, stored) in record::stored_tasks(self.rows.as_ref(), record.job.id)? {
            let is_finished = stored.is_some_and(|task| task.state == TaskState::Finished);
            match tasks.get_mut(number as usize) {
                Some(slot) if has_same_shards && is_finished => slot.state = TaskState::Finished,
                _ => record::remove_tasks(batch, [record::task_key(record.job.id, number)]),
            }
        }
        Ok(())
    }

    pub(super) fn adopt_job(&self, done: Job) -> Result<Job, StoreError> {
        let mut state = self.lock();
        if let Some(active) = state.active_job(done.id) {
            return Ok(active.job());
        }
        self.forget_old(&mut state);
        let former = state.ended_job(done.id);
        if let Some(former) = former.filter(|former| former.job.state == done.state) {
            return Ok(former.job.clone());
        }
        let leftovers = former.map(|former| (done.id, former.tasks()));
        let record = JobRecord { submission: state.next_submission, shard_entries: vec![], job: done.clone() };
        let mut batch = Batch::default();
        record::put_job(&mut batch, &record)?;
        self.commit(&mut state, batch)?;
        state.forget(done.id);
        state.leftovers.extend(leftovers);
        state.next_submission += 1;
        self.end(&mut state, record);
        Ok(done)
    }
}
