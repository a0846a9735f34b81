//! The loop of a worker: lease a task, do it, store the result.

use std::{
    any::Any,
    ops::ControlFlow,
    panic::{AssertUnwindSafe, catch_unwind},
    sync::atomic::Ordering,
    time::{Duration, Instant},
};

use super::{TableRow, state::ServiceState};
use crate::server::{
    queue::{Failure, FailureKind, LeaseError, LeasedTask, Offer, StaleLease, TaskKind},
    store::{Catalogue, StoreError},
};

/// Why a task was not delivered.
#[derive(Debug, thiserror::Error)]
enum TaskError {
    /// The lease is not the current one.
    #[error(transparent)]
    Stale(#[from] StaleLease),
    /// The task itself failed and is tried again.
    #[error("{0}")]
    Failed(String),
    /// The store failed. Another attempt helps only where [`StoreError::is_passing`].
    #[error(transparent)]
    Store(#[from] StoreError),
}

impl From<LeaseError> for TaskError {
    fn from(error: LeaseError) -> Self {
        match error {
            LeaseError::Stale(error) => Self::Stale(error),
            LeaseError::Store(error) => Self::Store(error),
        }
    }
}

/// How long a worker is on a task before it may lend itself to another job.
const SLICE: Duration = Duration::from_millis(100);

/// How long a worker waits after an error that passes, such as a lack of file descriptors.
const RETRY: Duration = Duration::from_secs(1);

/// Tasks that a worker may be in the middle of when it turns to a job that was served before, and to a new one.
const DEEPEST: u32 = 4;
const DEEPEST_FOR_NEW: u32 = 32;

/// A worker in the middle of tasks: it may turn from the last one to a job that no worker works for.
#[derive(Clone, Copy)]
struct Worker<'a> {
    number: u32,
    /// Tasks that wait while it does another.
    depth: u32,
    /// Renews the leases of those tasks.
    renew: &'a (dyn Fn() + Sync),
}

/// The time of a worker on one task: its own, and that lent to tasks of other jobs.
struct TimeShare {
    since: Instant,
    /// Length of the last task of another job.
    lent_last: Duration,
    lent: Duration,
}

impl TimeShare {
    fn begin() -> Self {
        Self { since: Instant::now(), lent_last: Duration::ZERO, lent: Duration::ZERO }
    }
}

impl ServiceState {
    /// Does tasks until the queue is closed.
    pub(super) fn work(&self, number: u32) {
        loop {
            match self.queue.lease(number) {
                Offer::Task(task) => {
                    self.publish_changes();
                    self.deliver(&task, Worker { number, depth: 1, renew: &|| () });
                }
                Offer::Nothing { seen } => self.queue.wait(seen),
                Offer::Closed => return,
            }
            self.publish_changes();
        }
    }

    /// Does a leased task. A failure ends the task or the job, never the service.
    fn deliver(&self, task: &LeasedTask, worker: Worker<'_>) {
        let done = catch_unwind(AssertUnwindSafe(|| match task.kind {
            TaskKind::Shard(shard) => self.fit(task, shard, worker),
            TaskKind::Assemble => self.assemble(task, worker),
        }));
        let error = match done {
            Ok(Ok(())) => return,
            Ok(Err(error)) => error,
            Err(panic) => TaskError::Failed(format!("panic: {}", panic_text(panic.as_ref()))),
        };
        let reported = match error {
            TaskError::Stale(error) => Err(error),
            TaskError::Failed(error) => self.queue.fail(&task.lease, &error),
            TaskError::Store(error) if error.is_passing() => {
                tracing::warn!(job = %task.job, task = ?task.kind, %error, "the task is tried again");
                let given_back = self.queue.give_back(&task.lease);
                self.queue.pause(RETRY);
                given_back
            }
            TaskError::Store(error) => {
                let kind = match error {
                    StoreError::DiskFull => FailureKind::DiskFull,
                    _ => FailureKind::Storage,
                };
                self.queue.abort(&task.lease, Failure { kind, detail: error.to_string() })
            }
        };
        if let Err(StaleLease) = reported {
            tracing::debug!(job = %task.job, task = ?task.kind, "the lease was no longer current when the task ended");
        }
    }

    fn fit(&self, task: &LeasedTask, shard: u32, worker: Worker<'_>) -> Result<(), TaskError> {
        let mut fitted = 0;
        let mut share = TimeShare::begin();
        let started = Instant::now();
        let mut on_progress = |done: u64| {
            self.entries_fitted.fetch_add(done.saturating_sub(fitted), Ordering::Relaxed);
            fitted = done;
            (worker.renew)();
            if self.is_stopping() || self.queue.progress(&task.lease, done).is_err() {
                return ControlFlow::Break(());
            }
            if self.hub.is_watched(task.job) {
                self.publish(task.job);
            }
            self.lend(task, done, worker, &mut share);
            ControlFlow::Continue(())
        };
        match self.engine.fit_shard(&task.recipe, shard, &mut on_progress).map_err(TaskError::Failed)? {
            Some(result) => {
                let seconds = started.elapsed().saturating_sub(share.lent).as_secs_f64();
                // Without the job's row the forecast learns nothing.
                if let Ok(Some(job)) = self.queue.job(task.job) {
                    self.forecast.learn(&task.recipe, fitted as f64 / job.entries_total as f64, seconds);
                }
                self.complete(task, &result, worker)?;
            }
            None => self.queue.give_back(&task.lease)?,
        }
        Ok(())
    }

    /// Stores a shard's result. An error that passes is waited out, because the shard may have taken minutes.
    fn complete(&self, task: &LeasedTask, result: &[u8], worker: Worker<'_>) -> Result<(), LeaseError> {
        loop {
            match self.queue.complete(&task.lease, result) {
                Err(LeaseError::Store(error)) if error.is_passing() && !self.is_stopping() => {
                    tracing::warn!(job = %task.job, task = ?task.kind, %error, "the result is stored again");
                    self.queue.pause(RETRY);
                    (worker.renew)();
                    self.queue.progress(&task.lease, 0)?;
                }
                done => return done,
            }
        }
    }

    /// Does a task of a job that no worker works for, in the middle of `task`, of which `done` entries are fitted: a
    /// shard may take minutes, and nothing of it would be left if it were given back. A new job is served at once, any
    /// other when `task` has had as long as the last one.
    fn lend(&self, task: &LeasedTask, done: u64, worker: Worker<'_>, share: &mut TimeShare) {
        let own = share.since.elapsed();
        if own < SLICE || worker.depth >= DEEPEST_FOR_NEW {
            return;
        }
        let newcomers = own < share.lent_last || worker.depth >= DEEPEST;
        let Some(other) = self.queue.lease_unserved(worker.number, &task.lease, newcomers) else { return };
        self.publish_changes();
        let begun = Instant::now();
        let renew = || {
            (worker.renew)();
            // If the lease has ended, the task hears of it at its next entry.
            let _ = self.queue.progress(&task.lease, done);
        };
        self.deliver(&other, Worker { number: worker.number, depth: worker.depth + 1, renew: &renew });
        self.publish_changes();
        share.lent_last = begun.elapsed();
        share.lent += share.lent_last;
        share.since = Instant::now();
    }

    fn assemble(&self, task: &LeasedTask, worker: Worker<'_>) -> Result<(), TaskError> {
        let Some(results) = self.queue.results(&task.lease)? else { return Ok(()) };
        let file = self.engine.assemble(&task.recipe, results).map_err(TaskError::Failed)?;
        // The lease ends with a cancelled job. Until then it is renewed: a table may take long to measure.
        let go_on = || {
            (worker.renew)();
            !self.is_stopping() && self.queue.progress(&task.lease, 0).is_ok()
        };
        let manifest = self.make_manifest(&file, &go_on).map_err(|error| TaskError::Failed(error.to_string()))?;
        let Some(manifest) = manifest else {
            self.queue.give_back(&task.lease)?;
            return Ok(());
        };
        let digest = self.tables.store.blobs.put(&file)?;
        let row = TableRow {
            digest,
            recipe_digest: task.recipe_digest,
            bytes: file.len() as u64,
            created_at: (self.clock)(),
        };
        let mut batch = Catalogue::entry(&row, &task.recipe)?;
        batch.extend(Catalogue::manifest_entry(digest, &manifest)?);
        self.queue.finish(&task.lease, digest, batch)?;
        tracing::info!(job = %task.job, table = %digest, bytes = row.bytes, "the table is stored");
        Ok(())
    }
}

/// The message of a panic.
fn panic_text(panic: &(dyn Any + Send)) -> &str {
    panic
        .downcast_ref::<&str>()
        .copied()
        .or_else(|| panic.downcast_ref::<String>().map(String::as_str))
        .unwrap_or("without a message")
}
