//! Starts the service.

use std::{
    collections::BTreeSet,
    io,
    sync::{
        Arc, Mutex, RwLock,
        atomic::{AtomicBool, AtomicU64},
    },
    time::Duration,
};

use super::{
    Config, FileRow, OpenError, Service, TableRow, catalogue::Catalogue, exports::Exports, files::Files,
    fitter::Fitter, forecast::Forecast, hub::Hub, pictures::Pictures, state::State,
};
use crate::{
    queue::{EmbeddedQueue, Limits, Queue},
    store::{Batch, BlobInfo, StoreError},
};
use ltcforge_files::tabulated::is_tabulated;
use ltcforge_fit::FITTER_VERSION;

/// Interval at which leases are renewed and followers are notified. It is longer in a cluster, where each renewal is a
/// database statement.
const RENEW_EMBEDDED: Duration = Duration::from_millis(100);
#[cfg(feature = "cluster")]
const RENEW_SHARED: Duration = Duration::from_millis(500);

impl Service {
    /// Opens the data folder, lists its tables, resumes unfinished jobs and starts the workers.
    ///
    /// # Errors
    /// When the folder is locked, unusable, or from a later version.
    pub fn open(config: Config) -> Result<Arc<Self>, OpenError> {
        let opened = crate::store::open(&config.data_dir);
        let store = opened.map_err(|error| OpenError::Folder(config.data_dir.clone(), error))?;
        let queue = EmbeddedQueue::open(Arc::clone(&store.rows), limits(&config), FITTER_VERSION)?;
        let is_clean = store.is_clean;
        let files = Files::new(store);
        let is_listed = files.list_from_disk()?;
        Self::start(config, files, Box::new(queue), is_clean && is_listed, RENEW_EMBEDDED)
    }

    /// Like [`Service::open`], but with a database and an object store that several processes share.
    ///
    /// # Errors
    /// When the database or the object store cannot be used.
    #[cfg(feature = "cluster")]
    pub fn open_shared(config: Config, shared: &super::Shared) -> Result<Arc<Self>, OpenError> {
        use crate::{
            queue::PostgresQueue,
            store::{Blobs, Database, ObjectBlobs, PostgresRows, Store},
        };
        // The store is opened first, so a wrong URL leaves no schema in the database.
        let blobs: Arc<dyn Blobs> = match shared.store.strip_prefix("file://") {
            Some(folder) => Arc::new(shared_folder(folder.as_ref())?),
            None => Arc::new(ObjectBlobs::open(&shared.store, config.workers > 0)?),
        };
        let database = Database::open_with(&shared.database.0, shared.connections)?;
        let queue = PostgresQueue::new(Arc::clone(&database), limits(&config), FITTER_VERSION);
        let store = Store::shared(blobs, Arc::new(PostgresRows::new(database)));
        Self::start(Config { store_bytes: None, ..config }, Files::new(store), Box::new(queue), true, RENEW_SHARED)
    }

    fn start(
        config: Config,
        files: Files,
        queue: Box<dyn Queue>,
        is_complete: bool,
        renew: Duration,
    ) -> Result<Arc<Self>, OpenError> {
        let threads = config.pool_threads();
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads.get())
            .thread_name(|n| format!("measure-{n}"))
            .build()
            .map_err(io::Error::other)?;
        let workers = config.workers;
        let state = Arc::new(State {
            fitter: Fitter::new(Arc::clone(&files.blobs)),
            forecast: Forecast::new(threads),
            files,
            queue,
            hub: Hub::default(),
            pool,
            running: Mutex::default(),
            leasing: Mutex::default(),
            pictures: Pictures::new(config.adapter, config.picture_time),
            exports: Exports::new(),
            storing: Mutex::default(),
            naming: RwLock::default(),
            is_complete,
            stopping: AtomicBool::new(false),
            entries_fitted: AtomicU64::new(0),
            files_removed: AtomicU64::new(0),
            config,
        });
        let service = Self { state, threads: Mutex::default() };
        service.state.evict();
        service.spawn("renew-leases".to_owned(), move |state| state.renew(renew))?;
        for worker in 0..workers {
            service.spawn(format!("fit-{worker}"), State::work)?;
        }
        Ok(Arc::new(service))
    }
}

/// The blobs in a folder that several processes share.
#[cfg(feature = "cluster")]
fn shared_folder(folder: &std::path::Path) -> Result<crate::store::FolderBlobs, OpenError> {
    if !folder.is_dir() {
        return Err(OpenError::NoFolder(folder.to_owned()));
    }
    // The quarantine is one folder deeper than the blobs, so its files are not listed as blobs.
    Ok(crate::store::FolderBlobs::shared(folder, &folder.join("quarantine/files"))?)
}

impl Files {
    /// Updates the catalogue: adds rows for files without a row, and removes rows without a file. Returns whether all
    /// changes could be stored.
    fn list_from_disk(&self) -> Result<bool, StoreError> {
        let (mut is_complete, lost) = self.list_new_files()?;
        for digest in lost {
            tracing::warn!(%digest, "the file is missing; removing its row from the catalogue");
            let removed = self.catalogue.removal(digest).and_then(|batch| self.catalogue.rows.commit(&batch));
            is_complete &= removed.is_ok();
        }
        Ok(is_complete)
    }

    /// Adds rows for files without a row. Returns whether all rows could be stored, and the rows without a file.
    pub(super) fn list_new_files(&self) -> Result<(bool, BTreeSet<ltcforge_files::digest::Digest>), StoreError> {
        let blobs = self.blobs.list()?;
        let mut rows: BTreeSet<_> = self.catalogue.tables()?.into_iter().map(|row| row.digest).collect();
        rows.extend(self.catalogue.brdfs()?.into_iter().map(|row| row.digest));
        let mut is_complete = true;
        for blob in blobs {
            if rows.remove(&blob.digest) {
                continue;
            }
            let batch = match self.describe(&blob) {
                Ok(Some(batch)) => batch,
                Ok(None) => continue,
                Err(error) => {
                    tracing::error!(blob = %blob.digest, %error, "the file could not be added to the catalogue");
                    is_complete = false;
                    continue;
                }
            };
            is_complete &= self.catalogue.rows.commit(&batch).is_ok();
            tracing::warn!(blob = %blob.digest, "the file was not in the catalogue; adding it");
        }
        Ok((is_complete, rows))
    }

    /// The rows that describe a file. `None` if the file is neither a table nor a BRDF.
    fn describe(&self, blob: &BlobInfo) -> Result<Option<Batch>, StoreError> {
        let Some(file) = self.blobs.get(blob.digest)? else { return Ok(None) };
        let BlobInfo { digest, bytes, stored_at: created_at, .. } = *blob;
        if is_tabulated(&file) {
            return Catalogue::brdf_entry(&FileRow { digest, bytes, created_at }).map(Some);
        }
        let Some((recipe, recipe_digest)) = Fitter::recognise(&file) else { return Ok(None) };
        Catalogue::table_entry(&TableRow { digest, recipe_digest, bytes, created_at }, &recipe).map(Some)
    }
}

fn limits(config: &Config) -> Limits {
    Limits {
        jobs: config.queue_limit,
        lease_ttl: config.lease_ttl,
        keep_ended: config.keep_ended,
        most_ended: Some(MOST_ENDED),
    }
}

/// Maximum number of ended jobs that are remembered.
const MOST_ENDED: usize = 100_000;
