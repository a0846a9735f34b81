//! The service and the state that its callers and workers share.

use std::{
    io,
    sync::{
        Arc, Mutex, PoisonError, RwLock,
        atomic::{AtomicBool, AtomicU64, Ordering},
    },
    thread::{self, JoinHandle},
};

use super::{
    Config, Metrics, ServiceError, backend::Backend, compressed::Compressed, exports::Exports, forecast::Forecast,
    pictures::Pictures, scheduler::Scheduler, tables::Tables, watch::Hub,
};
use crate::{
    queue::{JobId, Queue},
    store::Batch,
};

/// The service. All its methods block, so HTTP calls them on blocking threads.
#[derive(Debug)]
pub struct Service {
    pub(super) state: Arc<ServiceState>,
    /// Those that work until the service is stopped.
    pub(super) threads: Mutex<Vec<JoinHandle<()>>>,
}

/// The state that callers and workers share.
pub(super) struct ServiceState {
    pub(super) config: Config,
    pub(super) backend: Arc<dyn Backend>,
    pub(super) forecast: Arc<Forecast>,
    pub(super) tables: Arc<Tables>,
    pub(super) queue: Box<dyn Queue>,
    pub(super) hub: Hub,
    /// Assembles and measures tables and makes exports of them.
    pub(super) measuring_pool: rayon::ThreadPool,
    pub(super) scheduler: Scheduler,
    pub(super) pictures: Pictures,
    pub(super) exports: Exports,
    pub(super) compressed: Compressed,
    /// Held while a file that was sent is counted and stored.
    pub(super) storing: Mutex<()>,
    /// Read while a recipe becomes a job, a file is stored or a table pinned; written while a file is removed.
    pub(super) naming: RwLock<()>,
    pub(super) stopping: AtomicBool,
    pub(super) entries_fitted: AtomicU64,
    pub(super) files_removed: AtomicU64,
}

impl std::fmt::Debug for ServiceState {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("ServiceState").field("config", &self.config).finish_non_exhaustive()
    }
}

impl Service {
    /// Starts a thread that works until the service is stopped.
    pub(super) fn spawn(&self, name: String, work: impl FnOnce(&ServiceState) + Send + 'static) -> io::Result<()> {
        let state = Arc::clone(&self.state);
        let thread = thread::Builder::new().name(name).spawn(move || work(&state))?;
        self.threads.lock().unwrap_or_else(PoisonError::into_inner).push(thread);
        Ok(())
    }

    /// Stops the service: no more tasks are leased or pictures rendered, running shards are given back within
    /// a moment, and the store is flushed.
    pub fn stop(&self) {
        // The queue is closed first; otherwise a worker could give its shard back and lease it again.
        self.state.queue.close();
        self.state.stopping.store(true, Ordering::SeqCst);
        self.state.scheduler.wake();
        self.state.pictures.close();
        // Once they have ended, the folder may be opened again at once.
        let mut threads = self.threads.lock().unwrap_or_else(PoisonError::into_inner);
        for thread in threads.drain(..) {
            // The scrub waits parked.
            thread.thread().unpark();
            if thread.join().is_err() {
                tracing::error!("a thread of the service panicked");
            }
        }
        // Everything acknowledged is durable already. This also writes the leases that were given back.
        if let Err(error) = self.state.tables.store.rows.commit(&Batch::default()) {
            tracing::warn!(%error, "the last flush failed");
        }
    }

    /// Why the service does not accept jobs now, in words; `None` if it does.
    #[must_use]
    pub fn fault(&self) -> Option<String> {
        let ServiceState { queue, tables, .. } = self.state.as_ref();
        if self.state.is_stopping() {
            Some("the service is stopping".to_owned())
        } else if !tables.store.rows.is_writable() {
            Some("the disk of the data folder is full".to_owned())
        } else if !tables.store.blobs.is_reachable() {
            Some("the store of tables does not answer".to_owned())
        } else {
            queue.fault()
        }
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
            backlog: state.backlog()?,
            entries_fitted: state.entries_fitted.load(Ordering::Relaxed),
            shard_failures,
            leases_expired,
            tables,
            table_bytes,
            blobs_corrupt: state.tables.damaged(),
            pictures: state.pictures.counts(),
            exports_made: state.exports.made(),
            files_removed: state.files_removed.load(Ordering::Relaxed),
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
