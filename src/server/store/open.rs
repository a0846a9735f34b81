//! Opening the data folder.

use std::{
    fs::{self, File, TryLockError},
    io,
    path::Path,
    sync::{Arc, OnceLock},
};

use super::{
    Batch, Blobs, Damage, FileBlobs, Row, Rows, SledRows, StoreError, Tree, files,
    journal::Journal,
    local_rows::LocalRows,
    migrations::{self, MigrationError, REVISION_BYTES},
    sled_rows::SledOpenError,
};

/// Checks a database that a write error had closed, and may mend it. It must not keep the rows.
pub type ReopenCheck = Box<dyn Fn(&Arc<dyn Rows>) -> Result<(), StoreError> + Send + Sync>;

/// The opened data folder. Other processes are locked out until it is dropped.
pub struct Store {
    /// Tables by digest.
    pub blobs: Arc<dyn Blobs>,
    /// Jobs, shards and the catalogue.
    pub rows: Arc<dyn Rows>,
    /// The damage that was found when it was opened. The catalogue must be compared with the blobs.
    pub damage: Damage,
    /// Runs when a write error closed the database and it was opened again.
    pub reopen_check: Arc<OnceLock<ReopenCheck>>,
    /// Dropping it unlocks the folder. A store that processes share has no folder.
    _lock: Option<File>,
}

impl std::fmt::Debug for Store {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Store").field("damage", &self.damage).finish_non_exhaustive()
    }
}

/// Why a data folder did not open.
#[derive(Debug, thiserror::Error)]
pub enum StoreOpenError {
    /// Another process has opened it.
    #[error("in use by another process")]
    Locked,
    /// It cannot be created, read or written.
    #[error(transparent)]
    Unusable(io::Error),
    /// A later version of the program wrote it.
    #[error("schema {found} is newer than {known}")]
    FromTheFuture {
        /// Its schema.
        found: u32,
        /// The newest schema this program knows.
        known: u32,
    },
}

impl From<StoreError> for StoreOpenError {
    fn from(error: StoreError) -> Self {
        Self::Unusable(match error {
            StoreError::Io { source, .. } => source,
            StoreError::DiskFull => io::ErrorKind::StorageFull.into(),
            other => io::Error::other(other),
        })
    }
}

impl Store {
    /// Opens the data folder `dir`, creates it if it is missing, and applies migrations.
    ///
    /// Every row of the database and every line of the journal is read. A database that does not open or cannot be
    /// read is copied to `quarantine/db-N` and replaced by an empty one. A damaged journal is copied to
    /// `quarantine/jobs.log-N` and written anew without the damaged lines.
    ///
    /// # Errors
    /// See [`StoreOpenError`]. A full disk is [`StoreOpenError::Unusable`]; nothing is moved then.
    pub fn open(dir: &Path) -> Result<Self, StoreOpenError> {
        files::make_folder(dir)?;
        let lock = lock(&dir.join("lock"))?;
        let quarantine = dir.join("quarantine");
        let blobs = FileBlobs::open(&dir.join("blobs"), &quarantine)?;
        let mut damage = Damage::default();
        let (database, journal) = (dir.join("db"), dir.join("jobs.log"));
        let bytes = |path: &Path| fs::metadata(path).map_or(0, |metadata| metadata.len());
        let (had_database, had_journal) = (bytes(&database.join("db")) > 0, bytes(&journal) > 0);
        let was_used = had_database || had_journal || !blobs.list()?.is_empty();
        let sled = open_database(&database, &quarantine, &mut damage)?;
        damage.database_was_replaced |= sled.schema_before == 0 && was_used;
        damage.damaged_rows = sled.damaged_rows;
        let was_journalled = sled.schema_before >= migrations::WITH_JOURNAL || damage.database_was_replaced;
        damage.journal_is_incomplete = was_journalled && !had_journal;
        let earlier = jobs_of_earlier_versions(&sled)?;
        let mut removal = Batch::default();
        for row in &earlier {
            removal.remove(Tree::Jobs, row.key.as_slice());
        }
        let journal = Journal::open(&journal, &quarantine, earlier, &mut damage)?;
        if !removal.is_empty() {
            sled.commit(&removal)?;
        }
        damage.log();
        let reopen_check = Arc::clone(&sled.reopen_check);
        let rows = Arc::new(LocalRows::new(sled, journal));
        Ok(Self { blobs: Arc::new(blobs), rows, damage, reopen_check, _lock: Some(lock) })
    }
}

/// Jobs that an earlier version stored in the database, without their revisions.
fn jobs_of_earlier_versions(sled: &SledRows) -> Result<Vec<Row>, StoreError> {
    let rows = sled.scan(Tree::Jobs, &[])?.into_iter();
    let without_revision = |value: Vec<u8>| Some(value.get(REVISION_BYTES..)?.to_vec());
    Ok(rows.map(|Row { key, value }| Row { key, value: value.and_then(without_revision) }).collect())
}

impl Store {
    /// A store that any number of processes share.
    #[must_use]
    pub fn shared(blobs: Arc<dyn Blobs>, rows: Arc<dyn Rows>) -> Self {
        Self { blobs, rows, damage: Damage::default(), reopen_check: Arc::default(), _lock: None }
    }
}

#[cfg(test)]
impl Store {
    /// A data folder with rows of the test's own.
    pub(crate) fn with_rows(dir: &Path, rows: Arc<dyn Rows>) -> Self {
        Self { rows, ..Self::open(dir).unwrap() }
    }
}

pub(super) fn lock(path: &Path) -> Result<File, StoreOpenError> {
    files::refuse_irregular(path).map_err(StoreOpenError::Unusable)?;
    let file = File::options().create(true).truncate(false).write(true).open(path).map_err(StoreOpenError::Unusable)?;
    match file.try_lock() {
        Ok(()) => Ok(file),
        Err(TryLockError::WouldBlock) => Err(StoreOpenError::Locked),
        Err(TryLockError::Error(source)) => Err(StoreOpenError::Unusable(source)),
    }
}

/// The largest file that is read before sled opens it.
const MOST_STRANGE_BYTES: u64 = 64 << 20;

/// Opens the database of `folder`. One that does not open or cannot be read is copied to `quarantine` and replaced by
/// an empty one.
fn open_database(folder: &Path, quarantine: &Path, damage: &mut Damage) -> Result<SledRows, StoreOpenError> {
    let open = || {
        // What sled reads of its folder.
        let regular = ["db", "conf"].into_iter().try_for_each(|name| files::refuse_irregular(&folder.join(name)));
        regular.map_err(|error| SledOpenError::Damaged(error.to_string()))?;
        SledRows::open(folder, Arc::new(File::sync_all))
    };
    files::make_folder(folder)?;
    let before = strange_bytes(&folder.join("db"));
    let reason = match open() {
        Err(SledOpenError::Damaged(reason)) => reason,
        Ok(sled) => {
            if let Some(bytes) = before.filter(|_| sled.schema_before == 0) {
                let kept = files::keep_in_quarantine(&bytes, quarantine, "db")?;
                tracing::error!(kept = %kept.display(), "the file of the database was another; it was copied to quarantine");
            }
            return Ok(sled);
        }
        Err(error) => return Err(refusal(error)),
    };
    let copied_to = files::copy_to_quarantine(folder, quarantine, "db")?;
    tracing::error!(reason, copied_to = %copied_to.display(), "the damaged database was copied to quarantine");
    damage.database_was_replaced = true;
    fs::remove_dir_all(folder).map_err(StoreOpenError::Unusable)?;
    files::make_folder(folder)?;
    open().map_err(refusal)
}

/// The bytes of the database's file if it may be another file: sled takes one that it does not know for an empty database and
/// writes over it. Larger ones are not kept.
fn strange_bytes(path: &Path) -> Option<Vec<u8>> {
    let is_short = files::regular_length(path).is_ok_and(|bytes| bytes <= MOST_STRANGE_BYTES);
    let bytes = if is_short { files::read_regular(path).ok() } else { None };
    bytes.filter(|bytes| bytes.iter().any(|byte| *byte != 0))
}

fn refusal(error: SledOpenError) -> StoreOpenError {
    match error {
        SledOpenError::Schema(MigrationError::FromTheFuture { found, known }) => {
            StoreOpenError::FromTheFuture { found, known }
        }
        SledOpenError::Unusable(source) => StoreOpenError::Unusable(source),
        other => StoreOpenError::Unusable(io::Error::other(other)),
    }
}

#[cfg(test)]
mod tests;
