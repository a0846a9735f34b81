//! Changes that become visible only after they are written to the database.

use std::{collections::BTreeSet, sync::MutexGuard};

use super::{
    EmbeddedQueue,
    record::{Entry, Record, result_key},
};
use crate::{
    queue::{Job, JobId, JobState, Lease, NewJob, StaleLease, TaskKind, order},
    store::{Batch, StoreError, Tree},
};

/// Proof that the caller has locked `writer`.
pub(super) type Writer<'a> = MutexGuard<'a, ()>;

impl EmbeddedQueue {
    /// Stores a new job, or queues an ended job again. Also removes old jobs.
    pub(super) fn store_new(&self, _writer: &Writer<'_>, new: NewJob) -> Result<Job, StoreError> {
        let now = (self.clock.wall)();
        let id = JobId::of_recipe(&new.recipe_digest);
        let entries_total = new.entries();
        let mut batch = Batch::default();
        let mut state = self.state();
        let mut forgotten = state.forgettable(&self.limits, now);
        let old = state.find(id);
        let is_same = |old: &Record| {
            let entries = |shards: &[crate::queue::Shard]| shards.iter().map(|shard| shard.entries).collect::<Vec<_>>();
            old.fitter == new.fitter && entries(&old.shards) == entries(&new.shards)
        };
        let kept = old.filter(|old| is_same(&old.record)).map_or(vec![], |old| old.kept.clone());
        if let Some(old) = old {
            forgotten.retain(|submission| *submission != old.record.submission);
            if kept.is_empty() {
                old.remove_results(&mut batch);
            }
        }
        forgotten.iter().filter_map(|submission| state.jobs.get(submission)).for_each(|entry| entry.remove(&mut batch));
        state.last_submission += 1;
        let record = Record {
            job: Job {
                id,
                recipe: new.recipe,
                recipe_digest: new.recipe_digest,
                state: JobState::Queued,
                entries_total,
                entries_done: 0,
                attempts: 0,
                created_at: now,
                started_at: None,
                finished_at: None,
                submitted_by: new.submitted_by,
                cancelled_by: None,
            },
            submission: state.last_submission,
            fitter: new.fitter,
            base: order::base(now.as_microsecond(), state.virtual_time()),
            shards: new.shards,
        };
        drop(state);
        record.put(&mut batch)?;
        self.rows.commit(&batch)?;
        let mut state = self.state();
        for submission in forgotten {
            state.remove(submission);
        }
        let entry = Entry::unfinished(record, &kept);
        let job = entry.job();
        state.insert(entry);
        Ok(job)
    }

    /// Stores the results of shards in one commit.
    pub(super) fn store_results(
        &self,
        _writer: &Writer<'_>,
        done: &[(Lease, Vec<u8>)],
    ) -> Result<Vec<Result<(), StaleLease>>, StoreError> {
        let (mut batch, mut accepted) = (Batch::default(), BTreeSet::new());
        let mut state = self.state();
        let mut answers = Vec::with_capacity(done.len());
        for (lease, result) in done {
            let is_current = matches!(state.current(lease), Ok((TaskKind::Shard(_), _)));
            if let Some(entry) = state.jobs.get(&lease.submission).filter(|_| is_current)
                && accepted.insert((lease.submission, lease.task))
            {
                batch.put(Tree::Results, result_key(entry.record.job.id, lease.task), result.as_slice());
                if !entry.is_stored_as_running {
                    entry.record.put(&mut batch)?;
                }
                answers.push(Ok(()));
            } else {
                answers.push(Err(StaleLease));
            }
        }
        if accepted.is_empty() {
            return Ok(answers);
        }
        drop(state);
        self.rows.commit(&batch)?;
        let mut state = self.state();
        for (submission, shard) in accepted {
            state.finish_shard(submission, shard);
            if let Some(entry) = state.jobs.get_mut(&submission) {
                entry.is_stored_as_running = true;
            }
        }
        Ok(answers)
    }

    /// Ends an unfinished job together with `rows`. Only a failed job keeps its results.
    pub(super) fn end(
        &self,
        _writer: &Writer<'_>,
        submission: u64,
        outcome: JobState,
        cancelled_by: Option<&str>,
        rows: Batch,
    ) -> Result<Job, StoreError> {
        let unknown = || StoreError::Database(format!("submission {submission} is unknown"));
        let state = self.state();
        let entry = state.jobs.get(&submission).ok_or_else(unknown)?;
        let mut record = entry.record.clone();
        let mut job = Job {
            finished_at: Some((self.clock.wall)()),
            cancelled_by: cancelled_by.map(str::to_owned),
            state: outcome,
            ..entry.job()
        };
        if matches!(job.state, JobState::Done { .. }) {
            job.entries_done = job.entries_total;
        }
        let (mut batch, mut kept) = (rows, vec![]);
        if matches!(job.state, JobState::Failed { .. }) {
            kept = entry.finished();
        } else {
            entry.remove_results(&mut batch);
            record.shards = vec![];
        }
        drop(state);
        record.job = job.clone();
        record.put(&mut batch)?;
        self.rows.commit(&batch)?;
        self.state().insert(Entry::ended(record, kept));
        Ok(job)
    }

    /// Stores the failures of doomed jobs.
    pub(super) fn fail_doomed(&self) -> Result<(), StoreError> {
        if self.state().doomed.is_empty() {
            return Ok(());
        }
        let writer = self.writer();
        loop {
            let Some((submission, error)) = self.state().doomed.front().cloned() else { return Ok(()) };
            if self.state().active.contains(&submission) {
                tracing::error!(submission, ?error, "the job failed");
                self.end(&writer, submission, JobState::Failed { error }, None, Batch::default())?;
            }
            self.state().doomed.pop_front();
        }
    }
}
