//! The loop of a worker: lease a task, run it, report the result. One thread renews the leases of all workers.

use std::{
    any::Any,
    num::NonZeroUsize,
    ops::ControlFlow,
    panic::{AssertUnwindSafe, catch_unwind},
    sync::{Arc, PoisonError, atomic::Ordering},
    thread,
    time::{Duration, Instant},
};

use jiff::Timestamp;

use super::{
    TableRow,
    catalogue::Catalogue,
    fitter::{Fitter, LoadError},
    running::Running,
    state::State,
};
use crate::{
    queue::{Failure, FailureKind, Lease, LeaseError, LeasedTask, Release, StaleLease, TaskKind},
    store::StoreError,
};
use ltcforge_files::manifest::MANIFEST_VERSION;

/// How long an idle worker waits before it asks the queue again.
const IDLE: Duration = Duration::from_millis(500);
/// How long to wait after a temporary error, such as a lack of file descriptors.
const RETRY: Duration = Duration::from_secs(1);

/// Why a task has no result.
#[derive(Debug, thiserror::Error)]
pub(super) enum TaskError {
    /// The task was stopped, because its lease is stale or the service is stopping.
    #[error("the task was stopped")]
    Stopped,
    /// The task itself failed. The queue tries it again.
    #[error("{0}")]
    Failed(String),
    /// The store failed. Another attempt can succeed only if [`StoreError::is_passing`] is true.
    #[error(transparent)]
    Store(#[from] StoreError),
}

impl From<LeaseError> for TaskError {
    fn from(error: LeaseError) -> Self {
        match error {
            // Lost results also end the lease. Their shards are fitted again.
            LeaseError::Stale(StaleLease) | LeaseError::Lost(_) => Self::Stopped,
            LeaseError::Store(error) => Self::Store(error),
        }
    }
}

impl From<LoadError> for TaskError {
    fn from(error: LoadError) -> Self {
        match error {
            LoadError::Failed(error) => Self::Failed(error),
            LoadError::Store(error) => Self::Store(error),
        }
    }
}

impl State {
    /// Runs tasks until the queue is closed.
    pub(super) fn work(&self) {
        while !self.is_stopping() {
            let leased = {
                let _turn = self.leasing.lock().unwrap_or_else(PoisonError::into_inner);
                let leased = self.queue.lease(NonZeroUsize::MIN);
                match &leased {
                    Ok(tasks) if tasks.is_empty() => drop(self.queue.wait(IDLE)),
                    Ok(_) => {}
                    Err(error) => {
                        tracing::warn!(%error, "could not lease a task; trying again");
                        thread::park_timeout(RETRY);
                    }
                }
                leased.unwrap_or_default()
            };
            for task in &leased {
                self.run(task);
            }
        }
    }

    /// Renews the leases of all workers and notifies the followers of jobs until the service stops.
    pub(super) fn renew(&self, every: Duration) {
        let mut is_failing = false;
        while !self.is_stopping() {
            thread::park_timeout(every);
            let running: Vec<(Lease, Arc<Running>)> = {
                let running = self.running.lock().unwrap_or_else(PoisonError::into_inner);
                running.iter().map(|(lease, task)| (*lease, Arc::clone(task))).collect()
            };
            let leases: Vec<_> =
                running.iter().map(|(lease, task)| (*lease, task.entries_done.load(Ordering::Relaxed))).collect();
            match self.queue.renew(&leases) {
                Ok(answers) => {
                    is_failing = false;
                    for ((_, task), answer) in running.iter().zip(answers) {
                        task.is_stale.fetch_or(answer.is_err(), Ordering::Relaxed);
                    }
                }
                Err(error) if !is_failing => {
                    is_failing = true;
                    tracing::warn!(%error, "could not renew the leases; trying again");
                }
                Err(_) => {}
            }
            self.files.record_uses();
            self.publish();
        }
    }

    /// Runs a leased task. A failure ends the task or its job, but not the service.
    fn run(&self, task: &LeasedTask) {
        let running = Arc::new(Running::default());
        self.running.lock().unwrap_or_else(PoisonError::into_inner).insert(task.lease, Arc::clone(&running));
        let work = || match task.kind {
            TaskKind::Shard(shard) => self.fit(task, shard, &running),
            TaskKind::Assemble => self.assemble(task, &running),
        };
        let error = match catch_unwind(AssertUnwindSafe(work)) {
            Ok(Ok(())) => None,
            Ok(Err(error)) => Some(error),
            Err(panic) => Some(TaskError::Failed(format!("panic: {}", panic_text(panic.as_ref())))),
        };
        if let Some(error) = error {
            self.report(task, error);
        }
        self.running.lock().unwrap_or_else(PoisonError::into_inner).remove(&task.lease);
    }

    fn report(&self, task: &LeasedTask, error: TaskError) {
        let how = match error {
            TaskError::Stopped => Release::GiveBack,
            TaskError::Failed(error) => Release::Failed(error),
            // The credentials may have expired on this host only.
            TaskError::Store(error) if error.is_passing() || matches!(error, StoreError::Refused(_)) => {
                tracing::warn!(job = %task.job, task = ?task.kind, %error, "the task failed; it will be tried again");
                thread::park_timeout(RETRY);
                Release::GiveBack
            }
            TaskError::Store(error) => {
                Release::Abort(Failure { kind: FailureKind::Storage, detail: error.to_string() })
            }
        };
        match self.queue.release(&task.lease, how) {
            Ok(()) | Err(LeaseError::Stale(_)) => {}
            Err(error) => tracing::warn!(job = %task.job, task = ?task.kind, %error, "could not release the lease"),
        }
    }

    fn fit(&self, task: &LeasedTask, shard: u32, running: &Running) -> Result<(), TaskError> {
        let planned = self.fitter.planned(task.recipe_digest, &task.recipe).map_err(TaskError::Failed)?;
        let plan = self.fitter.plan(task.recipe_digest, &task.recipe)?;
        let started = Instant::now();
        let mut on_progress = |done: u64| {
            let before = running.entries_done.swap(done, Ordering::Relaxed);
            self.entries_fitted.fetch_add(done.saturating_sub(before), Ordering::Relaxed);
            if self.is_stopping() || running.is_stale.load(Ordering::Relaxed) {
                return ControlFlow::Break(());
            }
            ControlFlow::Continue(())
        };
        let fitted = plan.fit_shard(shard, &mut on_progress).ok_or(TaskError::Stopped)?;
        self.forecast.learn(&planned, planned.part(shard), started.elapsed().as_secs_f64());
        let done = [(task.lease, fitted)];
        let answers = self.retried(task, || self.queue.complete(&done))?;
        answers.into_iter().collect::<Result<(), _>>().map_err(|StaleLease| TaskError::Stopped)
    }

    fn assemble(&self, task: &LeasedTask, running: &Running) -> Result<(), TaskError> {
        let plan = self.fitter.plan(task.recipe_digest, &task.recipe)?;
        let results = self.queue.results(&task.lease)?;
        let file = self.pool.install(|| Fitter::assemble(&plan, &results)).map_err(TaskError::Failed)?;
        drop(results);
        let go_on = || !self.is_stopping() && !running.is_stale.load(Ordering::Relaxed);
        let manifest = self.pool.install(|| self.fitter.manifest(&file, &go_on));
        let manifest = manifest.map_err(|error| TaskError::Failed(error.to_string()))?.ok_or(TaskError::Stopped)?;
        let digest = self.retried(task, || self.files.blobs.put(&file))?;
        let bytes = file.len() as u64;
        let row = TableRow { digest, recipe_digest: task.recipe_digest, bytes, created_at: Timestamp::now() };
        let mut batch = Catalogue::table_entry(&row, &task.recipe)?;
        batch.extend(Catalogue::manifest_entry(digest, MANIFEST_VERSION, &manifest)?);
        self.retried(task, || self.queue.finish(&task.lease, digest, batch.clone()))?;
        tracing::info!(job = %task.job, table = %digest, bytes, "the table is stored");
        self.evict();
        Ok(())
    }

    /// Stores a result, and tries again after temporary errors, because the result may have taken minutes to compute.
    pub(super) fn retried<T, E: Into<TaskError>>(
        &self,
        task: &LeasedTask,
        store: impl Fn() -> Result<T, E>,
    ) -> Result<T, TaskError> {
        let mut is_logged = false;
        loop {
            match store().map_err(Into::into) {
                Err(TaskError::Store(error)) if error.is_passing() && !self.is_stopping() => {
                    if !std::mem::replace(&mut is_logged, true) {
                        tracing::warn!(job = %task.job, task = ?task.kind, %error, "the result could not be stored; trying again");
                    }
                    // On a full disk, deleting tables above `--store-bytes` makes room.
                    if matches!(error, StoreError::DiskFull) {
                        self.evict();
                    }
                    thread::park_timeout(RETRY);
                }
                done => return done,
            }
        }
    }
}

/// The message of a panic.
fn panic_text(panic: &(dyn Any + Send)) -> &str {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    text.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("without a message")
}
