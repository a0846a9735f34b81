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
    Config, OpenError, Service, TableRow,
    core::{Core, Workers},
    engine::{Engine, Fitter},
    forecast::Forecast,
    pictures::{Desk, Standings},
    watch::Hub,
};
use crate::server::{
    queue::{Clock, Limits, Queue},
    store::{Batch, Catalogue, Store, StoreError, StoreOpenError},
};

impl Service {
    /// Opens the store, applies migrations, resumes unfinished jobs and starts the workers.
    ///
    /// # Errors
    /// When the folder is locked, not usable, or of a later version.
    pub fn open(config: Config) -> Result<Arc<Self>, OpenError> {
        let store = Store::open(&config.data_dir).map_err(|error| refusal(&config, error))?;
        Self::open_with(config, store, Box::new(Fitter::default()))
    }

    /// As [`Service::open`], on a given store and engine.
    pub(super) fn open_with(config: Config, store: Store, engine: Box<dyn Engine>) -> Result<Arc<Self>, OpenError> {
        let clock: Clock = Arc::new(Timestamp::now);
        let limits = Limits {
            jobs: config.queue_limit,
            lease_ttl: config.lease_ttl,
            max_attempts: NonZeroU32::new(config.max_attempts).unwrap_or(NonZeroU32::MIN),
        };
        let opened = Catalogue::new(Arc::clone(&store.rows));
        let prepared = (|| {
            if store.database_is_new {
                rebuild_catalogue(&store, engine.as_ref())?;
            }
            Queue::open(Arc::clone(&store.rows), limits, Arc::clone(&clock))
        })();
        let queue = prepared.map_err(|error| refusal(&config, error.into()))?;
        let (fitting, measuring) = (pool(&config, "fit")?, pool(&config, "measure")?);
        let engine: Arc<dyn Engine> = Arc::from(engine);
        let forecast = Arc::new(Forecast::new(Arc::clone(&engine), config.workers));
        let core = Arc::new(Core {
            engine,
            catalogue: opened,
            store,
            queue,
            hub: Hub::new(Arc::clone(&clock), Arc::clone(&forecast)),
            forecast,
            measuring,
            clock,
            desk: Arc::new(Desk::new(config.adapter)),
            standings: Standings::default(),
            stopping: AtomicBool::new(false),
            entries_fitted: AtomicU64::new(0),
            blobs_corrupt: AtomicU64::new(0),
            config,
        });
        let workers = Arc::new(Workers::default());
        for worker in 0..u32::try_from(core.config.workers.get()).unwrap_or(u32::MAX) {
            workers.begin();
            let (core, workers) = (Arc::clone(&core), Arc::clone(&workers));
            fitting.spawn(move || {
                core.work(worker);
                // Who waits for the end of all workers may open the folder again at once.
                drop(core);
                workers.end();
            });
        }
        Ok(Arc::new(Self { core, workers, _pool: fitting }))
    }
}

/// A pool of as many threads as there are workers.
fn pool(config: &Config, name: &'static str) -> Result<rayon::ThreadPool, OpenError> {
    rayon::ThreadPoolBuilder::new()
        .num_threads(config.workers.get())
        .thread_name(move |n| format!("{name}-{n}"))
        .build()
        .map_err(|error| refusal(config, StoreOpenError::Unusable(std::io::Error::other(error))))
}

/// Enters every blob that is a table.
fn rebuild_catalogue(store: &Store, engine: &dyn Engine) -> Result<(), StoreError> {
    let mut tables = 0_usize;
    for blob in store.blobs.list()? {
        let bytes = match store.blobs.get(blob.digest) {
            Ok(Some(bytes)) => bytes,
            // Moved aside, and logged, by the store.
            Ok(None) | Err(StoreError::Corrupt { .. }) => continue,
            Err(error) => return Err(error),
        };
        let Some((recipe, recipe_digest)) = engine.recognise(&bytes) else { continue };
        let row =
            TableRow { digest: blob.digest, recipe_digest, bytes: bytes.len() as u64, created_at: blob.stored_at };
        let mut batch = Batch::default();
        batch.extend(Catalogue::entry(&row, &recipe)?);
        store.rows.commit(&batch)?;
        tables += 1;
    }
    if tables > 0 {
        tracing::warn!(tables, "the catalogue was made again from the blobs");
    }
    Ok(())
}

fn refusal(config: &Config, error: StoreOpenError) -> OpenError {
    let path = config.data_dir.clone();
    match error {
        StoreOpenError::Locked => OpenError::Locked(path),
        StoreOpenError::Unusable(source) => OpenError::Unusable { path, source },
        StoreOpenError::FromTheFuture { found, known } => OpenError::FromTheFuture { path, found, known },
    }
}
