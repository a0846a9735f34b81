//! Exports of the stored tables: files that engines load, made once and kept in memory.

use std::{
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicU64, Ordering},
    },
    time::Duration,
};

use bytes::Bytes;
use quick_cache::{Weighter, sync::Cache};
use tokio::sync::Semaphore;

use super::ServiceError;
use ltcforge_files::digest::Digest;
use ltcforge_textures::{Bundle, Export, ExportError, RoundingError, TextureFile};

/// Requests for exports that may wait at the same time. One export is made at a time, so that memory holds the numbers
/// of one table.
const LIMIT: usize = 16;
/// When to try again if that many wait. Most exports take less than a second.
const RETRY_FULL: Duration = Duration::from_secs(2);

/// A file of an export.
#[derive(Debug, Clone)]
pub struct ExportedFile {
    /// Its path in the export, with `/` between names.
    pub path: String,
    /// Its bytes.
    pub bytes: Bytes,
    /// Their digest.
    pub digest: Digest,
    /// How far rounding moved its numbers.
    pub rounding: RoundingError,
}

/// An export of a table.
#[derive(Debug)]
pub struct MadeExport {
    /// Its files.
    pub files: Vec<ExportedFile>,
    /// How to use them, a sentence each.
    pub steps: Vec<String>,
}

impl From<Bundle> for MadeExport {
    fn from(Bundle { files, steps }: Bundle) -> Self {
        let file = |TextureFile { path, bytes, rounding }| {
            let digest = Digest::of(&bytes);
            ExportedFile { path, bytes: bytes.into(), digest, rounding }
        };
        Self { files: files.into_iter().map(file).collect(), steps }
    }
}

/// Why a table was not exported.
#[derive(Debug, Clone, thiserror::Error)]
pub enum ExportFailure {
    /// The table has no such files.
    #[error(transparent)]
    Refused(#[from] ExportError),
    /// The table has more entries than are exported: its entries, and the limit.
    #[error("the table has {0} entries, and the service exports at most {1}; `ltcforge export` exports any table")]
    TooLarge(usize, usize),
    /// Too many exports are asked for at the same time: the limit, and when to try again.
    #[error("{0} requests for exports are waiting already")]
    QueueFull(usize, Duration),
    /// The table could not be read or measured.
    #[error(transparent)]
    Store(#[from] ServiceError),
}

/// The exports made last, and the requests for others.
#[derive(Debug)]
pub(super) struct Exports {
    kept: Cache<Digest, Arc<MadeExport>, FileBytes>,
    /// Held while an export is made.
    making: Mutex<()>,
    /// A permit for each request that may wait.
    waiting: Semaphore,
    made: AtomicU64,
}

/// Bytes of exports that are kept in memory.
const KEPT_BYTES: u64 = 128 << 20;
/// How many exports the cache expects. For more than 62 it would divide its bytes among several parts, and a large
/// export would fit into none.
const EXPECTED: usize = 32;

/// The name of an export of a table among those that are kept.
pub(super) fn key(table: Digest, export: Export) -> Digest {
    Digest::of(format!("{export} of {table}").as_bytes())
}

/// Counts the bytes of an export's files.
#[derive(Debug, Clone)]
struct FileBytes;

impl Weighter<Digest, Arc<MadeExport>> for FileBytes {
    fn weight(&self, _key: &Digest, export: &Arc<MadeExport>) -> u64 {
        export.files.iter().map(|file| file.bytes.len() as u64).sum()
    }
}

impl Exports {
    pub(super) fn new() -> Self {
        let kept = Cache::with_weighter(EXPECTED, KEPT_BYTES, FileBytes);
        Self { kept, making: Mutex::new(()), waiting: Semaphore::new(LIMIT), made: AtomicU64::new(0) }
    }

    /// Forgets those of a table that was removed.
    pub(super) fn forget(&self, table: Digest) {
        for export in Export::all() {
            self.kept.remove(&key(table, export));
        }
    }

    /// How many were made.
    pub(super) fn made(&self) -> u64 {
        self.made.load(Ordering::Relaxed)
    }

    /// The export of `key`, from memory or as `make` makes it, one at a time. `None` is not remembered.
    pub(super) fn get(
        &self,
        key: Digest,
        make: impl FnOnce() -> Result<Option<MadeExport>, ExportFailure>,
    ) -> Result<Option<Arc<MadeExport>>, ExportFailure> {
        if let Some(kept) = self.kept.get(&key) {
            return Ok(Some(kept));
        }
        let _place = self.waiting.try_acquire().map_err(|_| ExportFailure::QueueFull(LIMIT, RETRY_FULL))?;
        let _making = self.making.lock().unwrap_or_else(PoisonError::into_inner);
        // An equal request may have been answered before.
        if let Some(kept) = self.kept.get(&key) {
            return Ok(Some(kept));
        }
        let made = make()?.map(Arc::new);
        if let Some(export) = &made {
            self.made.fetch_add(1, Ordering::Relaxed);
            self.kept.insert(key, Arc::clone(export));
        }
        Ok(made)
    }
}
