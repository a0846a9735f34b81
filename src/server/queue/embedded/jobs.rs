//! The queue's state and what all of its operations share.

use std::{
    collections::{BTreeMap, BTreeSet, HashMap, VecDeque},
    sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError},
    thread,
    time::Duration,
};

use jiff::{SignedDuration, Timestamp};

use super::{
    active::ActiveJob,
    record::{self, JobRecord},
    remains::Remains,
    task::TaskState,
};
use crate::{
    queue::{Failure, FailureKind, JobId, JobState, Lease, Limits, MOST_DEATHS, StaleLease, StateName},
    store::{Batch, Rows, StoreError},
};

/// The current time; tests have their own clock.
pub type Clock = Arc<dyn Fn() -> Timestamp + Send + Sync>;

/// Durable jobs, which share the workers evenly.
///
/// The lock is held while a change of a job is written, so that only durable changes can be seen. Results are written
/// without it, and their tasks count as leased meanwhile.
pub struct EmbeddedQueue {
    pub(super) rows: Arc<dyn Rows>,
    pub(super) limits: Limits,
    pub(super) clock: Clock,
    pub(super) state: Mutex<QueueState>,
    pub(super) changed: Condvar,
}

#[derive(Debug, Default)]
pub(super) struct QueueState {
    /// Unfinished jobs by submission.
    pub(super) active: BTreeMap<u64, ActiveJob>,
    pub(super) by_id: HashMap<JobId, u64>,
    pub(super) next_submission: u64,
    /// Leases given so far.
    pub(super) leases: u64,
    /// Until then leases are written to the disk before work begins, see `Queue::lease`.
    pub(super) careful_until: Option<Timestamp>,
    /// Jobs in final states.
    pub(super) concluded: HashMap<StateName, u64>,
    /// Jobs that failed while their row could not be written. Each later commit writes them too.
    pub(super) unsaved: BTreeMap<JobId, JobRecord>,
    /// What ended jobs left behind.
    pub(super) remains: VecDeque<Remains>,
    /// Jobs that changed and whose followers have not been notified.
    pub(super) changed_jobs: BTreeSet<JobId>,
    /// Number of changes so far that may have made a task available.
    pub(super) generation: u64,
    pub(super) closed: bool,
    /// No lease expires before this.
    pub(super) next_expiry: Option<Timestamp>,
    /// Old jobs are looked for no earlier than this.
    pub(super) next_forgetting: Option<Timestamp>,
    pub(super) leases_expired: u64,
    pub(super) failures: u64,
}

impl std::fmt::Debug for EmbeddedQueue {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("EmbeddedQueue").field("limits", &self.limits).finish_non_exhaustive()
    }
}

impl EmbeddedQueue {
    /// The state, after all expired leases have been taken back.
    pub(super) fn lock(&self) -> MutexGuard<'_, QueueState> {
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        self.take_back_expired(&mut state);
        state
    }

    pub(super) fn take_back_expired(&self, state: &mut QueueState) {
        let now = (self.clock)();
        if state.next_expiry.is_none_or(|expiry| now < expiry) {
            return;
        }
        let leases: Vec<_> = state
            .active
            .iter()
            .flat_map(|(submission, active)| {
                active.leases().map(|(task, attempt, until)| (*submission, task, attempt, until))
            })
            .collect();
        state.next_expiry = leases.iter().map(|(.., until)| *until).filter(|until| now < *until).min();
        for (submission, task, attempt, _) in leases.into_iter().filter(|(.., until)| *until <= now) {
            state.leases_expired += 1;
            // An error means that the job has just failed through another of its leases.
            let _ = self.fail_task(state, submission, task, attempt, "the lease expired without being renewed");
        }
    }

    /// Counts a failure of a leased task. Too many failures fail the job.
    pub(super) fn fail_task(
        &self,
        state: &mut QueueState,
        submission: u64,
        task: u32,
        attempt: u32,
        error: &str,
    ) -> Result<(), StaleLease> {
        let active = state.active.get(&submission).ok_or(StaleLease)?;
        let failed = active.tasks.get(task as usize).ok_or(StaleLease)?.fail(attempt, error)?;
        let (failures, _) = failed.failures();
        tracing::warn!(job = %active.record.job.id, task, attempt, failures, error, "a task failed");
        state.failures += 1;
        let reason = format!("failed {failures} times; the last error: {error}");
        let is_last = failures >= self.limits.max_attempts.get();
        self.put_back(state, submission, task, &failed, is_last.then_some(&reason));
        Ok(())
    }

    /// Counts the end of the process that held the lease of a task. Too many of them fail the job.
    pub(super) fn count_death(
        &self,
        state: &mut QueueState,
        submission: u64,
        task: u32,
        attempt: u32,
    ) -> Result<(), StaleLease> {
        let active = state.active.get(&submission).ok_or(StaleLease)?;
        let dead = active.tasks.get(task as usize).ok_or(StaleLease)?.die(attempt)?;
        let deaths = dead.deaths();
        tracing::warn!(job = %active.record.job.id, task, attempt, deaths, "the process ended while the task was leased");
        let reason = format!("was being worked on each of the {deaths} times that the service's process ended");
        self.put_back(state, submission, task, &dead, (deaths >= MOST_DEATHS).then_some(&reason));
        Ok(())
    }

    /// Has a task wait again, or fails its job for a `reason`.
    fn put_back(
        &self,
        state: &mut QueueState,
        submission: u64,
        task: u32,
        waiting: &TaskState,
        reason: Option<&String>,
    ) {
        let Some(active) = state.active.get_mut(&submission) else { return };
        let (id, is_assembly) = (active.record.job.id, task == active.assembly());
        active.set(task, waiting.clone());
        state.record_change(id);
        self.changed.notify_all();
        if let Some(reason) = reason {
            let task = if is_assembly { "the assembly".to_owned() } else { format!("shard {task}") };
            let error = Failure { kind: FailureKind::Attempts, detail: format!("{task} {reason}") };
            self.fail_job(state, submission, error);
        } else {
            let mut batch = Batch::default();
            let stored =
                record::put_task(&mut batch, id, task, waiting).and_then(|()| self.rows.stage(&batch).map(|_| ()));
            if let Err(error) = stored {
                tracing::warn!(job = %id, task, %error, "the failure could not be recorded");
            }
        }
    }

    /// Fails a job. If that cannot be written, it is kept in memory and written with a later change.
    pub(super) fn fail_job(&self, state: &mut QueueState, submission: u64, error: Failure) {
        let Some(active) = state.active.get(&submission) else { return };
        let record = active.concluded(JobState::Failed { error }, (self.clock)());
        tracing::error!(job = %record.job.id, state = ?record.job.state, "the job failed");
        let stored = conclusion(&record).and_then(|(batch, _)| self.commit(state, batch));
        if let Err(error) = stored {
            tracing::warn!(job = %record.job.id, %error, "the failure of the job could not be written yet");
            state.unsaved.insert(record.job.id, record.clone());
        }
        state.conclude(&record, Remains::none(record.job.id));
    }

    /// Commits `batch`, together with the failures that could not be written earlier.
    pub(super) fn commit(&self, state: &mut QueueState, batch: Batch) -> Result<(), StoreError> {
        let mut all = Batch::default();
        for record in state.unsaved.values() {
            all.extend(conclusion(record)?.0);
        }
        all.extend(batch);
        self.rows.commit(&all)?;
        state.unsaved.clear();
        Ok(())
    }

    pub(super) fn wait_for_change(&self, seen: u64) {
        let mut state = self.lock();
        while state.generation == seen && !state.closed && self.remove_some(&mut state) {
            drop(state);
            thread::yield_now();
            state = self.lock();
        }
        while state.generation == seen && !state.closed {
            let now = (self.clock)();
            let left = state.next_expiry.map(|expiry| now.duration_until(expiry).max(SignedDuration::ZERO));
            state = match left.and_then(|left| Duration::try_from(left).ok()) {
                Some(left) => self.changed.wait_timeout(state, left).unwrap_or_else(PoisonError::into_inner).0,
                None => self.changed.wait(state).unwrap_or_else(PoisonError::into_inner),
            };
            self.take_back_expired(&mut state);
        }
    }

    pub(super) fn pause_for(&self, time: Duration) {
        let state = self.lock();
        let waited = self.changed.wait_timeout_while(state, time, |state| !state.closed);
        drop(waited.unwrap_or_else(PoisonError::into_inner));
    }
}

impl QueueState {
    /// The job and the task of a lease, if the lease is the current one.
    pub(super) fn current(&self, lease: &Lease) -> Result<(&ActiveJob, &TaskState), StaleLease> {
        let active = self.active.get(&lease.submission).ok_or(StaleLease)?;
        let task = active.tasks.get(lease.task as usize).ok_or(StaleLease)?;
        match task {
            TaskState::Leased { attempt, .. } if *attempt == lease.attempt => Ok((active, task)),
            _ => Err(StaleLease),
        }
    }

    /// Renews a lease; returns its job.
    pub(super) fn extend(&mut self, lease: &Lease, until: Timestamp) -> Result<&mut ActiveJob, StaleLease> {
        let active = self.active.get_mut(&lease.submission).ok_or(StaleLease)?;
        active.tasks.get_mut(lease.task as usize).ok_or(StaleLease)?.extend(lease.attempt, until)?;
        Ok(active)
    }

    /// Records a change of `job` that may have made a task available. The caller notifies the workers.
    pub(super) fn record_change(&mut self, job: JobId) {
        self.generation += 1;
        self.changed_jobs.insert(job);
    }

    /// Removes a job that has reached a final state from the queue, and has what it leaves removed.
    pub(super) fn conclude(&mut self, record: &JobRecord, remains: Remains) {
        self.leave(remains);
        self.active.remove(&record.submission);
        self.by_id.remove(&record.job.id);
        *self.concluded.entry(record.job.state.name()).or_default() += 1;
        self.record_change(record.job.id);
    }

    /// Stops counting the former record of a job that is submitted again.
    pub(super) fn forget_concluded(&mut self, former: Option<&JobRecord>) {
        if let Some(count) = former.and_then(|former| self.concluded.get_mut(&former.job.state.name())) {
            *count = count.saturating_sub(1);
        }
    }
}

/// The changes that store a job in a final state, and what of it is still to be removed. A failed job keeps its finished
/// shards for the next submission.
pub(super) fn conclusion(record: &JobRecord) -> Result<(Batch, Remains), StoreError> {
    let mut batch = Batch::default();
    record::put_job(&mut batch, record)?;
    if matches!(record.job.state, JobState::Failed { .. }) {
        return Ok((batch, Remains::none(record.job.id)));
    }
    let mut remains = Remains::of(record);
    remains.remove_some(&mut batch);
    Ok((batch, remains))
}
