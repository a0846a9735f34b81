//! Leases: who works on what, for how long, and what becomes of it.

use jiff::Timestamp;

use super::{
    Failure, JobState, Queue, StaleLease,
    jobs::{State, conclusion},
    record,
    step::StepState,
};
use crate::{
    files::digest::Digest,
    server::store::{Batch, StoreError, Tree},
};

/// The right to deliver one step. It names the submission and the attempt: neither a lease that has run out nor one
/// from before the job was submitted again is taken for the current one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Lease {
    pub(super) submission: u64,
    pub(super) step: u32,
    pub(super) attempt: u32,
}

/// What is to be done under a lease.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Step {
    /// Fit this shard, then [`Queue::complete`].
    Shard(u32),
    /// Make the table of all shards' results, then [`Queue::finish`].
    Assemble,
}

/// A leased step.
#[derive(Debug, Clone, PartialEq)]
pub struct Work {
    /// To deliver under.
    pub lease: Lease,
    /// What to do.
    pub step: Step,
    /// The job it belongs to.
    pub job: super::JobId,
    /// The job's recipe.
    pub recipe: String,
    /// Its digest.
    pub recipe_digest: Digest,
}

/// An answer to a worker that asks for work.
#[derive(Debug, Clone, PartialEq)]
pub enum Offer {
    /// A leased step.
    Work(Work),
    /// Nothing to do now: pass `seen` to [`Queue::wait`].
    Nothing {
        /// The state of the queue that was seen.
        seen: u64,
    },
    /// The queue is closed.
    Closed,
}

/// Why a result was not taken.
#[derive(Debug, thiserror::Error)]
pub enum LeaseError {
    /// The lease is not the current one.
    #[error(transparent)]
    Stale(#[from] StaleLease),
    /// It could not be stored; the lease is still held.
    #[error(transparent)]
    Store(#[from] StoreError),
}

impl Queue {
    /// Leases the next step: of the job that was submitted first, its first waiting shard.
    pub fn lease(&self, worker: u32) -> Offer {
        let mut state = self.lock();
        if state.closed {
            return Offer::Closed;
        }
        let now = (self.clock)();
        let until = self.expiry(now);
        let next = state.active.iter().find_map(|(submission, active)| Some((*submission, active.next_waiting()?)));
        let leased = next.and_then(|(submission, step)| {
            let active = state.active.get_mut(&submission)?;
            let leased = active.steps.get(step as usize)?.lease(worker, until).ok()?;
            Some((submission, step, active, leased))
        });
        let Some((submission, step, active, leased)) = leased else {
            return Offer::Nothing { seen: state.generation };
        };
        let mut batch = Batch::default();
        let job = &mut active.record.job;
        let first = job.state == JobState::Queued;
        if first {
            job.state = JobState::Running;
            job.started_at = Some(now);
        }
        let id = job.id;
        let lease = Lease { submission, step, attempt: leased.attempt() };
        active.set(step, leased.clone());
        // A lease ends with the process; its row only serves to count crashes as failures. It is not waited for.
        let mut stored = record::put_step(&mut batch, id, step, &leased);
        if first {
            stored = stored.and_then(|()| record::put_job(&mut batch, &active.record));
        }
        if let Err(error) = stored.and_then(|()| self.rows.stage(&batch)) {
            tracing::warn!(job = %id, step, %error, "the lease was not recorded");
        }
        let work = Work {
            lease,
            step: if step == active.assembly() { Step::Assemble } else { Step::Shard(step) },
            job: id,
            recipe: active.record.job.recipe.clone(),
            recipe_digest: active.record.job.recipe_digest,
        };
        state.next_expiry = Some(state.next_expiry.map_or(until, |expiry| expiry.min(until)));
        state.touched.insert(id);
        Offer::Work(work)
    }

    /// A sign of life: notes the entries done so far and extends the lease. In memory only.
    ///
    /// # Errors
    /// When the lease is not the current one: stop.
    pub fn progress(&self, lease: &Lease, entries_done: u64) -> Result<(), StaleLease> {
        let until = self.expiry((self.clock)());
        let mut state = self.lock();
        let active = state.active.get_mut(&lease.submission).ok_or(StaleLease)?;
        active.steps.get_mut(lease.step as usize).ok_or(StaleLease)?.extend(lease.attempt, until)?;
        active.report(lease.step, entries_done);
        Ok(())
    }

    /// Stores the result of a shard; it is durable when this returns.
    ///
    /// # Errors
    /// When the lease is not the current one, or the result cannot be stored.
    pub fn complete(&self, lease: &Lease, result: &[u8]) -> Result<(), LeaseError> {
        let mut state = self.lock();
        let (active, step) = state.current(lease)?;
        if lease.step == active.assembly() {
            return Err(StaleLease.into());
        }
        let finished = step.finish(lease.attempt)?;
        let id = active.record.job.id;
        let mut batch = Batch::default();
        record::put_step(&mut batch, id, lease.step, &finished)?;
        batch.put(Tree::Results, record::step_key(id, lease.step), result);
        self.commit(&mut state, Ok(batch))?;
        self.set(&mut state, lease, finished);
        Ok(())
    }

    /// The results of all shards, in order, for the holder of the assembling. Where one is lost or damaged its shard
    /// is to be fitted again, the assembling counts as failed, and the answer is `None`.
    ///
    /// # Errors
    /// When the lease is not the current one, or the database fails.
    pub fn results(&self, lease: &Lease) -> Result<Option<Vec<Vec<u8>>>, LeaseError> {
        let id = self.lock().current(lease)?.0.record.job.id;
        let mut results = Vec::with_capacity(lease.step as usize);
        let mut lost = Vec::new();
        for shard in 0..lease.step {
            match self.rows.get(Tree::Results, &record::step_key(id, shard)) {
                Ok(Some(result)) => results.push(result),
                Ok(None) | Err(StoreError::DamagedRow { .. }) => lost.push(shard),
                Err(error) => return Err(error.into()),
            }
        }
        if lost.is_empty() {
            return Ok(Some(results));
        }
        let mut state = self.lock();
        let error = format!("the results of shards {lost:?} are lost or damaged");
        self.fail_step(&mut state, lease.submission, lease.step, lease.attempt, &error)?;
        for shard in lost {
            let waiting = StepState::new();
            let mut batch = Batch::default();
            record::put_step(&mut batch, id, shard, &waiting)?;
            batch.remove(Tree::Results, record::step_key(id, shard));
            self.commit(&mut state, Ok(batch))?;
            self.set(&mut state, &Lease { step: shard, ..*lease }, waiting);
        }
        Ok(None)
    }

    /// Concludes a job whose table is stored; `with` is committed in the same breath.
    ///
    /// # Errors
    /// When the lease is not the current one, or this cannot be stored.
    pub fn finish(&self, lease: &Lease, table: Digest, with: Batch) -> Result<(), LeaseError> {
        let mut state = self.lock();
        let (active, _) = state.current(lease)?;
        if lease.step != active.assembly() {
            return Err(StaleLease.into());
        }
        let record = active.concluded(JobState::Done { table }, (self.clock)());
        let mut batch = with;
        batch.extend(conclusion(&record)?);
        self.commit(&mut state, Ok(batch))?;
        state.conclude(&record);
        self.news.notify_all();
        Ok(())
    }

    /// Gives a step back unfinished, through no fault of its own.
    ///
    /// # Errors
    /// When the lease is not the current one.
    pub fn give_back(&self, lease: &Lease) -> Result<(), StaleLease> {
        let mut state = self.lock();
        let (active, step) = state.current(lease)?;
        let waiting = step.give_back(lease.attempt)?;
        let mut batch = Batch::default();
        let id = active.record.job.id;
        let stored = record::put_step(&mut batch, id, lease.step, &waiting).and_then(|()| self.rows.stage(&batch));
        if let Err(error) = stored {
            tracing::warn!(job = %id, step = lease.step, %error, "that the lease was given back was not recorded");
        }
        self.set(&mut state, lease, waiting);
        Ok(())
    }

    /// Reports that a step failed. It is tried again until its job has no attempts left.
    ///
    /// # Errors
    /// When the lease is not the current one.
    pub fn fail(&self, lease: &Lease, error: &str) -> Result<(), StaleLease> {
        let mut state = self.lock();
        self.fail_step(&mut state, lease.submission, lease.step, lease.attempt, error)
    }

    /// Fails the whole job of a lease: trying again would not help.
    ///
    /// # Errors
    /// When the lease is not the current one.
    pub fn abort(&self, lease: &Lease, error: Failure) -> Result<(), StaleLease> {
        let mut state = self.lock();
        state.current(lease)?;
        self.fail_job(&mut state, lease.submission, error);
        self.news.notify_all();
        Ok(())
    }

    fn set(&self, state: &mut State, lease: &Lease, step: StepState) {
        if let Some(active) = state.active.get_mut(&lease.submission) {
            active.set(lease.step, step);
            let id = active.record.job.id;
            state.wake(id);
        }
        self.news.notify_all();
    }

    fn expiry(&self, now: Timestamp) -> Timestamp {
        now.checked_add(self.limits.lease_ttl).unwrap_or(Timestamp::MAX)
    }
}
