//! When stored files were last used, and which tables were removed.
//!
//! A request costs no write: uses are kept in memory, and written together once a minute. A process that is killed loses those
//! of the last minute, which matters to nothing but the order in which files are removed.

use std::{
    collections::HashMap,
    fmt,
    sync::{Mutex, MutexGuard, PoisonError},
    time::{Duration, Instant},
};

use jiff::Timestamp;
use serde::{Deserialize, Serialize};

use crate::store::{Batch, Rows, StoreError, Tree};
use ltcforge_files::digest::Digest;

/// How often uses are written.
pub(super) const FLUSH: Duration = Duration::from_secs(60);

/// What is stored about the use of a file.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct UseRow {
    /// When it was last used.
    pub(super) used_at: Timestamp,
    /// Set once it is a table that was removed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) removed: Option<RemovedTable>,
}

/// A table that was removed.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct RemovedTable {
    /// When.
    pub at: Timestamp,
    /// Why.
    pub why: RemovalReason,
    /// The recipe of which it is fitted again, to the same bytes by the same fitter.
    pub recipe: String,
    /// Whether its file may still be there: it goes after the rows, and the process may have ended in between.
    pub(super) has_file: bool,
}

/// Why a table was removed.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RemovalReason {
    /// The store was larger than it may be, and the table was used longest ago.
    StoreBytes,
    /// A user deleted it: the name of a token, where one was needed.
    Deleted(Option<String>),
}

impl fmt::Display for RemovalReason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::StoreBytes => {
                f.write_str("it was used longest ago, and the store was larger than `--store-bytes` of the service")
            }
            Self::Deleted(Some(name)) => write!(f, "«{name}» deleted it"),
            Self::Deleted(None) => f.write_str("it was deleted"),
        }
    }
}

/// Uses since they were last written.
#[derive(Debug, Default)]
pub(super) struct Uses(Mutex<HashMap<Digest, Instant>>);

impl Uses {
    fn lock(&self) -> MutexGuard<'_, HashMap<Digest, Instant>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Notes that a file is being used.
    pub(super) fn note(&self, digest: Digest) {
        self.lock().insert(digest, Instant::now());
    }

    /// Whether a use is not written yet.
    pub(super) fn has(&self, digest: Digest) -> bool {
        self.lock().contains_key(&digest)
    }

    /// Those since the last time.
    pub(super) fn take(&self) -> HashMap<Digest, Instant> {
        std::mem::take(&mut self.lock())
    }

    /// Takes back what could not be written.
    pub(super) fn put_back(&self, uses: HashMap<Digest, Instant>) {
        let mut noted = self.lock();
        for (digest, at) in uses {
            noted.entry(digest).or_insert(at);
        }
    }
}

impl UseRow {
    /// Puts the row of a file into `batch`.
    pub(super) fn put(&self, batch: &mut Batch, digest: Digest) -> Result<(), StoreError> {
        let value = serde_json::to_vec(self).map_err(|error| StoreError::Database(error.to_string()))?;
        batch.put(Tree::Uses, *digest.as_bytes(), value);
        Ok(())
    }
}

/// What is stored about the use of a file. A damaged row counts as absent.
pub(super) fn use_of(rows: &dyn Rows, digest: Digest) -> Result<Option<UseRow>, StoreError> {
    match rows.get(Tree::Uses, digest.as_bytes()) {
        Ok(value) => Ok(value.and_then(|value| serde_json::from_slice(&value).ok())),
        Err(StoreError::DamagedRow { .. }) => Ok(None),
        Err(error) => Err(error),
    }
}
