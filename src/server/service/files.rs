//! Reads stored files, verifies them against their digests, and caches them in bounded memory.

use std::{
    collections::BTreeSet,
    mem,
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicU64, Ordering},
    },
};

use bytes::Bytes;
use quick_cache::{Weighter, sync::Cache};

use super::{ServiceError, catalogue::Catalogue};
use crate::store::{Blobs, Store, StoreError};
use ltcforge_files::{digest::Digest, tabulated::is_tabulated};

/// The kinds of stored files.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FileKind {
    /// A table.
    Table,
    /// A tabulated BRDF.
    Brdf,
}

impl FileKind {
    /// The kind of a file with these bytes.
    fn of(bytes: &[u8]) -> Self {
        if is_tabulated(bytes) { Self::Brdf } else { Self::Table }
    }
}

/// Maximum bytes of verified files in memory.
const CACHE_BYTES: u64 = 256 << 20;
/// Number of files that the cache expects. For many more, the cache would split its bytes into parts that are too small
/// for a large file.
const CACHE_FILES: usize = 32;

#[derive(Debug, Clone)]
struct FileBytes;

impl Weighter<Digest, Bytes> for FileBytes {
    fn weight(&self, _: &Digest, bytes: &Bytes) -> u64 {
        bytes.len() as u64
    }
}

/// The files of a store and their catalogue.
#[derive(Debug)]
pub(super) struct Files {
    pub(super) blobs: Arc<dyn Blobs>,
    pub(super) catalogue: Catalogue,
    cache: Cache<Digest, Bytes, FileBytes>,
    /// Files that were served from memory since uses were last recorded.
    served: Mutex<BTreeSet<Digest>>,
    corrupt: AtomicU64,
    /// Keeps the data folder locked.
    _store: Store,
}

impl Files {
    pub(super) fn new(store: Store) -> Self {
        Self {
            blobs: Arc::clone(&store.blobs),
            catalogue: Catalogue { rows: Arc::clone(&store.rows) },
            cache: Cache::with_weighter(CACHE_FILES, CACHE_BYTES, FileBytes),
            served: Mutex::default(),
            corrupt: AtomicU64::new(0),
            _store: store,
        }
    }

    /// The verified bytes of a file of this kind, if they are in memory.
    pub(super) fn cached(&self, kind: FileKind, digest: Digest) -> Option<Bytes> {
        let bytes = self.cache.get(&digest).filter(|bytes| FileKind::of(bytes) == kind)?;
        self.served.lock().unwrap_or_else(PoisonError::into_inner).insert(digest);
        Some(bytes)
    }

    /// The verified bytes of a file of this kind. Concurrent callers share one read.
    ///
    /// # Errors
    /// When the file is damaged or unreadable. A damaged file is removed from the catalogue, so submitting its recipe
    /// fits it again.
    pub(super) fn read(&self, kind: FileKind, digest: Digest) -> Result<Option<Bytes>, ServiceError> {
        let read = self.cache.get_or_insert_with(&digest, || match self.blobs.get(digest) {
            Ok(Some(bytes)) => Ok(Bytes::from(bytes)),
            Ok(None) => Err(None),
            Err(error) => Err(Some(error)),
        });
        match read {
            Ok(bytes) => {
                self.used(digest);
                Ok(Some(bytes).filter(|bytes| FileKind::of(bytes) == kind))
            }
            Err(None) => Ok(None),
            Err(Some(error)) => {
                if matches!(error, StoreError::Corrupt { .. }) {
                    self.corrupt.fetch_add(1, Ordering::Relaxed);
                    self.forget_rows(digest);
                }
                Err(error.into())
            }
        }
    }

    /// Whether the file exists. Its bytes are not read.
    pub(super) fn contains(&self, digest: Digest) -> Result<bool, StoreError> {
        Ok(self.blobs.stat(digest)?.is_some())
    }

    /// Records the uses of files that were served from memory.
    pub(super) fn record_uses(&self) {
        let served = mem::take(&mut *self.served.lock().unwrap_or_else(PoisonError::into_inner));
        for digest in served {
            self.used(digest);
        }
    }

    /// Records the use of a file.
    pub(super) fn used(&self, digest: Digest) {
        if let Err(error) = self.blobs.touch(digest) {
            tracing::debug!(%digest, %error, "could not record the use of the file");
        }
    }

    /// Deletes a file, then its rows. On a full disk the rows may stay. Rows without a file do no harm.
    pub(super) fn delete(&self, digest: Digest) -> Result<(), StoreError> {
        self.blobs.delete(digest)?;
        self.cache.remove(&digest);
        self.forget_rows(digest);
        Ok(())
    }

    fn forget_rows(&self, digest: Digest) {
        let forgotten = self.catalogue.removal(digest).and_then(|batch| self.catalogue.rows.commit(&batch));
        if let Err(error) = forgotten {
            tracing::warn!(%digest, %error, "could not remove the rows of a deleted file");
        }
    }

    /// The table of a recipe, if it is in the catalogue and its file exists.
    pub(super) fn of_recipe(&self, recipe_digest: Digest) -> Result<Option<Digest>, StoreError> {
        let Some((_, table)) = self.catalogue.recipe(recipe_digest)? else { return Ok(None) };
        Ok(self.contains(table)?.then_some(table))
    }

    /// Number of files found damaged since the start.
    pub(super) fn corrupt(&self) -> u64 {
        self.corrupt.load(Ordering::Relaxed)
    }
}
