//! The service and the state that its callers and workers share.

use std::sync::{
    Arc, Condvar, Mutex, PoisonError,
    atomic::{AtomicBool, AtomicU64, Ordering},
};

use super::{
    Config, Metrics, ServiceError, deliveries::Deliveries, engine::Engine, exports::Exports, forecast::Forecast,
    pictures::Pictures, tables::Tables, threads::Threads, turns::Turns, watch::Hub,
};
use crate::{
    queue::{JobId, Queue},
    store::Batch,
};

/// The service. All its methods block, so HTTP calls them on blocking threads.
#[derive(Debug)]
pub struct Service {
    pub(super) state: Arc<ServiceState>,
    pub(super) workers: Arc<Workers>,
    /// The threads that fit: two for each worker, of which one stores results, and one for each job
    /// that may arrive while all are busy.
    pub(super) _pool: rayon::ThreadPool,
}

/// What the callers and the workers share.
pub(super) struct ServiceState {
    pub(super) config: Config,
    pub(super) engine: Arc<dyn Engine>,
    pub(super) forecast: Arc<Forecast>,
    pub(super) tables: Arc<Tables>,
    pub(super) queue: Box<dyn Queue>,
    pub(super) deliveries: Deliveries,
    pub(super) hub: Hub,
    /// Measures tables and makes exports of them. The loops of the workers occupy all threads of the fitting pool; the threads of this one are idle
    /// until a table is assembled.
    pub(super) measuring_pool: rayon::ThreadPool,
    /// Starts threads for single pieces of work.
    pub(super) threads: Threads,
    /// Which of the threads that fit may work.
    pub(super) turns: Turns,
    pub(super) pictures: Pictures,
    pub(super) exports: Exports,
    pub(super) stopping: AtomicBool,
    pub(super) entries_fitted: AtomicU64,
}

impl std::fmt::Debug for ServiceState {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("ServiceState").field("config", &self.config).finish_non_exhaustive()
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
    /// Stops the service: no more tasks are leased or pictures rendered, running shards are given back within
    /// a moment, and the store is flushed.
    pub fn stop(&self) {
        // The queue is closed first; otherwise a worker could give its shard back and lease it again.
        self.state.queue.close();
        self.state.stopping.store(true, Ordering::SeqCst);
        self.state.turns.close();
        self.state.pictures.close();
        self.workers.wait();
        // What was acknowledged is durable already. This also writes the leases that were given back.
        if let Err(error) = self.state.tables.store.rows.commit(&Batch::default()) {
            tracing::warn!(%error, "the last flush failed");
        }
    }

    /// Whether the service accepts jobs and works on them.
    #[must_use]
    pub fn is_ready(&self) -> bool {
        !self.state.is_stopping() && self.state.queue.is_reachable()
    }

    /// Whether [`Self::stop`] was called.
    #[must_use]
    pub fn is_stopping(&self) -> bool {
        self.state.is_stopping()
    }

    /// Figures for `/metrics`.
    ///
    /// # Errors
    /// When the store fails.
    pub fn metrics(&self) -> Result<Metrics, ServiceError> {
        let state = &self.state;
        let (leases_expired, shard_failures) = state.queue.failures();
        let (tables, table_bytes) = state.tables.catalogue.totals()?;
        Ok(Metrics {
            jobs: state.queue.counts()?,
            entries_fitted: state.entries_fitted.load(Ordering::Relaxed),
            shard_failures,
            leases_expired,
            tables,
            table_bytes,
            blobs_corrupt: state.tables.damaged(),
            pictures: state.pictures.counts(),
            exports_made: state.exports.made(),
        })
    }
}

impl Drop for Service {
    fn drop(&mut self) {
        if !self.state.is_stopping() {
            self.stop();
        }
    }
}

impl ServiceState {
    pub(super) fn is_stopping(&self) -> bool {
        self.stopping.load(Ordering::SeqCst)
    }

    /// Notifies the followers of every job that has changed.
    pub(super) fn publish_changes(&self) {
        for id in self.queue.take_changed() {
            // A job of other processes that nobody has asked about here need not be looked up.
            if self.queue.is_local() || self.hub.knows(id) {
                self.publish(id);
            }
        }
    }

    /// Notifies the followers of a job.
    pub(super) fn publish(&self, id: JobId) {
        let published = self.hub.publish(id, || self.queue.job_now(id));
        if let Err(error) = published {
            tracing::warn!(job = %id, %error, "the followers of the job were not notified");
        }
    }
}
