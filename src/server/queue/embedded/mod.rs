//! The queue of one process. All jobs are in memory, and all acknowledged changes are in the database.
//!
//! Invariant: a thread that writes to the database holds `writer`, and locks `state` only before and after the write.
//! During the write only leases change. After a restart, shards without a result wait again.

mod clock;
mod open;
mod record;
mod state;
mod write;

use std::{
    num::NonZeroUsize,
    sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError},
    time::Duration,
};

use super::{
    Job, JobId, JobPage, JobState, Lease, LeaseError, LeasedTask, Limits, NewJob, Queue, QueueError, Release,
    StaleLease, StateName, Statistics, Submitted, TaskKind,
};
use crate::store::{Batch, Rows, StoreError, Tree};
pub(super) use clock::Clock;
use ltcforge_files::digest::Digest;
use record::{TaskState, result_key};
use state::State;

/// A queue that one process keeps in its rows.
#[derive(Debug)]
pub struct EmbeddedQueue {
    rows: Arc<dyn Rows>,
    limits: Limits,
    clock: Clock,
    writer: Mutex<()>,
    state: Mutex<State>,
    /// Notified when a task starts to wait or the queue is closed.
    changed: Condvar,
}

impl EmbeddedQueue {
    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn writer(&self) -> MutexGuard<'_, ()> {
        self.writer.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Stores the failures of doomed jobs. Logs an error if they cannot be stored now.
    fn try_to_fail_doomed(&self) {
        if let Err(error) = self.fail_doomed() {
            tracing::warn!(%error, "could not store that a job failed; trying again later");
        }
    }
}

impl Queue for EmbeddedQueue {
    fn submit(&self, new: NewJob, has_table: &dyn Fn(Digest) -> bool) -> Result<Submitted, QueueError> {
        let writer = self.writer();
        let known = self.state().find(JobId::of_recipe(&new.recipe_digest)).map(record::Entry::job);
        match known {
            Some(job) if !job.state.name().is_final() => return Ok(Submitted::Joined(job)),
            Some(job) => {
                if let JobState::Done { table } = job.state
                    && has_table(table)
                {
                    return Ok(Submitted::Done(job, table));
                }
            }
            None => {}
        }
        if self.state().active.len() >= self.limits.jobs {
            return Err(QueueError::Full(self.limits.jobs));
        }
        let job = self.store_new(&writer, new)?;
        self.changed.notify_all();
        Ok(Submitted::Queued(job))
    }

    fn cancel(&self, id: JobId, by: Option<&str>) -> Result<Option<Job>, StoreError> {
        let writer = self.writer();
        let Some((submission, job)) = self.state().find(id).map(|entry| (entry.record.submission, entry.job())) else {
            return Ok(None);
        };
        if job.state.name().is_final() {
            return Ok(Some(job));
        }
        self.end(&writer, submission, JobState::Cancelled, by, Batch::default()).map(Some)
    }

    fn lease(&self, most: NonZeroUsize) -> Result<Vec<LeasedTask>, StoreError> {
        let (now, steady) = ((self.clock.wall)(), (self.clock.steady)());
        let mut state = self.state();
        if state.is_closed {
            return Ok(vec![]);
        }
        Ok(state.lease(most.get(), steady + self.limits.lease_ttl, now))
    }

    fn renew(&self, leases: &[(Lease, u64)]) -> Result<Vec<Result<(), StaleLease>>, StoreError> {
        let now = (self.clock.steady)();
        let mut state = self.state();
        let renewed = leases.iter().map(|(lease, done)| {
            let (_, task) = state.current(lease)?;
            let (number, until) = (lease.number, now + self.limits.lease_ttl);
            task.state = TaskState::Leased { number, until, entries: *done };
            Ok(())
        });
        let answers = renewed.collect();
        state.put_back_expired(now);
        let is_idle = state.is_idle();
        drop(state);
        if !is_idle {
            self.changed.notify_all();
        }
        self.try_to_fail_doomed();
        Ok(answers)
    }

    fn complete(&self, done: &[(Lease, Vec<u8>)]) -> Result<Vec<Result<(), StaleLease>>, StoreError> {
        let answers = self.store_results(&self.writer(), done)?;
        self.changed.notify_all();
        Ok(answers)
    }

    fn results(&self, lease: &Lease) -> Result<Vec<Vec<u8>>, LeaseError> {
        let (id, shards) = {
            let mut state = self.state();
            let (TaskKind::Assemble, _) = state.current(lease)? else { return Err(StaleLease.into()) };
            let job = state.jobs.get(&lease.submission).map(|entry| entry.record.job.id).ok_or(StaleLease)?;
            (job, lease.task)
        };
        let (mut results, mut lost) = (Vec::with_capacity(shards as usize), vec![]);
        for shard in 0..shards {
            match self.rows.get(Tree::Results, &result_key(id, shard)) {
                Ok(Some(result)) => results.push(result),
                Ok(None) | Err(StoreError::DamagedRow { .. }) => lost.push(shard),
                Err(error) => return Err(error.into()),
            }
        }
        if lost.is_empty() {
            return Ok(results);
        }
        let mut state = self.state();
        state.current(lease)?;
        state.lose(lease.submission, &lost);
        drop(state);
        tracing::warn!(job = %id, ?lost, "results of shards are lost or damaged; they are fitted again");
        self.changed.notify_all();
        Err(LeaseError::Lost(lost.len()))
    }

    fn finish(&self, lease: &Lease, table: Digest, rows: Batch) -> Result<(), LeaseError> {
        let writer = self.writer();
        let (TaskKind::Assemble, _) = self.state().current(lease)? else { return Err(StaleLease.into()) };
        self.end(&writer, lease.submission, JobState::Done { table }, None, rows)?;
        Ok(())
    }

    fn release(&self, lease: &Lease, how: Release) -> Result<(), LeaseError> {
        let mut state = self.state();
        let (_, task) = state.current(lease)?;
        match how {
            Release::GiveBack => {
                task.leases = task.leases.saturating_sub(1);
                state.set(lease.submission, lease.task, TaskState::Waiting);
            }
            Release::Failed(error) => {
                tracing::warn!(?lease, error, "a task failed");
                state.failures.1 += 1;
                state.put_back(lease.submission, lease.task, Some(&error));
            }
            Release::Abort(failure) => {
                state.failures.1 += 1;
                state.doom(lease.submission, lease.task, failure);
            }
        }
        drop(state);
        self.changed.notify_all();
        Ok(self.fail_doomed()?)
    }

    fn job(&self, id: JobId) -> Result<Option<Job>, StoreError> {
        Ok(self.state().find(id).map(record::Entry::job))
    }

    fn job_of_table(&self, table: Digest) -> Result<Option<Job>, StoreError> {
        Ok(self.state().job_of_table(table))
    }

    fn list(&self, wanted: Option<StateName>, before: Option<u64>, limit: usize) -> Result<JobPage, StoreError> {
        Ok(self.state().list(wanted, before, limit))
    }

    fn statistics(&self) -> Result<Statistics, StoreError> {
        Ok(self.state().statistics())
    }

    fn failures(&self) -> (u64, u64) {
        self.state().failures
    }

    fn wait(&self, most: Duration) -> bool {
        let is_idle = |state: &mut State| !state.is_closed && state.is_idle();
        let waited = self.changed.wait_timeout_while(self.state(), most, is_idle);
        !waited.unwrap_or_else(PoisonError::into_inner).0.is_closed
    }

    fn close(&self) {
        self.state().is_closed = true;
        self.changed.notify_all();
    }
}
