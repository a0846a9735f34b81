//! The service, and the state that callers and workers share.

use std::{
    collections::HashMap,
    io,
    sync::{
        Arc, Mutex, PoisonError, RwLock,
        atomic::{AtomicBool, AtomicU64, Ordering},
    },
    thread::{self, JoinHandle},
};

use jiff::Timestamp;

use super::{
    Config, PictureCounts, ServiceError, exports::Exports, files::Files, fitter::Fitter, forecast::Forecast, hub::Hub,
    pictures::Pictures, running::Running,
};
use crate::queue::{Depth, Lease, Queue, StateName};
use ltcforge_files::digest::Digest;

/// The service. Its methods block, except [`Service::picture`] and [`Service::cached_file`], so HTTP calls them on
/// blocking threads.
#[derive(Debug)]
pub struct Service {
    pub(super) state: Arc<State>,
    /// Threads that run until the service is stopped.
    pub(super) threads: Mutex<Vec<JoinHandle<()>>>,
}

/// The state that callers and workers share.
#[derive(Debug)]
pub(super) struct State {
    pub(super) config: Config,
    pub(super) fitter: Fitter,
    pub(super) forecast: Forecast,
    pub(super) files: Files,
    pub(super) queue: Box<dyn Queue>,
    pub(super) hub: Hub,
    /// Threads that assemble, measure and export tables.
    pub(super) pool: rayon::ThreadPool,
    /// The leased tasks of this process.
    pub(super) running: Mutex<HashMap<Lease, Arc<Running>>>,
    /// Locked while a thread leases tasks, so that idle workers query the queue one at a time.
    pub(super) leasing: Mutex<()>,
    pub(super) pictures: Pictures,
    pub(super) exports: Exports,
    /// Locked while BRDFs are counted and a BRDF is stored.
    pub(super) storing: Mutex<()>,
    /// Locked for reading while a recipe becomes a job or a file is stored, and for writing while a file is removed.
    pub(super) naming: RwLock<()>,
    /// Whether all jobs and files were known at the start. Otherwise no table is evicted and no BRDF is deleted.
    pub(super) is_complete: bool,
    pub(super) stopping: AtomicBool,
    pub(super) entries_fitted: AtomicU64,
    pub(super) files_removed: AtomicU64,
}

/// Figures for `/metrics`.
#[derive(Debug, Clone, Default)]
pub struct Metrics {
    /// Jobs by state.
    pub jobs: Vec<(StateName, u64)>,
    /// Waiting and leased shards, for all processes that share the queue.
    pub shards: Depth,
    /// Predicted seconds to fit the unfinished shards on one core.
    pub core_seconds: f64,
    /// Seconds since the oldest unfinished job was submitted, or 0 if all jobs have ended.
    pub oldest_seconds: f64,
    /// Entries fitted since the start.
    pub entries_fitted: u64,
    /// Shards that failed since the start.
    pub shard_failures: u64,
    /// Leases that expired since the start.
    pub leases_expired: u64,
    /// Tables in the catalogue.
    pub tables: u64,
    /// Bytes of all tables.
    pub table_bytes: u64,
    /// Stored files found damaged since the start.
    pub blobs_corrupt: u64,
    /// Pictures since the start, except those served from memory.
    pub pictures: PictureCounts,
    /// Exports made since the start, except those served from memory.
    pub exports_made: u64,
    /// Tables evicted since the start.
    pub files_removed: u64,
}

impl Service {
    /// Starts a thread that runs until the service is stopped.
    pub(super) fn spawn(&self, name: String, work: impl FnOnce(&State) + Send + 'static) -> io::Result<()> {
        let state = Arc::clone(&self.state);
        let thread = thread::Builder::new().name(name).spawn(move || work(&state))?;
        self.threads.lock().unwrap_or_else(PoisonError::into_inner).push(thread);
        Ok(())
    }

    /// Stops the service. It leases no more tasks, and releases running shards within a moment.
    pub fn stop(&self) {
        self.state.queue.close();
        self.state.stopping.store(true, Ordering::SeqCst);
        let mut threads = self.threads.lock().unwrap_or_else(PoisonError::into_inner);
        for thread in threads.drain(..) {
            // The thread that renews leases is parked.
            thread.thread().unpark();
            if thread.join().is_err() {
                tracing::error!("a thread of the service panicked; this is a bug");
            }
        }
    }

    /// The reason why the service cannot accept jobs now. `None` if it accepts jobs.
    #[must_use]
    pub fn fault(&self) -> Option<String> {
        if self.is_stopping() {
            return Some("the service is stopping".to_owned());
        }
        let Files { blobs, catalogue, .. } = &self.state.files;
        let unreachable = || blobs.stat(Digest::of(b"any")).err().map(|error| error.to_string());
        catalogue.rows.fault().or_else(unreachable)
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
        let queue = state.queue.statistics()?;
        let (leases_expired, shard_failures) = state.queue.failures();
        let tables = state.files.catalogue.tables()?;
        let oldest = queue.oldest.map(|since| Timestamp::now().duration_since(since).as_secs_f64());
        Ok(Metrics {
            jobs: queue.jobs,
            shards: queue.depth,
            core_seconds: state.forecast.core_seconds(queue.core_seconds),
            oldest_seconds: oldest.unwrap_or(0.0).max(0.0),
            entries_fitted: state.entries_fitted.load(Ordering::Relaxed),
            shard_failures,
            leases_expired,
            tables: tables.len() as u64,
            table_bytes: tables.iter().map(|table| table.bytes).sum(),
            blobs_corrupt: state.files.corrupt(),
            pictures: state.pictures.counts(),
            exports_made: state.exports.made(),
            files_removed: state.files_removed.load(Ordering::Relaxed),
        })
    }
}

impl Drop for Service {
    fn drop(&mut self) {
        if !self.is_stopping() {
            self.stop();
        }
    }
}

impl State {
    pub(super) fn is_stopping(&self) -> bool {
        self.stopping.load(Ordering::SeqCst)
    }
}
