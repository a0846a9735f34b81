//! The work loop: lease, fit, store.

use std::{
    any::Any,
    ops::ControlFlow,
    panic::{AssertUnwindSafe, catch_unwind},
    sync::atomic::Ordering,
    time::Instant,
};

use super::{TableRow, core::Core};
use crate::server::{
    queue::{Failure, FailureKind, LeaseError, Offer, StaleLease, Step, Work},
    store::{Catalogue, StoreError},
};

/// Why a step was not delivered.
#[derive(Debug, thiserror::Error)]
enum Trouble {
    /// The lease is somebody else's, or the job is no more.
    #[error(transparent)]
    Stale(#[from] StaleLease),
    /// The step itself failed: it is tried again.
    #[error("{0}")]
    Step(String),
    /// The store failed: trying again at once would not help.
    #[error(transparent)]
    Store(#[from] StoreError),
}

impl From<LeaseError> for Trouble {
    fn from(error: LeaseError) -> Self {
        match error {
            LeaseError::Stale(error) => Self::Stale(error),
            LeaseError::Store(error) => Self::Store(error),
        }
    }
}

impl Core {
    /// Works until the queue is closed.
    pub(super) fn work(&self, worker: u32) {
        loop {
            match self.queue.lease(worker) {
                Offer::Work(work) => {
                    self.publish_changes();
                    self.deliver(&work);
                }
                Offer::Nothing { seen } => self.queue.wait(seen),
                Offer::Closed => return,
            }
            self.publish_changes();
        }
    }

    /// Does what is leased; whatever goes wrong ends with the step or the job, never with the service.
    fn deliver(&self, work: &Work) {
        let done = catch_unwind(AssertUnwindSafe(|| match work.step {
            Step::Shard(shard) => self.fit(work, shard),
            Step::Assemble => self.assemble(work),
        }));
        let trouble = match done {
            Ok(Ok(())) => return,
            Ok(Err(trouble)) => trouble,
            Err(panic) => Trouble::Step(format!("panic: {}", panic_text(panic.as_ref()))),
        };
        let settled = match trouble {
            Trouble::Stale(error) => Err(error),
            Trouble::Step(error) => self.queue.fail(&work.lease, &error),
            Trouble::Store(error) => {
                let kind = match error {
                    StoreError::DiskFull => FailureKind::DiskFull,
                    _ => FailureKind::Storage,
                };
                self.queue.abort(&work.lease, Failure { kind, detail: error.to_string() })
            }
        };
        if let Err(StaleLease) = settled {
            tracing::debug!(job = %work.job, step = ?work.step, "the lease was no more when the step ended");
        }
    }

    fn fit(&self, work: &Work, shard: u32) -> Result<(), Trouble> {
        let mut fitted = 0;
        let mut pulse = |done: u64| {
            self.entries_fitted.fetch_add(done.saturating_sub(fitted), Ordering::Relaxed);
            fitted = done;
            if self.is_stopping() || self.queue.progress(&work.lease, done).is_err() {
                return ControlFlow::Break(());
            }
            if self.hub.is_watched(work.job) {
                self.publish(work.job);
            }
            ControlFlow::Continue(())
        };
        let started = Instant::now();
        match self.engine.fit_shard(&work.recipe, shard, &mut pulse).map_err(Trouble::Step)? {
            Some(result) => {
                let seconds = started.elapsed().as_secs_f64();
                if let Some(job) = self.queue.job(work.job)? {
                    self.forecast.learn(&work.recipe, fitted as f64 / job.entries_total as f64, seconds);
                }
                self.queue.complete(&work.lease, &result)?;
            }
            None => self.queue.give_back(&work.lease)?,
        }
        Ok(())
    }

    fn assemble(&self, work: &Work) -> Result<(), Trouble> {
        let Some(results) = self.queue.results(&work.lease)? else { return Ok(()) };
        let file = self.engine.assemble(&work.recipe, results).map_err(Trouble::Step)?;
        let manifest = self.make_manifest(&file).map_err(|error| Trouble::Step(error.to_string()))?;
        let digest = self.store.blobs.put(&file)?;
        let row = TableRow {
            digest,
            recipe_digest: work.recipe_digest,
            bytes: file.len() as u64,
            created_at: (self.clock)(),
        };
        let mut batch = Catalogue::entry(&row, &work.recipe)?;
        batch.extend(Catalogue::manifest_entry(digest, &manifest)?);
        self.queue.finish(&work.lease, digest, batch)?;
        tracing::info!(job = %work.job, table = %digest, bytes = row.bytes, "the table is stored");
        Ok(())
    }
}

/// What a panic said.
fn panic_text(panic: &(dyn Any + Send)) -> &str {
    panic
        .downcast_ref::<&str>()
        .copied()
        .or_else(|| panic.downcast_ref::<String>().map(String::as_str))
        .unwrap_or("without a message")
}
