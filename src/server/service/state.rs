//! The service: what its parts share.

use std::sync::{
    Arc, Condvar, Mutex, PoisonError,
    atomic::{AtomicBool, AtomicU64, Ordering},
};

use super::{
    Config, Metrics, ServiceError,
    engine::Engine,
    forecast::Forecast,
    pictures::{Desk, Standings},
    watch::Hub,
};
use crate::server::{
    queue::{Clock, JobId, Queue},
    store::{Batch, Catalogue, Store},
};

/// The service. All its methods block; HTTP calls them from blocking threads.
#[derive(Debug)]
pub struct Service {
    pub(super) core: Arc<Core>,
    pub(super) workers: Arc<Workers>,
    /// Kept for its threads.
    pub(super) _pool: rayon::ThreadPool,
}

/// What callers and workers share.
pub(super) struct Core {
    pub(super) config: Config,
    pub(super) engine: Arc<dyn Engine>,
    pub(super) forecast: Arc<Forecast>,
    pub(super) store: Store,
    pub(super) catalogue: Catalogue,
    pub(super) queue: Queue,
    pub(super) hub: Hub,
    /// Measures tables. The workers hold their pool's threads for good; these stand still until a table is there, and
    /// then make short work of it.
    pub(super) measuring: rayon::ThreadPool,
    pub(super) clock: Clock,
    pub(super) desk: Arc<Desk>,
    pub(super) standings: Standings,
    pub(super) stopping: AtomicBool,
    pub(super) entries_fitted: AtomicU64,
    pub(super) blobs_corrupt: AtomicU64,
}

impl std::fmt::Debug for Core {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Core").field("config", &self.config).finish_non_exhaustive()
    }
}

/// Counts the workers that have not ended.
#[derive(Debug, Default)]
pub(super) struct Workers {
    alive: Mutex<usize>,
    ended: Condvar,
}

impl Workers {
    pub(super) fn begin(&self) {
        *self.alive.lock().unwrap_or_else(PoisonError::into_inner) += 1;
    }

    pub(super) fn end(&self) {
        *self.alive.lock().unwrap_or_else(PoisonError::into_inner) -= 1;
        self.ended.notify_all();
    }

    fn wait(&self) {
        let alive = self.alive.lock().unwrap_or_else(PoisonError::into_inner);
        drop(self.ended.wait_while(alive, |alive| *alive > 0).unwrap_or_else(PoisonError::into_inner));
    }
}

impl Service {
    /// Stops leasing, lets running shards finish their entry and gives them back, renders no more,
    /// and flushes.
    pub fn stop(&self) {
        // Closed first: a worker that saw the stop would otherwise give its shard back and lease it again.
        self.core.queue.close();
        self.core.stopping.store(true, Ordering::SeqCst);
        self.core.desk.close();
        self.workers.wait();
        // Whatever was acknowledged is durable; this adds the leases that were given back.
        if let Err(error) = self.core.store.rows.commit(&Batch::default()) {
            tracing::warn!(%error, "the last flush failed");
        }
    }

    /// Whether the service takes and works on jobs.
    #[must_use]
    pub fn is_ready(&self) -> bool {
        !self.core.is_stopping()
    }

    /// Figures for `/metrics`.
    ///
    /// # Errors
    /// When the store fails.
    pub fn metrics(&self) -> Result<Metrics, ServiceError> {
        let core = &self.core;
        let (leases_expired, shard_failures) = core.queue.failures();
        let (tables, table_bytes) = core.catalogue.totals()?;
        Ok(Metrics {
            jobs: core.queue.counts(),
            entries_fitted: core.entries_fitted.load(Ordering::Relaxed),
            shard_failures,
            leases_expired,
            tables,
            table_bytes,
            blobs_corrupt: core.blobs_corrupt.load(Ordering::Relaxed),
            pictures: core.desk.counts(),
        })
    }
}

impl Drop for Service {
    fn drop(&mut self) {
        if !self.core.is_stopping() {
            self.stop();
        }
    }
}

impl Core {
    pub(super) fn is_stopping(&self) -> bool {
        self.stopping.load(Ordering::SeqCst)
    }

    /// Tells watchers of every job that has changed.
    pub(super) fn publish_changes(&self) {
        for id in self.queue.take_touched() {
            self.publish(id);
        }
    }

    /// Tells watchers of a job how it stands.
    pub(super) fn publish(&self, id: JobId) {
        let told = self.hub.publish(id, || self.queue.job(id));
        if let Err(error) = told {
            tracing::warn!(job = %id, %error, "watchers were not told");
        }
    }
}
