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
use crate::server::{
    queue::{Clock, Limits, Queue},
    store::{Rows, Store, StoreOpenError},
};

impl Service {
    /// Opens the store, applies migrations, resumes unfinished jobs and starts the workers.
    ///
    /// # Errors
    /// When the folder is locked, not usable, or of a later version.
    pub fn open(config: Config) -> Result<Arc<Self>, OpenError> {
        let store = Store::open(&config.data_dir).map_err(|error| refusal(&config, error))?;
        Self::open_with(config, store, Box::new(FitEngine::default()))
    }

    /// As [`Service::open`], on a given store and engine.
    pub(super) fn open_with(config: Config, store: Store, engine: Box<dyn Engine>) -> Result<Arc<Self>, OpenError> {
        let clock: Clock = Arc::new(Timestamp::now);
        let limits = Limits {
            jobs: config.queue_limit,
            lease_ttl: config.lease_ttl,
            keep_ended: config.keep_ended,
            max_attempts: NonZeroU32::new(config.max_attempts).unwrap_or(NonZeroU32::MIN),
        };
        let engine: Arc<dyn Engine> = Arc::from(engine);
        let check = {
            let (blobs, engine) = (Arc::clone(&store.blobs), Arc::clone(&engine));
            move |rows: &Arc<dyn Rows>| reconcile(rows, blobs.as_ref(), engine.as_ref()).map(drop)
        };
        let prepared = (|| {
            check(&store.rows)?;
            Queue::open(Arc::clone(&store.rows), limits, Arc::clone(&clock))
        })();
        let queue = prepared.map_err(|error| refusal(&config, error.into()))?;
        store.checks.add(check);
        let workers = config.workers.get();
        let threads = workers.saturating_add(config.queue_limit.clamp(1, MOST_WAITING));
        let (fitting_pool, measuring_pool) = (pool(&config, "fit", threads)?, pool(&config, "measure", workers)?);
        let turns = Turns::new(workers, config.lease_ttl / 4);
        let forecast = Arc::new(Forecast::new(Arc::clone(&engine), config.workers));
        let tables = Arc::new(Tables::new(store));
        let state = Arc::new(ServiceState {
            engine,
            tables: Arc::clone(&tables),
            queue,
            hub: Hub::new(Arc::clone(&clock), Arc::clone(&forecast)),
            forecast,
            measuring_pool,
            threads: Threads::default(),
            turns,
            clock,
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
