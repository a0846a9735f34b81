//! The loops of the workers: lease a task, do it; store the results; keep the leases meanwhile.

use std::{
    any::Any,
    iter, mem,
    ops::ControlFlow,
    panic::{AssertUnwindSafe, catch_unwind},
    slice,
    sync::{
        Arc, PoisonError,
        atomic::Ordering,
        mpsc::{Receiver, SyncSender},
    },
    time::{Duration, Instant},
};

use super::{
    TableRow,
    backend::{PlanError, PlannedFit},
    state::ServiceState,
    uses::UseRow,
};
use crate::{
    queue::{Failure, FailureKind, Lease, LeaseError, LeasedTask, StaleLease, TaskKind},
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

impl From<PlanError> for TaskError {
    fn from(error: PlanError) -> Self {
        match error {
            PlanError::Failed(error) => Self::Failed(error),
            PlanError::Store(error) => Self::Store(error),
        }
    }
}

/// How long to wait after an error that passes, such as a lack of file descriptors.
const RETRY: Duration = Duration::from_secs(1);

/// How often a worker reports its progress, at most. A queue that is writing holds it up meanwhile.
const REPORT: Duration = Duration::from_millis(20);

/// How often the leases that no worker renews are looked at, or four times within their duration if that is more often.
const KEEP: Duration = Duration::from_millis(500);

/// Results that wait to be stored, at most; workers then wait. As many are stored in one transaction.
pub(super) const MOST_RESULTS: usize = 64;

/// The result of a shard, on its way to the queue.
pub(super) struct ShardResult {
    task: LeasedTask,
    bytes: Vec<u8>,
}

impl ServiceState {
    /// Does tasks until the queue is closed.
    pub(super) fn work(&self, results: &SyncSender<ShardResult>) {
        while let Some(task) = self.scheduler.next(self.queue.as_ref()) {
            self.publish_changes();
            self.attempt(&task, || match task.kind {
                _ if self.is_stopping() => Ok(self.queue.give_back(&task.lease)?),
                TaskKind::Shard(shard) => self.fit(&task, shard, results),
                TaskKind::Assemble => self.assemble(&task),
            });
            self.scheduler.end(&task.lease);
            self.publish_changes();
        }
        self.give_back_overdue(Duration::ZERO);
    }

    /// Stores the results of shards as they come; those that come while others are being stored are stored together.
    pub(super) fn store_results(&self, results: &Receiver<ShardResult>) {
        while let Ok(first) = results.recv() {
            let together: Vec<_> = iter::once(first).chain(results.try_iter().take(MOST_RESULTS - 1)).collect();
            self.store_together(&together);
            self.publish_changes();
            self.scheduler.wake();
        }
    }

    /// Keeps the leases of tasks that no thread works on until the service is stopping: tasks that wait too long for a
    /// worker are given back, and leases whose results are being stored are renewed.
    pub(super) fn keep_leases(&self) {
        let every = KEEP.min(self.config.lease_ttl / 4);
        while !self.is_stopping() {
            self.queue.pause(every);
            self.give_back_overdue(every);
            for (lease, entries) in self.scheduler.all_storing() {
                if self.queue.progress(&lease, entries).is_err() {
                    self.scheduler.stored(&lease);
                }
            }
        }
    }

    fn give_back_overdue(&self, time: Duration) {
        for task in self.scheduler.overdue(time) {
            self.attempt(&task, || Ok(self.queue.give_back(&task.lease)?));
            self.scheduler.wake();
        }
    }

    /// Does work on a leased task. A failure ends the task or the job, never the service.
    fn attempt(&self, task: &LeasedTask, work: impl FnOnce() -> Result<(), TaskError>) {
        let error = match catch_unwind(AssertUnwindSafe(work)) {
            Ok(Ok(())) => return,
            Ok(Err(error)) => error,
            Err(panic) => TaskError::Failed(format!("panic: {}", panic_text(panic.as_ref()))),
        };
        let reported = match error {
            TaskError::Stale(error) => Err(error),
            TaskError::Failed(error) => self.queue.fail(&task.lease, &error),
            // Credentials may have run out on this host alone, and be good on another or later.
            TaskError::Store(error) if error.is_passing() || matches!(error, StoreError::Refused(_)) => {
                tracing::warn!(job = %task.job, task = ?task.kind, %error, "the task is tried again");
                let given_back = self.queue.give_back(&task.lease);
                self.queue.pause(RETRY);
                given_back
            }
            TaskError::Store(error) => {
                self.queue.abort(&task.lease, Failure { kind: FailureKind::Storage, detail: error.to_string() })
            }
        };
        if let Err(StaleLease) = reported {
            tracing::debug!(job = %task.job, task = ?task.kind, "the lease was no longer current when the task ended");
        }
    }

    fn fit(&self, task: &LeasedTask, shard: u32, results: &SyncSender<ShardResult>) -> Result<(), TaskError> {
        // It may have waited, and its job may have ended meanwhile.
        self.queue.progress(&task.lease, 0)?;
        let plan = self.load(task)?;
        self.scheduler.stored(&task.lease);
        let (mut fitted, mut seconds, mut reported) = (0, 0.0, Instant::now());
        let mut on_progress = |done: u64| {
            self.entries_fitted.fetch_add(done.saturating_sub(fitted), Ordering::Relaxed);
            fitted = done;
            if self.is_stopping() {
                return ControlFlow::Break(());
            }
            if reported.elapsed() < REPORT {
                return ControlFlow::Continue(());
            }
            seconds += self.scheduler.share() * reported.elapsed().as_secs_f64();
            reported = Instant::now();
            if self.queue.progress(&task.lease, done).is_err() {
                return ControlFlow::Break(());
            }
            // The follower of a shared queue looks at its jobs now and then.
            if self.queue.is_local() && self.hub.is_watched(task.job) {
                self.publish(task.job);
            }
            ControlFlow::Continue(())
        };
        let Some(bytes) = plan.fit_shard(shard, &mut on_progress) else {
            return Ok(self.queue.give_back(&task.lease)?);
        };
        seconds += self.scheduler.share() * reported.elapsed().as_secs_f64();
        self.forecast.learn(task.into(), fitted as f64 / task.entries_total as f64, seconds);
        self.scheduler.storing(task.lease, fitted);
        let sent = results.send(ShardResult { task: task.clone(), bytes });
        sent.map_err(|_| TaskError::Failed("the thread that stores results has ended".to_owned()))
    }

    fn store_together(&self, results: &[ShardResult]) {
        let done: Vec<(Lease, &[u8])> =
            results.iter().map(|result| (result.task.lease, result.bytes.as_slice())).collect();
        match catch_unwind(AssertUnwindSafe(|| self.queue.complete(&done))) {
            Ok(Ok(answers)) => {
                for (result, answer) in results.iter().zip(answers) {
                    self.attempt(&result.task, || Ok(answer?));
                }
            }
            Ok(Err(_)) | Err(_) => results.iter().for_each(|result| self.store_alone(result)),
        }
    }

    /// Stores a result that could not be stored with others: one of them may have been the reason. An error that passes
    /// is waited out, because the shard may have taken minutes.
    fn store_alone(&self, result: &ShardResult) {
        let ShardResult { task, bytes } = result;
        if self.is_stopping() && self.queue.fault().is_some() {
            // Its lease will expire.
            return;
        }
        self.attempt(task, || {
            let stored =
                self.retried(task, || self.queue.complete(slice::from_ref(&(task.lease, bytes.as_slice()))))?;
            Ok(stored.into_iter().next().unwrap_or(Err(StaleLease))?)
        });
    }

    /// Stores a result that may have taken minutes to make, and tries again while the error is a passing one.
    fn retried<T, E: Into<TaskError>>(
        &self,
        task: &LeasedTask,
        store: impl Fn() -> Result<T, E>,
    ) -> Result<T, TaskError> {
        let mut is_told = false;
        loop {
            match store().map_err(Into::into) {
                Err(TaskError::Store(error)) if error.is_passing() && !self.is_stopping() => {
                    if !mem::replace(&mut is_told, true) {
                        tracing::warn!(job = %task.job, task = ?task.kind, %error, "storing the result is tried again");
                    }
                    self.queue.pause(RETRY);
                    self.queue.progress(&task.lease, 0)?;
                }
                done => return done,
            }
        }
    }

    /// The plan of a task, whose lease is kept from now on: plans, results and tables may be on their way to and from a
    /// store for longer than a lease lasts.
    fn load(&self, task: &LeasedTask) -> Result<Arc<dyn PlannedFit>, PlanError> {
        self.scheduler.storing(task.lease, 0);
        self.backend.load(task.into())
    }

    fn assemble(&self, task: &LeasedTask) -> Result<(), TaskError> {
        let plan = self.load(task)?;
        let mut parts = plan.assembly();
        if !self.queue.results(&task.lease, &mut |result| parts.add(result))? {
            return Ok(());
        }
        let file = self.measuring_pool.install(|| parts.file()).map_err(TaskError::Failed)?;
        // The lease ends with a cancelled job.
        let go_on = || !self.is_stopping() && self.queue.progress(&task.lease, 0).is_ok();
        let manifest = self.make_manifest(&file, &go_on).map_err(|error| TaskError::Failed(error.to_string()))?;
        let Some(manifest) = manifest else {
            return Ok(self.queue.give_back(&task.lease)?);
        };
        let digest = self.retried(task, || self.tables.store.blobs.put(&file))?;
        let row = TableRow {
            digest,
            recipe_digest: task.recipe_digest,
            bytes: file.len() as u64,
            created_at: self.queue.now(),
        };
        let mut batch = Catalogue::entry(&row, &task.recipe)?;
        batch.extend(Catalogue::manifest_entry(digest, &manifest)?);
        UseRow { used_at: row.created_at, removed: None }.put(&mut batch, digest)?;
        self.retried(task, || {
            // The same table may be on its way out: an earlier one of this recipe.
            let _naming = self.naming.read().unwrap_or_else(PoisonError::into_inner);
            self.tables.store.blobs.keep(digest, &file)?;
            self.queue.finish(&task.lease, digest, batch.clone())
        })?;
        if let Err(error) = self.tables.store.blobs.keep(digest, &file) {
            tracing::warn!(job = %task.job, table = %digest, %error, "whether the table is still stored is not known");
        }
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
