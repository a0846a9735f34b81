//! The queue's state, and the helpers that all of its operations share.

use std::{
    collections::{BTreeMap, BTreeSet, HashMap, VecDeque},
    ops::Range,
    sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError},
    thread,
    time::{Duration, Instant},
};

use jiff::Timestamp;

use super::{
    active::ActiveJob,
    record::{self, JobRecord},
    task::{Task, TaskState},
    teams::{ActiveJobs, Teams},
};
use crate::{
    queue::{Job, JobId, JobState, Lease, Limits, StaleLease},
    store::{Batch, Rows, StoreError},
};

/// The clocks of a queue; tests have their own.
#[derive(Clone)]
pub struct Clock {
    /// The time of the day, as jobs have it. Somebody may set it at any time, ahead or back.
    pub wall: Arc<dyn Fn() -> Timestamp + Send + Sync>,
    /// The time since some beginning, by which leases expire: nobody sets it, and it stands still while the machine is
    /// suspended.
    pub steady: Arc<dyn Fn() -> Duration + Send + Sync>,
}

impl Clock {
    /// The clocks of this machine.
    #[must_use]
    pub fn system() -> Self {
        let began = Instant::now();
        Self { wall: Arc::new(Timestamp::now), steady: Arc::new(move || began.elapsed()) }
    }
}

/// Durable jobs, which share the workers.
///
/// The lock is held while a change of a job is written, so that only durable changes can be seen. Results are written
/// without it, and their tasks count as leased meanwhile.
pub struct EmbeddedQueue {
    pub(super) rows: Arc<dyn Rows>,
    pub(super) limits: Limits,
    pub(super) clock: Clock,
    pub(super) first_name: u64,
    pub(super) state: Mutex<QueueState>,
    pub(super) changed: Condvar,
}

#[derive(Debug, Default)]
pub(super) struct QueueState {
    /// Unfinished jobs by submission.
    pub(super) active: ActiveJobs,
    /// Teams that had jobs since the queue was opened.
    pub(super) teams: Teams,
    /// Jobs in final states by submission.
    pub(super) ended: BTreeMap<u64, JobRecord>,
    /// The submission of each job.
    pub(super) by_id: HashMap<JobId, u64>,
    pub(super) next_submission: u64,
    /// Leases given so far. Their names are counted from [`EmbeddedQueue::first_name`] on.
    pub(super) leases: u64,
    /// Until then leases are written to the disk before work begins, see `Queue::lease`.
    pub(super) careful_until: Option<Duration>,
    /// Submissions that failed while their job could not be written. Each later commit writes it too.
    pub(super) unsaved: BTreeSet<u64>,
    /// Tasks of ended jobs whose rows may still be stored.
    pub(super) leftovers: VecDeque<(JobId, Range<u32>)>,
    /// Jobs that changed and whose followers have not been notified.
    pub(super) changed_jobs: BTreeSet<JobId>,
    /// Number of changes so far that may have made a task available.
    pub(super) generation: u64,
    pub(super) closed: bool,
    /// No lease expires before this.
    pub(super) next_expiry: Option<Duration>,
    /// Old jobs are looked for no earlier than this.
    pub(super) next_forgetting: Option<Duration>,
    /// The time of the day when they were last looked for; at the start the latest that a job has.
    pub(super) last_seen: Timestamp,
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

    /// Commits `batch`, together with the failures that could not be written earlier.
    pub(super) fn commit(&self, state: &mut QueueState, batch: Batch) -> Result<(), StoreError> {
        let mut all = Batch::default();
        for record in state.unsaved.iter().filter_map(|submission| state.ended.get(submission)) {
            record::put_job(&mut all, record)?;
        }
        all.extend(batch);
        self.rows.commit(&all)?;
        state.unsaved.clear();
        Ok(())
    }

    /// Commits the end of a job together with `batch`.
    pub(super) fn conclude(&self, state: &mut QueueState, record: JobRecord, batch: Batch) -> Result<(), StoreError> {
        let mut batch = batch;
        record::put_job(&mut batch, &record)?;
        self.commit(state, batch)?;
        self.end(state, record);
        Ok(())
    }

    /// Moves a job to those that have ended, and begins to remove the rows of its tasks.
    pub(super) fn end(&self, state: &mut QueueState, record: JobRecord) {
        let (id, submission) = (record.job.id, record.submission);
        // A failed job keeps its finished shards for the next submission.
        if !matches!(record.job.state, JobState::Failed { .. }) {
            state.leftovers.push_back((id, record.tasks()));
        }
        state.active.remove(&submission);
        state.by_id.insert(id, submission);
        state.ended.insert(submission, record);
        state.record_change(id);
        self.remove_leftovers(state);
        self.changed.notify_all();
    }

    /// Sets a leased task.
    pub(super) fn set(&self, state: &mut QueueState, lease: &Lease, task: Task) {
        if let Some(active) = state.active.get_mut(&lease.submission) {
            active.set(lease.task, task);
            let id = active.record.job.id;
            state.record_change(id);
        }
        self.changed.notify_all();
    }

    pub(super) fn wait_for_change(&self, seen: u64) {
        let mut state = self.lock();
        while state.generation == seen && !state.closed && self.remove_leftovers(&mut state) {
            drop(state);
            thread::yield_now();
            state = self.lock();
        }
        while state.generation == seen && !state.closed {
            let left = state.next_expiry.map(|expiry| expiry.saturating_sub((self.clock.steady)()));
            state = match left {
                Some(left) => self.changed.wait_timeout(state, left).unwrap_or_else(PoisonError::into_inner).0,
                None => self.changed.wait(state).unwrap_or_else(PoisonError::into_inner),
            };
            self.take_back_expired(&mut state);
        }
    }
}

impl QueueState {
    /// Adds an unfinished job.
    pub(super) fn activate(&mut self, submission: u64, active: ActiveJob) {
        self.teams.join(active.claim(), &self.active);
        self.active.insert(submission, active);
    }

    /// A queued or running job.
    pub(super) fn active_job(&self, id: JobId) -> Option<&ActiveJob> {
        self.active.get(self.by_id.get(&id)?)
    }

    /// A job in a final state.
    pub(super) fn ended_job(&self, id: JobId) -> Option<&JobRecord> {
        self.ended.get(self.by_id.get(&id)?)
    }

    /// A job.
    pub(super) fn job(&self, id: JobId) -> Option<Job> {
        self.active_job(id).map(ActiveJob::job).or_else(|| Some(self.ended_job(id)?.job.clone()))
    }

    /// The job and the task of a lease, if the lease is the current one.
    pub(super) fn current(&self, lease: &Lease) -> Result<(&ActiveJob, Task), StaleLease> {
        let active = self.active.get(&lease.submission).ok_or(StaleLease)?;
        match active.tasks.get(lease.task as usize) {
            Some(task) if matches!(task.state, TaskState::Leased { name, .. } if name == lease.name) => {
                Ok((active, *task))
            }
            _ => Err(StaleLease),
        }
    }

    /// Renews a lease; returns its job.
    pub(super) fn renew(&mut self, lease: &Lease, until: Duration) -> Result<&mut ActiveJob, StaleLease> {
        self.current(lease)?;
        let active = self.active.get_mut(&lease.submission).ok_or(StaleLease)?;
        active.tasks.get_mut(lease.task as usize).ok_or(StaleLease)?.state =
            TaskState::Leased { until, name: lease.name };
        Ok(active)
    }

    /// Records a change of `job` that may have made a task available. The caller notifies the workers.
    pub(super) fn record_change(&mut self, job: JobId) {
        self.generation += 1;
        self.changed_jobs.insert(job);
    }

    /// Forgets a job that has ended.
    pub(super) fn forget(&mut self, id: JobId) {
        if let Some(submission) = self.by_id.remove(&id) {
            self.ended.remove(&submission);
            self.unsaved.remove(&submission);
        }
    }
}
