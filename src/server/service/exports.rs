//! Exports of stored tables: files for engines, made once and kept in memory.

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
use ltcforge_textures::{Bundle, Export, ExportError, LutExportError, RoundingError, TextureFile};

/// Maximum number of waiting requests for exports. One export is made at a time, so that only one table is decoded in
/// memory.
const LIMIT: usize = 16;
/// `Retry-After` if this many requests wait. Most exports take less than a second.
const RETRY_FULL: Duration = Duration::from_secs(2);

/// A file of an export.
#[derive(Debug, Clone)]
pub struct ExportedFile {
    /// The path within the export, with `/` between names.
    pub path: String,
    /// The bytes.
    pub bytes: Bytes,
    /// The digest of the bytes.
    pub digest: Digest,
    /// The error from rounding the numbers of the file.
    pub rounding: RoundingError,
}

/// An export of a table.
#[derive(Debug)]
pub struct MadeExport {
    /// The files.
    pub files: Vec<ExportedFile>,
    /// The steps to use the files. Each step is a sentence.
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
    /// The table does not support this export.
    #[error(transparent)]
    Refused(#[from] ExportError),
    /// The lookup table does not support this export.
    #[error(transparent)]
    Lut(#[from] LutExportError),
    /// The table has too many entries. The values are their number, and the limit.
    #[error("the table has {0} entries, and the service exports tables of at most {1}; use `ltcforge export` instead")]
    TooLarge(usize, usize),
    /// Too many requests for exports are waiting. The values are the limit, and when to try again.
    #[error("{0} requests for exports are waiting, which is the limit; try again later")]
    QueueFull(usize, Duration),
    /// The table could not be read or measured.
    #[error(transparent)]
    Store(#[from] ServiceError),
}

/// The latest exports, and the waiting requests.
#[derive(Debug)]
pub(super) struct Exports {
    kept: Cache<Digest, Arc<MadeExport>, FileBytes>,
    /// Locked while an export is made.
    making: Mutex<()>,
    /// A permit for each waiting request.
    waiting: Semaphore,
    made: AtomicU64,
}

/// Maximum bytes of exports in memory.
const KEPT_BYTES: u64 = 128 << 20;
/// Number of exports that the cache expects. For more than 62, the cache would split its bytes into several parts, and
/// a large export would not fit into any part.
const EXPECTED: usize = 32;

/// The key of a table's export in the cache.
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

    /// Forgets the exports of a removed table.
    pub(super) fn forget(&self, table: Digest) {
        for export in Export::all() {
            self.kept.remove(&key(table, export));
        }
    }

    /// Number of exports made since the start.
    pub(super) fn made(&self) -> u64 {
        self.made.load(Ordering::Relaxed)
    }

    /// The export of `key`, from memory or from `make`. Only one `make` runs at a time. `None` is not kept in memory.
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
        // Another request may have made the same export meanwhile.
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
