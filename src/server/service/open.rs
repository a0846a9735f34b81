//! Starting the service.

use std::{
    io,
    num::NonZeroU32,
    sync::{
        Arc, Mutex, RwLock,
        atomic::{AtomicBool, AtomicU64},
        mpsc,
    },
};

use super::{
    Config, OpenError, Service,
    backend::{Backend, FitBackend},
    compressed::Compressed,
    exports::Exports,
    forecast::Forecast,
    pictures::Pictures,
    reconcile::reconcile,
    scheduler::Scheduler,
    state::ServiceState,
    tables::Tables,
    watch::Hub,
    work::MOST_RESULTS,
};
use crate::{
    queue::{
        Limits, Queue,
        embedded::{Clock, EmbeddedQueue},
    },
    store::{Rows, Store, StoreOpenError},
};

impl Service {
    /// Opens the store, applies migrations, resumes unfinished jobs and starts the workers.
    ///
    /// # Errors
    /// When the folder is locked, not usable, or of a later version.
    pub fn open(config: Config) -> Result<Arc<Self>, OpenError> {
        let store = Store::open(&config.data_dir).map_err(|error| refusal(&config, error))?;
        let backend = FitBackend::new(Some(Arc::clone(&store.blobs)));
        Self::open_with(config, store, Arc::new(backend))
    }

    /// As [`Service::open`], on a given store and backend.
    pub(super) fn open_with(config: Config, store: Store, backend: Arc<dyn Backend>) -> Result<Arc<Self>, OpenError> {
        let check = {
            let (blobs, backend) = (Arc::clone(&store.blobs), Arc::clone(&backend));
            move |rows: &Arc<dyn Rows>| reconcile(rows, blobs.as_ref(), backend.as_ref()).map(drop)
        };
        let prepared = (|| {
            check(&store.rows)?;
            EmbeddedQueue::open(Arc::clone(&store.rows), limits(&config), Clock::system())
        })();
        let queue = prepared.map_err(|error| refusal(&config, error.into()))?;
        // It is set here alone, so this cannot fail.
        let _ = store.reopen_check.set(Box::new(check));
        Self::start(config, ServiceParts { queue: Box::new(queue), store, backend, works: true })
    }

    /// Starts the workers, if there are to be any.
    pub(super) fn start(config: Config, parts: ServiceParts) -> Result<Arc<Self>, OpenError> {
        let ServiceParts { queue, store, backend, works } = parts;
        let measuring_pool = rayon::ThreadPoolBuilder::new()
            .num_threads(config.workers.get())
            .thread_name(|n| format!("measure-{n}"))
            .build()
            .map_err(|error| refusal(&config, StoreOpenError::Unusable(io::Error::other(error))))?;
        let forecast = Arc::new(Forecast::new(Arc::clone(&backend), config.workers));
        let tables = Arc::new(Tables::new(store));
        let state = Arc::new(ServiceState {
            backend,
            tables: Arc::clone(&tables),
            queue,
            hub: Hub::new(Arc::clone(&forecast)),
            forecast,
            measuring_pool,
            scheduler: Scheduler::new(config.workers),
            pictures: Pictures::new(tables, config.adapter, config.pictures),
            exports: Exports::new(config.export_bytes),
            compressed: Compressed::default(),
            storing: Mutex::default(),
            naming: RwLock::default(),
            stopping: AtomicBool::new(false),
            entries_fitted: AtomicU64::new(0),
            files_removed: AtomicU64::new(0),
            config,
        });
        let service = Self { state, threads: Mutex::default() };
        if service.state.tables.store.blobs.remembers() {
            let scrub = service.spawn("scrub".to_owned(), ServiceState::scrub);
            scrub.map_err(|error| refusal(&service.state.config, StoreOpenError::Unusable(error)))?;
        }
        let retain = service.spawn("retain".to_owned(), ServiceState::retain);
        retain.map_err(|error| refusal(&service.state.config, StoreOpenError::Unusable(error)))?;
        if works {
            service.start_workers().map_err(|error| refusal(&service.state.config, StoreOpenError::Unusable(error)))?;
        }
        Ok(Arc::new(service))
    }

    /// Starts the workers, the threads for jobs that arrive while all workers are busy, and what stores results and
    /// keeps leases.
    fn start_workers(&self) -> io::Result<()> {
        let config = &self.state.config;
        let threads = config.workers.get().saturating_add(config.queue_limit.clamp(1, MOST_WAITING));
        let (results, stored) = mpsc::sync_channel(MOST_RESULTS);
        for thread in 0..u32::try_from(threads).unwrap_or(u32::MAX) {
            let results = results.clone();
            self.spawn(format!("fit-{thread}"), move |state| state.work(&results))?;
        }
        self.spawn("store-results".to_owned(), move |state| state.store_results(&stored))?;
        self.spawn("keep-leases".to_owned(), ServiceState::keep_leases)
    }
}

/// The parts of a service.
pub(super) struct ServiceParts {
    pub(super) queue: Box<dyn Queue>,
    pub(super) store: Store,
    pub(super) backend: Arc<dyn Backend>,
    /// Whether it fits.
    pub(super) works: bool,
}

/// The bounds of the queue.
pub(super) fn limits(config: &Config) -> Limits {
    Limits {
        jobs: config.queue_limit,
        lease_ttl: config.lease_ttl,
        keep_ended: config.keep_ended,
        most_ended: config.most_ended,
        max_attempts: NonZeroU32::new(config.max_attempts).unwrap_or(NonZeroU32::MIN),
    }
}

/// Threads, at most, for jobs that arrive while all workers are in the middle of shards.
const MOST_WAITING: usize = 256;

fn refusal(config: &Config, error: StoreOpenError) -> OpenError {
    OpenError::of(&config.data_dir, error)
}
