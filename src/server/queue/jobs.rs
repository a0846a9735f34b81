//! The queue's state, and what all of its operations share.

use std::{
    collections::{BTreeMap, BTreeSet, HashMap},
    num::NonZeroU32,
    sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError},
    time::Duration,
};

use jiff::{SignedDuration, Timestamp};

use super::{
    Failure, FailureKind, JobId, JobState, Lease, StaleLease, StateName,
    active::Active,
    record::{self, JobRecord},
    step::StepState,
};
use crate::server::store::{Batch, Rows, StoreError};

/// Tells the time; tests bring their own.
pub type Clock = Arc<dyn Fn() -> Timestamp + Send + Sync>;

/// Bounds of a queue.
#[derive(Debug, Clone, Copy)]
pub struct Limits {
    /// Jobs that may wait or run at the same time.
    pub jobs: usize,
    /// How long a lease lasts without a sign of life.
    pub lease_ttl: Duration,
    /// How often a step may fail before its job does.
    pub max_attempts: NonZeroU32,
}

/// Why a job was not taken.
#[derive(Debug, thiserror::Error)]
pub enum QueueError {
    /// Too many jobs wait or run.
    #[error("the queue is full: {limit} jobs are waiting or running")]
    Full {
        /// The limit.
        limit: usize,
    },
    /// It could not be stored.
    #[error(transparent)]
    Store(#[from] StoreError),
}

/// Durable jobs in the order of their submission.
///
/// The lock is held while a change is written: what anyone sees of a job is durable.
pub struct Queue {
    pub(super) rows: Arc<dyn Rows>,
    pub(super) limits: Limits,
    pub(super) clock: Clock,
    pub(super) state: Mutex<State>,
    pub(super) news: Condvar,
}

#[derive(Debug, Default)]
pub(super) struct State {
    /// Unfinished jobs by submission: the first has the right of way.
    pub(super) active: BTreeMap<u64, Active>,
    pub(super) by_id: HashMap<JobId, u64>,
    pub(super) next_submission: u64,
    /// Jobs in final states.
    pub(super) concluded: HashMap<StateName, u64>,
    /// Jobs that failed while their row could not be written; each later commit tries again.
    pub(super) unsaved: BTreeMap<JobId, JobRecord>,
    /// Jobs whose state changed and whose watchers have not been told.
    pub(super) touched: BTreeSet<JobId>,
    /// Counts the changes that may give a waiting worker something to do.
    pub(super) generation: u64,
    pub(super) closed: bool,
    /// No lease expires before this.
    pub(super) next_expiry: Option<Timestamp>,
    pub(super) leases_expired: u64,
    pub(super) failures: u64,
}

impl std::fmt::Debug for Queue {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Queue").field("limits", &self.limits).finish_non_exhaustive()
    }
}

impl Queue {
    /// The state with all leases that have run out taken back.
    pub(super) fn lock(&self) -> MutexGuard<'_, State> {
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        self.take_back_expired(&mut state);
        state
    }

    fn take_back_expired(&self, state: &mut State) {
        let now = (self.clock)();
        if state.next_expiry.is_none_or(|expiry| now < expiry) {
            return;
        }
        let leases: Vec<_> = state
            .active
            .iter()
            .flat_map(|(submission, active)| {
                active.leases().map(|(step, attempt, until)| (*submission, step, attempt, until))
            })
            .collect();
        state.next_expiry = leases.iter().map(|(.., until)| *until).filter(|until| now < *until).min();
        for (submission, step, attempt, _) in leases.into_iter().filter(|(.., until)| *until <= now) {
            state.leases_expired += 1;
            // The job may just have failed with another of its leases; then there is nothing left to fail.
            let _ = self.fail_step(state, submission, step, attempt, "the lease expired without a sign of life");
        }
    }

    /// Counts a failure of a leased step; too many fail the job.
    pub(super) fn fail_step(
        &self,
        state: &mut State,
        submission: u64,
        step: u32,
        attempt: u32,
        error: &str,
    ) -> Result<(), StaleLease> {
        let active = state.active.get_mut(&submission).ok_or(StaleLease)?;
        let failed = active.steps.get(step as usize).ok_or(StaleLease)?.fail(attempt, error)?;
        let (failures, _) = failed.failures();
        let (id, is_assembly) = (active.record.job.id, step == active.assembly());
        tracing::warn!(job = %id, step, attempt, failures, error, "a step failed");
        active.set(step, failed.clone());
        state.failures += 1;
        state.wake(id);
        self.news.notify_all();
        if failures >= self.limits.max_attempts.get() {
            let step = if is_assembly { "assembling".to_owned() } else { format!("shard {step}") };
            let detail = format!("{step} failed {failures} times; the last error: {error}");
            let error = Failure { kind: FailureKind::Attempts, detail };
            self.fail_job(state, submission, error);
        } else {
            let mut batch = Batch::default();
            let stored = record::put_step(&mut batch, id, step, &failed).and_then(|()| self.rows.stage(&batch));
            if let Err(error) = stored {
                tracing::warn!(job = %id, step, %error, "the failure was not recorded");
            }
        }
        Ok(())
    }

    /// Fails a job. When that cannot be written it holds in memory, and is written with a later change.
    pub(super) fn fail_job(&self, state: &mut State, submission: u64, error: Failure) {
        let Some(active) = state.active.get(&submission) else { return };
        let record = active.concluded(JobState::Failed { error }, (self.clock)());
        tracing::error!(job = %record.job.id, state = ?record.job.state, "the job failed");
        if let Err(error) = self.commit(state, conclusion(&record)) {
            tracing::warn!(job = %record.job.id, %error, "the failure of the job is not on the disk yet");
            state.unsaved.insert(record.job.id, record.clone());
        }
        state.conclude(&record);
    }

    /// Commits `batch`, and with it what could not be written earlier.
    pub(super) fn commit(&self, state: &mut State, batch: Result<Batch, StoreError>) -> Result<(), StoreError> {
        let mut batch = batch?;
        let mut all = Batch::default();
        for record in state.unsaved.values() {
            all.extend(conclusion(record)?);
        }
        all.extend(std::mem::take(&mut batch));
        self.rows.commit(&all)?;
        state.unsaved.clear();
        Ok(())
    }

    /// Waits until there may be something new to lease since [`super::Offer::Nothing`] was `seen`, a lease runs out,
    /// or the queue is closed.
    pub fn wait(&self, seen: u64) {
        let mut state = self.lock();
        while state.generation == seen && !state.closed {
            let now = (self.clock)();
            let left = state.next_expiry.map(|expiry| now.duration_until(expiry).max(SignedDuration::ZERO));
            state = match left.and_then(|left| Duration::try_from(left).ok()) {
                Some(left) => self.news.wait_timeout(state, left).unwrap_or_else(PoisonError::into_inner).0,
                None => self.news.wait(state).unwrap_or_else(PoisonError::into_inner),
            };
            self.take_back_expired(&mut state);
        }
    }

    /// Offers no more work and wakes all who wait for some. Leases may still be completed or given back.
    pub fn close(&self) {
        let mut state = self.lock();
        state.closed = true;
        self.news.notify_all();
    }

    /// Jobs whose state or progress has changed since the last call.
    pub fn take_touched(&self) -> BTreeSet<JobId> {
        std::mem::take(&mut self.lock().touched)
    }
}

impl State {
    /// The job and the step of a lease, if it is the current one.
    pub(super) fn current(&self, lease: &Lease) -> Result<(&Active, &StepState), StaleLease> {
        let active = self.active.get(&lease.submission).ok_or(StaleLease)?;
        let step = active.steps.get(lease.step as usize).ok_or(StaleLease)?;
        match step {
            StepState::Leased { attempt, .. } if *attempt == lease.attempt => Ok((active, step)),
            _ => Err(StaleLease),
        }
    }

    /// Notes a change of `job` that may give a worker something to do. The caller notifies.
    pub(super) fn wake(&mut self, job: JobId) {
        self.generation += 1;
        self.touched.insert(job);
    }

    /// Takes a job that has reached a final state out of the queue.
    pub(super) fn conclude(&mut self, record: &JobRecord) {
        self.active.remove(&record.submission);
        self.by_id.remove(&record.job.id);
        *self.concluded.entry(record.job.state.name()).or_default() += 1;
        self.wake(record.job.id);
    }

    /// Counts a job no more that is submitted again.
    pub(super) fn forget_concluded(&mut self, former: Option<&JobRecord>) {
        if let Some(count) = former.and_then(|former| self.concluded.get_mut(&former.job.state.name())) {
            *count = count.saturating_sub(1);
        }
    }
}

/// The rows of a job in a final state. Finished shards are kept for the next submission where the job failed.
pub(super) fn conclusion(record: &JobRecord) -> Result<Batch, StoreError> {
    let mut batch = Batch::default();
    record::put_job(&mut batch, record)?;
    if !matches!(record.job.state, JobState::Failed { .. }) {
        record::remove_steps(&mut batch, record);
    }
    Ok(batch)
}
