//! The loop of a worker: lease a task, do it, store the result.

use std::{
    any::Any,
    ops::ControlFlow,
    panic::{AssertUnwindSafe, catch_unwind},
    sync::atomic::Ordering,
    time::{Duration, Instant},
};

use super::{
    TableRow,
    downloads::ManifestError,
    state::ServiceState,
    turns::{Asked, ShardResult, Turn},
};
use crate::{
    queue::{Failure, FailureKind, LeaseError, LeasedTask, StaleLease, TaskKind},
    store::{Catalogue, StoreError},
};
use ltcforge_files::digest::Digest;

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

/// How long a worker waits after an error that passes, such as a lack of file descriptors.
const RETRY: Duration = Duration::from_secs(1);

/// How often a worker reports its progress, at most. A queue that is writing holds it up meanwhile.
const REPORT: Duration = Duration::from_millis(20);

impl ServiceState {
    /// Does tasks until the queue is closed.
    pub(super) fn work(&self, thread: u32) {
        let lease = |demand, most| self.queue.lease(thread, demand, most);
        let mut next = None;
        loop {
            let task = match next.take() {
                Some(task) => task,
                None => match self.turns.ask(lease, |seen| self.queue.wait(seen)) {
                    Some(Asked::Task(task)) => task,
                    Some(Asked::Result(result)) => {
                        self.attempt(&result.task, || Ok(self.complete(&result.task, &result.bytes)?));
                        self.publish_changes();
                        continue;
                    }
                    None => return,
                },
            };
            self.publish_changes();
            let mut turn = self.turns.begin(task.job, &mut || self.renew(&task, 0));
            next = self.attempt(&task, || self.perform(&task, &mut turn)).flatten();
            drop(turn);
            self.publish_changes();
        }
    }

    /// Renews the lease of a task that waits, and those that no thread holds. If one has ended, its task hears of it when it
    /// goes on.
    fn renew(&self, task: &LeasedTask, done: u64) {
        let _ = self.queue.progress(&task.lease, done);
        self.renew_held();
    }

    fn renew_held(&self) {
        self.turns.renew_held(|task| {
            let _ = self.queue.progress(&task.lease, 0);
        });
    }

    /// Does a leased task. Returns the one to go on with.
    fn perform(&self, task: &LeasedTask, turn: &mut Turn<'_>) -> Result<Option<Box<LeasedTask>>, TaskError> {
        match task.kind {
            _ if !turn.works() => {
                self.queue.give_back(&task.lease)?;
                Ok(None)
            }
            TaskKind::Shard(shard) => self.fit(task, shard, turn),
            TaskKind::Assemble => self.assemble(task, turn).map(|()| None),
        }
    }

    /// Does work on a leased task. A failure ends the task or the job, never the service.
    fn attempt<T>(&self, task: &LeasedTask, work: impl FnOnce() -> Result<T, TaskError>) -> Option<T> {
        let error = match catch_unwind(AssertUnwindSafe(work)) {
            Ok(Ok(done)) => return Some(done),
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
        None
    }

    fn fit(&self, task: &LeasedTask, shard: u32, turn: &mut Turn<'_>) -> Result<Option<Box<LeasedTask>>, TaskError> {
        let mut fitted = 0;
        let (started, waited) = (Instant::now(), turn.waited());
        let mut reported = None;
        let mut on_progress = |done: u64| {
            self.entries_fitted.fetch_add(done.saturating_sub(fitted), Ordering::Relaxed);
            fitted = done;
            turn.pass(&mut || self.renew(task, done));
            if self.is_stopping() {
                return ControlFlow::Break(());
            }
            if reported.is_some_and(|at: Instant| at.elapsed() < REPORT) {
                return ControlFlow::Continue(());
            }
            reported = Some(Instant::now());
            if self.queue.progress(&task.lease, done).is_err() {
                return ControlFlow::Break(());
            }
            self.renew_held();
            // Whoever follows a shared job has it looked at now and then.
            if self.queue.is_local() && self.hub.is_watched(task.job) {
                self.publish(task.job);
            }
            ControlFlow::Continue(())
        };
        // It may have waited, and its job may have ended meanwhile.
        self.queue.progress(&task.lease, 0)?;
        self.engine.prepare(&task.recipe)?;
        let Some(bytes) = self.engine.fit_shard(&task.recipe, shard, &mut on_progress).map_err(TaskError::Failed)?
        else {
            self.queue.give_back(&task.lease)?;
            return Ok(None);
        };
        let took = (started.elapsed() + waited).saturating_sub(turn.waited());
        self.forecast.learn(&task.recipe, fitted as f64 / task.entries_total as f64, took.as_secs_f64());
        Ok(turn.end(took, ShardResult { task: Box::new(task.clone()), bytes }))
    }

    /// Stores a shard's result. An error that passes is waited out, because the shard may have taken minutes.
    fn complete(&self, task: &LeasedTask, result: &[u8]) -> Result<(), LeaseError> {
        loop {
            match self.deliveries.deliver(self.queue.as_ref(), task.lease, result) {
                Err(LeaseError::Store(error)) if error.is_passing() && !self.is_stopping() => {
                    tracing::warn!(job = %task.job, task = ?task.kind, %error, "the result is stored again");
                    self.queue.pause(RETRY);
                    self.queue.progress(&task.lease, 0)?;
                    self.renew_held();
                }
                done => return done,
            }
        }
    }

    fn assemble(&self, task: &LeasedTask, turn: &mut Turn<'_>) -> Result<(), TaskError> {
        self.engine.prepare(&task.recipe)?;
        let mut parts = self.engine.assembly(&task.recipe).map_err(TaskError::Failed)?;
        if !self.queue.results(&task.lease, &mut |result| parts.add(result))? {
            return Ok(());
        }
        let file = parts.file().map_err(TaskError::Failed)?;
        // The lease ends with a cancelled job. Until then it is renewed: a table may take long to measure.
        let go_on = || {
            self.renew_held();
            !self.is_stopping() && self.queue.progress(&task.lease, 0).is_ok()
        };
        // The table is measured by other threads.
        let manifest = turn.leave(|| self.make_manifest(&file, &go_on), &mut || self.renew(task, 0));
        let manifest = manifest.map_err(|error| match error {
            ManifestError::Table(error) => TaskError::Failed(error.to_string()),
            ManifestError::Lacking(error) => TaskError::Store(error),
        })?;
        let Some(manifest) = manifest.filter(|_| turn.works()) else {
            self.queue.give_back(&task.lease)?;
            return Ok(());
        };
        let digest = self.store_file(task, &file)?;
        let row = TableRow {
            digest,
            recipe_digest: task.recipe_digest,
            bytes: file.len() as u64,
            created_at: self.queue.now(),
        };
        let mut batch = Catalogue::entry(&row, &task.recipe)?;
        batch.extend(Catalogue::manifest_entry(digest, &manifest)?);
        self.queue.finish(&task.lease, digest, batch)?;
        tracing::info!(job = %task.job, table = %digest, bytes = row.bytes, "the table is stored");
        Ok(())
    }
}

impl ServiceState {
    /// Stores a table's file. An error that passes is waited out, because assembling and measuring may have taken minutes.
    fn store_file(&self, task: &LeasedTask, file: &[u8]) -> Result<Digest, TaskError> {
        loop {
            match self.tables.store.blobs.put(file) {
                Err(error) if error.is_passing() && !self.is_stopping() => {
                    tracing::warn!(job = %task.job, %error, "the table is stored again");
                    self.queue.pause(RETRY);
                    self.queue.progress(&task.lease, 0)?;
                }
                done => return Ok(done?),
            }
        }
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
