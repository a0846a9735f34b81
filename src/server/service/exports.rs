//! Exports of the stored tables: files that engines load, made once and kept in memory.

use std::{
    sync::{
        Arc, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicU64, AtomicUsize, Ordering},
    },
    time::Duration,
};

use super::{ServiceError, cache::Cache};
use ltcforge_files::digest::Digest;
use ltcforge_textures::{Bundle, ExportError, RoundingError, TextureFile};

/// Requests for exports that may wait at the same time: one export is made at a time, so that memory holds the numbers of
/// one.
const LIMIT: usize = 16;
/// When to try again if as many wait. Most exports take less than a second.
const RETRY_FULL: Duration = Duration::from_secs(2);

/// A file of an export.
#[derive(Debug, Clone)]
pub struct ExportedFile {
    /// Its path in the export, with `/` between names.
    pub path: String,
    /// Its bytes.
    pub bytes: Arc<Vec<u8>>,
    /// Their digest.
    pub digest: Digest,
    /// What rounding changed.
    pub rounding: RoundingError,
}

/// An export of a table.
#[derive(Debug)]
pub struct MadeExport {
    /// Its files.
    pub files: Vec<ExportedFile>,
    /// What to do with them, a sentence each.
    pub steps: Vec<String>,
}

impl From<Bundle> for MadeExport {
    fn from(Bundle { files, steps }: Bundle) -> Self {
        let file = |TextureFile { path, bytes, rounding }| {
            let digest = Digest::of(&bytes);
            ExportedFile { path, bytes: Arc::new(bytes), digest, rounding }
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
    /// The table has more entries than are exported.
    #[error(
        "the table has {entries} entries, and of at most {limit} the service makes exports; `ltcforge export` makes any"
    )]
    TooLarge {
        /// Its entries.
        entries: usize,
        /// Most entries.
        limit: usize,
    },
    /// Too many exports are asked for at the same time.
    #[error("{limit} requests for exports are waiting already")]
    QueueFull {
        /// Most requests that may wait.
        limit: usize,
        /// When to try again.
        retry_after: Duration,
    },
    /// The table could not be read or measured.
    #[error(transparent)]
    Store(#[from] ServiceError),
}

/// The exports made so far, and whose turn it is to make one.
#[derive(Debug)]
pub(super) struct Exports {
    kept: Mutex<Cache<Arc<MadeExport>>>,
    /// Held while an export is made.
    turn: Mutex<()>,
    waiting: AtomicUsize,
    made: AtomicU64,
}

/// A request that waits for its turn, or has it.
struct Waiting<'a>(&'a AtomicUsize);

impl Drop for Waiting<'_> {
    fn drop(&mut self) {
        self.0.fetch_sub(1, Ordering::SeqCst);
    }
}

impl Exports {
    /// Keeps up to `limit_bytes` of files.
    pub(super) fn new(limit_bytes: usize) -> Self {
        let kept = Mutex::new(Cache::new(limit_bytes));
        Self { kept, turn: Mutex::new(()), waiting: AtomicUsize::new(0), made: AtomicU64::new(0) }
    }

    /// How many were made.
    pub(super) fn made(&self) -> u64 {
        self.made.load(Ordering::Relaxed)
    }

    /// How many requests wait, or have their turn.
    #[cfg(test)]
    pub(super) fn waiting(&self) -> usize {
        self.waiting.load(Ordering::SeqCst)
    }

    fn kept(&self) -> MutexGuard<'_, Cache<Arc<MadeExport>>> {
        self.kept.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The export of `key`, from memory or as `make` makes it, one at a time. `None` is not remembered.
    pub(super) fn get(
        &self,
        key: Digest,
        make: impl FnOnce() -> Result<Option<MadeExport>, ExportFailure>,
    ) -> Result<Option<Arc<MadeExport>>, ExportFailure> {
        if let Some(kept) = self.kept().get(key) {
            return Ok(Some(kept));
        }
        let _waiting = Waiting(&self.waiting);
        if self.waiting.fetch_add(1, Ordering::SeqCst) >= LIMIT {
            return Err(ExportFailure::QueueFull { limit: LIMIT, retry_after: RETRY_FULL });
        }
        let _turn = self.turn.lock().unwrap_or_else(PoisonError::into_inner);
        // An equal request may have had its turn before.
        if let Some(kept) = self.kept().get(key) {
            return Ok(Some(kept));
        }
        let made = make()?.map(Arc::new);
        if let Some(export) = &made {
            self.made.fetch_add(1, Ordering::Relaxed);
            let bytes = export.files.iter().map(|file| file.bytes.len()).sum();
            self.kept().keep(key, bytes, Arc::clone(export));
        }
        Ok(made)
    }
}
