//! What the callers of a queue and the tasks beside them share.

use std::{
    collections::BTreeSet,
    sync::{
        Arc, Condvar, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicU64, Ordering},
    },
    time::{Duration, Instant},
};

use super::held::Held;
use crate::{
    queue::{JobId, Limits},
    store::Database,
};

/// How long a worker waits for a notification before it asks all the same.
const POLL: Duration = Duration::from_secs(1);

/// How often old jobs and what others have left behind are looked for.
const HOUSEKEEPING: Duration = Duration::from_secs(600);

/// How often expired leases are looked for, at most.
const SWEEP: Duration = Duration::from_secs(1);

/// Who uses a queue.
#[derive(Debug, Clone)]
pub struct Process {
    /// Its name in the database, which no other process has.
    pub name: String,
    /// Version of its fitter. It leaves jobs of other versions alone.
    pub fitter: u32,
}

/// What the callers and the tasks beside them share.
pub(super) struct Shared {
    pub(super) database: Arc<Database>,
    pub(super) limits: Limits,
    pub(super) process: Process,
    pub(super) held: Held,
    local: Mutex<Local>,
    changed: Condvar,
    /// How often this process has asked for tasks.
    pub(super) leases_asked: AtomicU64,
    pub(super) leases_expired: AtomicU64,
    pub(super) failures: AtomicU64,
    /// Renewals, sweeps and housekeeping take place at each call: a test's clock does not run by itself.
    is_eager: bool,
    ended: Mutex<bool>,
    ends: Condvar,
}

/// What this process knows of changes.
#[derive(Debug, Default)]
struct Local {
    generation: u64,
    changed_jobs: BTreeSet<JobId>,
    closed: bool,
    swept: Option<Instant>,
    kept_house: Option<Instant>,
}

impl Shared {
    pub(super) fn new(database: Arc<Database>, limits: Limits, process: Process, is_eager: bool) -> Self {
        Self {
            database,
            limits,
            process,
            held: Held::default(),
            local: Mutex::default(),
            changed: Condvar::new(),
            leases_asked: AtomicU64::new(0),
            leases_expired: AtomicU64::new(0),
            failures: AtomicU64::new(0),
            is_eager,
            ended: Mutex::new(false),
            ends: Condvar::new(),
        }
    }

    /// Ends what goes on beside the callers.
    pub(super) fn end(&self) {
        *self.ended.lock().unwrap_or_else(PoisonError::into_inner) = true;
        self.ends.notify_all();
    }

    fn local(&self) -> MutexGuard<'_, Local> {
        self.local.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub(super) fn is_eager(&self) -> bool {
        self.is_eager
    }

    /// Number of changes so far that may have made a task available; `None` once the queue is closed.
    pub(super) fn generation(&self) -> Option<u64> {
        let local = self.local();
        (!local.closed).then_some(local.generation)
    }

    /// Waits; returns whether the queue is still open then.
    pub(super) fn goes_on_after(&self, time: Duration) -> bool {
        let ended = self.ended.lock().unwrap_or_else(PoisonError::into_inner);
        let waited = self.ends.wait_timeout_while(ended, time, |ended| !*ended);
        !*waited.unwrap_or_else(PoisonError::into_inner).0
    }

    /// Records that a job may have changed.
    pub(super) fn note_change(&self, job: Option<JobId>) {
        let mut local = self.local();
        local.generation += 1;
        local.changed_jobs.extend(job);
        self.changed.notify_all();
    }

    pub(super) fn take_changed(&self) -> BTreeSet<JobId> {
        std::mem::take(&mut self.local().changed_jobs)
    }

    pub(super) fn close(&self) {
        self.local().closed = true;
        self.changed.notify_all();
    }

    pub(super) fn wait(&self, seen: u64) {
        let waits = |local: &mut Local| local.generation == seen && !local.closed;
        drop(self.changed.wait_timeout_while(self.local(), POLL, waits).unwrap_or_else(PoisonError::into_inner));
    }

    pub(super) fn pause(&self, time: Duration) {
        let waited = self.changed.wait_timeout_while(self.local(), time, |local| !local.closed);
        drop(waited.unwrap_or_else(PoisonError::into_inner));
    }

    /// Whether expired leases are to be looked for now.
    pub(super) fn sweep_is_due(&self) -> bool {
        let mut local = self.local();
        let is_due = self.is_eager || local.swept.is_none_or(|swept| SWEEP <= swept.elapsed());
        if is_due {
            local.swept = Some(Instant::now());
        }
        is_due
    }

    /// Whether old jobs are to be looked for now.
    pub(super) fn housekeeping_is_due(&self) -> bool {
        let mut local = self.local();
        let is_due = self.is_eager || local.kept_house.is_none_or(|kept| HOUSEKEEPING <= kept.elapsed());
        if is_due {
            local.kept_house = Some(Instant::now());
        }
        is_due
    }

    /// Seconds that a lease lasts.
    pub(super) fn lease_seconds(&self) -> f64 {
        self.limits.lease_ttl.as_secs_f64()
    }

    pub(super) fn count_failures(&self, failed: u64, expired: u64) {
        self.failures.fetch_add(failed, Ordering::Relaxed);
        self.leases_expired.fetch_add(expired, Ordering::Relaxed);
    }
}
