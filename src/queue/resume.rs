//! Opening the queue: what an earlier process left.

use std::{
    collections::HashSet,
    sync::{Arc, Condvar, Mutex},
};

use super::{Clock, JobId, JobState, Limits, Queue, active::Active, jobs::State, record::JobRecord, step::StepState};
use crate::store::{Batch, Rows, StoreError, Tree};

impl Queue {
    /// Opens the queue in `rows`. Unfinished jobs go on: leases of the dead process are void and count as failed,
    /// finished shards stay finished.
    ///
    /// # Errors
    /// When the database fails.
    pub fn open(rows: Arc<dyn Rows>, limits: Limits, clock: Clock) -> Result<Self, StoreError> {
        let queue = Self { rows, limits, clock, state: Mutex::new(State::default()), news: Condvar::new() };
        let mut keep = HashSet::new();
        {
            let mut state = queue.lock();
            let last = queue.rows.page(Tree::JobOrder, None, 1)?;
            let last = last.first().and_then(|row| Some(u64::from_be_bytes(row.key.as_slice().try_into().ok()?)));
            state.next_submission = last.map_or(0, |last| last + 1);
            let mut obsolete = Batch::default();
            for row in queue.rows.scan(Tree::Jobs, &[])? {
                let record = row.value.and_then(|value| serde_json::from_slice::<JobRecord>(&value).ok());
                let Some(record) = record else {
                    tracing::error!(key = ?row.key, "a job's row is damaged; the job is lost and can be submitted again");
                    obsolete.remove(Tree::Jobs, row.key);
                    continue;
                };
                // A damaged or missing order row must not let a number be given twice.
                state.next_submission = state.next_submission.max(record.submission + 1);
                match record.job.state {
                    JobState::Queued | JobState::Running => {
                        keep.insert(record.job.id);
                        queue.resume(&mut state, record)?;
                    }
                    JobState::Failed { .. } => {
                        keep.insert(record.job.id);
                        *state.concluded.entry(record.job.state.name()).or_default() += 1;
                    }
                    JobState::Done { .. } | JobState::Cancelled => {
                        *state.concluded.entry(record.job.state.name()).or_default() += 1;
                    }
                }
            }
            queue.sweep(&mut obsolete, &keep)?;
            if !obsolete.is_empty() {
                queue.commit(&mut state, Ok(obsolete))?;
            }
        }
        Ok(queue)
    }

    fn resume(&self, state: &mut State, record: JobRecord) -> Result<(), StoreError> {
        let mut steps = vec![StepState::new(); record.shard_entries.len() + 1];
        let (id, submission) = (record.job.id, record.submission);
        let mut crashed = Vec::new();
        for (step, stored) in self.stored_steps(id)? {
            let Some((slot, stored)) = steps.get_mut(step as usize).zip(stored) else { continue };
            if let StepState::Leased { attempt, .. } = stored {
                crashed.push((step, attempt));
            }
            *slot = stored;
        }
        let finished = steps.iter().filter(|step| matches!(step, StepState::Finished { .. })).count();
        tracing::info!(job = %id, finished, shards = record.shard_entries.len(), "the job goes on");
        state.by_id.insert(id, submission);
        state.active.insert(submission, Active::new(record, steps));
        for (step, attempt) in crashed {
            // The job may just have failed with another of its leases.
            let _ = self.fail_step(state, submission, step, attempt, "the process ended in the middle of it");
        }
        Ok(())
    }

    /// Removes steps and results of jobs that need them no more: what a full disk kept from being removed.
    fn sweep(&self, batch: &mut Batch, keep: &HashSet<JobId>) -> Result<(), StoreError> {
        for row in self.rows.scan(Tree::Shards, &[])? {
            let id = row.key.get(..16).and_then(JobId::from_slice);
            if id.is_none_or(|id| !keep.contains(&id)) {
                batch.remove(Tree::Results, row.key.clone());
                batch.remove(Tree::Shards, row.key);
            }
        }
        Ok(())
    }
}
