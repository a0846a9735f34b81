//! Starting the service.

use std::{
    num::NonZeroU32,
    sync::{
        Arc,
        atomic::{AtomicBool, AtomicU64},
    },
};

use jiff::Timestamp;

use super::{
    Config, OpenError, Service,
    deliveries::Deliveries,
    engine::{Engine, FitEngine},
    exports::Exports,
    forecast::Forecast,
    pictures::Pictures,
    reconcile::reconcile,
    state::{ServiceState, Workers},
    tables::Tables,
    threads::Threads,
    turns::Turns,
    watch::Hub,
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
        let engine = FitEngine::on(Arc::clone(&store.blobs));
        Self::open_with(config, store, Box::new(engine))
    }

    /// As [`Service::open`], on a given store and engine.
    pub(super) fn open_with(config: Config, store: Store, engine: Box<dyn Engine>) -> Result<Arc<Self>, OpenError> {
        let clock: Clock = Arc::new(Timestamp::now);
        let engine: Arc<dyn Engine> = Arc::from(engine);
        let check = {
            let (blobs, engine) = (Arc::clone(&store.blobs), Arc::clone(&engine));
            move |rows: &Arc<dyn Rows>| reconcile(rows, blobs.as_ref(), engine.as_ref()).map(drop)
        };
        let prepared = (|| {
            check(&store.rows)?;
            EmbeddedQueue::open(Arc::clone(&store.rows), limits(&config), clock)
        })();
        let queue = prepared.map_err(|error| refusal(&config, error.into()))?;
        store.checks.add(check);
        Self::start(config, Parts { queue: Box::new(queue), store, engine, works: true })
    }

    /// Starts the workers, if there are to be any.
    pub(super) fn start(config: Config, parts: Parts) -> Result<Arc<Self>, OpenError> {
        let Parts { queue, store, engine, works } = parts;
        let workers = config.workers.get();
        // Each worker has a task under way, and a result to store.
        let tasks = workers.saturating_mul(2).saturating_add(config.queue_limit.clamp(1, MOST_WAITING));
        let threads = if works { tasks } else { 0 };
        let (fitting_pool, measuring_pool) =
            (pool(&config, "fit", threads.max(1))?, pool(&config, "measure", workers)?);
        let turns = Turns::new(workers, config.lease_ttl / 4);
        let forecast = Arc::new(Forecast::new(Arc::clone(&engine), config.workers));
        let tables = Arc::new(Tables::new(store));
        let state = Arc::new(ServiceState {
            engine,
            tables: Arc::clone(&tables),
            queue,
            deliveries: Deliveries::default(),
            hub: Hub::new(Arc::clone(&forecast)),
            forecast,
            measuring_pool,
            threads: Threads::default(),
            turns,
            pictures: Pictures::new(tables, config.adapter, config.pictures),
            exports: Exports::new(config.export_bytes),
            stopping: AtomicBool::new(false),
            entries_fitted: AtomicU64::new(0),
            config,
        });
        let workers = Arc::new(Workers::default());
        for thread in 0..u32::try_from(threads).unwrap_or(u32::MAX) {
            workers.begin();
            let (state, workers) = (Arc::clone(&state), Arc::clone(&workers));
            fitting_pool.spawn(move || {
                state.work(thread);
                // Dropped first: once all workers have ended, the folder may be opened again at once.
                drop(state);
                workers.end();
            });
        }
        Ok(Arc::new(Self { state, workers, _pool: fitting_pool }))
    }
}

/// What a service is made of.
pub(super) struct Parts {
    pub(super) queue: Box<dyn Queue>,
    pub(super) store: Store,
    pub(super) engine: Arc<dyn Engine>,
    /// Whether it fits.
    pub(super) works: bool,
}

/// The bounds of the queue.
pub(super) fn limits(config: &Config) -> Limits {
    Limits {
        jobs: config.queue_limit,
        lease_ttl: config.lease_ttl,
        keep_ended: config.keep_ended,
        max_attempts: NonZeroU32::new(config.max_attempts).unwrap_or(NonZeroU32::MIN),
    }
}

/// Threads, at most, for jobs that arrive while all workers are in the middle of shards.
const MOST_WAITING: usize = 256;

fn pool(config: &Config, name: &'static str, threads: usize) -> Result<rayon::ThreadPool, OpenError> {
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .thread_name(move |n| format!("{name}-{n}"))
        .build()
        .map_err(|error| refusal(config, StoreOpenError::Unusable(std::io::Error::other(error))))
}

fn refusal(config: &Config, error: StoreOpenError) -> OpenError {
    OpenError::of(&config.data_dir, error)
}
