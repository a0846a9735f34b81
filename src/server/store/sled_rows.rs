//! [`Rows`] in sled.
//!
//! This module works around these properties of sled 0.34.7:
//! - `flush` ends in `sync_file_range`, which does not survive a power cut. Every commit ends in an fsync of the
//!   database file.
//! - Truncated files can cause a panic inside sled. It is opened on a thread whose panic is caught.
//! - After a write error, such as a full disk, an open database refuses every operation. It is closed, and the next
//!   operation opens it again. It may have lost rows then, so it is checked as at the start before anyone reads it.
//! - It cannot be opened on a full disk. A copy on another disk, or in memory, is read until there is room.
//! - Some damage is found only when a row is read. All rows are read when it is opened.
//! - sled's threads may keep the files locked for a moment after the database is dropped. Opening waits for that.

use std::{
    env,
    fs::{File, TryLockError},
    io,
    path::{Path, PathBuf},
    sync::{
        Arc, OnceLock, PoisonError, RwLock, RwLockReadGuard,
        atomic::{AtomicU64, Ordering},
    },
    thread,
    time::{Duration, Instant, SystemTime},
};

use sled::transaction::{TransactionError, Transactional as _};
use tempfile::TempDir;

use super::{
    Batch, ReopenCheck, Row, Rows, Staged, StoreError, Tree,
    error::is_full,
    files,
    migrations::{self, MigrationError},
    rows,
};

/// Memory for sled's page cache. The rows of all unfinished jobs fit into it.
const CACHE_BYTES: u64 = 16 << 20;

/// Room that a commit leaves on the disk. sled's log grows by segments of 512 KiB, of which two may be open, and sled
/// must not run into a full disk while it writes in the background.
const HEADROOM_BYTES: u64 = 2 << 20;

/// Room beyond that for a job of many shards.
const JOB_BYTES: u64 = 1 << 20;

/// How long a closed database may stay locked.
const RELEASE: Duration = Duration::from_secs(2);

/// Makes the file's contents durable: `File::sync_all`, or a test's replacement.
pub(super) type SyncFn = Arc<dyn Fn(&File) -> io::Result<()> + Send + Sync>;

/// sled panics where the clock is before 1970, which would pass for damage.
fn check_clock(now: SystemTime) -> io::Result<()> {
    match now.duration_since(SystemTime::UNIX_EPOCH) {
        Ok(_) => Ok(()),
        Err(_) => Err(io::Error::other("this machine's clock says a time before 1970; set the clock")),
    }
}

/// Why the database did not open.
#[derive(Debug, thiserror::Error)]
pub(super) enum SledOpenError {
    /// The schema does not fit this program.
    #[error(transparent)]
    Schema(MigrationError),
    /// The disk is full, or the folder cannot be read or written. The data may be intact.
    #[error(transparent)]
    Unusable(io::Error),
    /// Its files are damaged.
    #[error("{0}")]
    Damaged(String),
}

/// Rows in a sled database.
pub struct SledRows {
    folder: PathBuf,
    sync: SyncFn,
    /// `None` after a write error.
    handle: RwLock<Option<Handle>>,
    /// How often it was opened.
    openings: AtomicU64,
    /// Runs after the database was opened again, before anyone else reads it. If it fails, the database stays closed.
    pub(super) reopen_check: Arc<OnceLock<ReopenCheck>>,
    /// Migrations that had been applied before it was opened.
    pub(super) schema_before: usize,
    /// Rows that did not match their hash when it was opened.
    pub(super) damaged_rows: usize,
}

struct Handle {
    db: sled::Db,
    trees: [sled::Tree; Tree::ALL.len()],
    /// sled's data file, for the fsync.
    file: File,
    /// Migrations that had been applied before it was opened.
    schema_before: usize,
    /// Rows that did not match their hash when it was opened.
    damaged_rows: usize,
    /// Number of the opening, of all since the process has begun.
    opening: u64,
    /// The folder of a copy that was opened because the disk is full. It is only read.
    copy: Option<TempDir>,
}

impl std::fmt::Debug for SledRows {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("SledRows").field("folder", &self.folder).finish_non_exhaustive()
    }
}

impl Handle {
    fn tree(&self, tree: Tree) -> &sled::Tree {
        &self.trees[tree as usize]
    }

    fn apply(&self, batch: &Batch) -> Result<(), sled::Error> {
        if batch.is_empty() {
            return Ok(());
        }
        if self.copy.is_some() {
            return Err(sled::Error::Io(io::ErrorKind::StorageFull.into()));
        }
        let mut touched: Vec<Tree> = batch.changes.iter().map(|(tree, ..)| *tree).collect();
        touched.sort_unstable();
        touched.dedup();
        let trees: Vec<sled::Tree> = touched.iter().map(|tree| self.tree(*tree).clone()).collect();
        let result = trees.as_slice().transaction(|views| {
            for (tree, key, value) in &batch.changes {
                // `touched` has every tree of the batch.
                let Some((_, view)) = touched.iter().zip(views).find(|(name, _)| *name == tree) else { continue };
                match value {
                    Some(value) => view.insert(key.as_slice(), rows::seal(tree.name(), key, value))?,
                    None => view.remove(key.as_slice())?,
                };
            }
            Ok::<(), sled::transaction::ConflictableTransactionError<()>>(())
        });
        match result {
            Ok(()) | Err(TransactionError::Abort(())) => Ok(()),
            Err(TransactionError::Storage(error)) => Err(error),
        }
    }
}

impl SledRows {
    /// Opens or creates the database in `folder`, brings its schema up to date and reads every row.
    pub(super) fn open(folder: &Path, sync: SyncFn) -> Result<Self, SledOpenError> {
        let handle = match open_caught(folder) {
            Err(SledOpenError::Unusable(source)) if is_full(source.kind()) => open_copy(folder, source)?,
            opened => opened?,
        };
        sync(&handle.file).map_err(SledOpenError::Unusable)?;
        Ok(Self {
            folder: folder.to_owned(),
            sync,
            openings: AtomicU64::new(0),
            reopen_check: Arc::default(),
            schema_before: handle.schema_before,
            damaged_rows: handle.damaged_rows,
            handle: RwLock::new(Some(handle)),
        })
    }

    /// Runs `operation` on the database. If an earlier write error closed it, it is opened again.
    fn with<T>(&self, operation: impl FnOnce(&Handle) -> Result<T, sled::Error>) -> Result<T, StoreError> {
        let guard = loop {
            let guard: RwLockReadGuard<'_, _> = self.handle.read().unwrap_or_else(PoisonError::into_inner);
            if guard.is_some() {
                break guard;
            }
            drop(guard);
            let mut slot = self.handle.write().unwrap_or_else(PoisonError::into_inner);
            if slot.is_none() {
                let opening = self.openings.fetch_add(1, Ordering::Relaxed) + 1;
                *slot = Some(Handle { opening, ..self.reopen()? });
            }
        };
        let Some(handle) = guard.as_ref() else {
            return Err(StoreError::Database("the database is closed".to_owned()));
        };
        let result = operation(handle);
        if matches!(result, Err(sled::Error::Io(_))) {
            drop(guard);
            tracing::error!("the database was closed after a write error");
            *self.handle.write().unwrap_or_else(PoisonError::into_inner) = None;
        }
        result.map_err(|error| StoreError::of_sled(&error))
    }

    /// Opens the database again and checks it.
    fn reopen(&self) -> Result<Handle, StoreError> {
        let fresh = Self::open(&self.folder, Arc::clone(&self.sync)).map_err(|error| match error {
            SledOpenError::Unusable(source) => StoreError::of_io(&self.folder, source),
            // The next start makes a copy of it and restores its rows.
            other => StoreError::Database(format!("{other}; it stays closed until the service is started again")),
        })?;
        if fresh.schema_before == 0 {
            tracing::error!("sled could not read its file and started over");
        }
        if fresh.damaged_rows > 0 {
            tracing::error!(rows = fresh.damaged_rows, "rows of the database are damaged");
        }
        let fresh = Arc::new(fresh);
        if let Some(check) = self.reopen_check.get() {
            check(&(Arc::clone(&fresh) as Arc<dyn Rows>))?;
        }
        let handle = Arc::into_inner(fresh).and_then(|rows| rows.handle.into_inner().ok()?);
        tracing::warn!("the database was opened again and checked");
        handle.ok_or_else(|| StoreError::Database("it closed while it was checked".to_owned()))
    }

    fn flush(&self, handle: &Handle) -> Result<(), sled::Error> {
        handle.db.flush()?;
        (self.sync)(&handle.file).map_err(sled::Error::Io)
    }

    /// Whether the disk has room for `batch` and sled's writes in the background.
    pub(super) fn ensure_room(&self, batch: &Batch) -> Result<(), StoreError> {
        let free = files::free_bytes(&self.folder).map_err(|source| StoreError::of_io(&self.folder, source))?;
        if free < HEADROOM_BYTES + batch.bytes() as u64 {
            return Err(StoreError::DiskFull);
        }
        let is_copy = |handle: &Option<Handle>| handle.as_ref().is_some_and(|handle| handle.copy.is_some());
        if is_copy(&self.handle.read().unwrap_or_else(PoisonError::into_inner)) {
            // The next operation opens the database itself.
            let mut slot = self.handle.write().unwrap_or_else(PoisonError::into_inner);
            slot.take_if(|handle| handle.copy.is_some());
        }
        Ok(())
    }
}

impl Rows for SledRows {
    fn get(&self, tree: Tree, key: &[u8]) -> Result<Option<Vec<u8>>, StoreError> {
        let Some(sealed) = self.with(|handle| handle.tree(tree).get(key))? else { return Ok(None) };
        match rows::unseal(tree.name(), key, &sealed) {
            Some(value) => Ok(Some(value)),
            None => Err(StoreError::DamagedRow { tree, key: key.to_vec() }),
        }
    }

    fn scan(&self, tree: Tree, prefix: &[u8]) -> Result<Vec<Row>, StoreError> {
        self.with(|handle| handle.tree(tree).scan_prefix(prefix).map(|row| opened(tree, row)).collect())
    }

    fn page(&self, tree: Tree, before: Option<&[u8]>, limit: usize) -> Result<Vec<Row>, StoreError> {
        self.with(|handle| {
            let rows = match before {
                Some(before) => handle.tree(tree).range(..before),
                None => handle.tree(tree).iter(),
            };
            rows.rev().take(limit).map(|row| opened(tree, row)).collect()
        })
    }

    fn commit(&self, batch: &Batch) -> Result<(), StoreError> {
        self.ensure_room(batch)?;
        self.with(|handle| {
            handle.apply(batch)?;
            self.flush(handle)
        })
    }

    fn is_writable(&self) -> bool {
        files::free_bytes(&self.folder).is_ok_and(|free| free >= HEADROOM_BYTES + JOB_BYTES)
    }

    fn stage(&self, batch: &Batch) -> Result<Staged, StoreError> {
        self.ensure_room(batch)?;
        self.with(|handle| {
            handle.apply(batch)?;
            Ok(Staged(handle.opening))
        })
    }

    fn settle(&self, staged: Staged) -> Result<(), StoreError> {
        let is_settled = self.with(|handle| {
            if handle.opening != staged.0 {
                return Ok(false);
            }
            self.flush(handle)?;
            Ok(true)
        })?;
        if is_settled {
            return Ok(());
        }
        Err(StoreError::Database("it was closed by a write error while rows were on their way to the disk".to_owned()))
    }
}

fn opened(tree: Tree, row: sled::Result<(sled::IVec, sled::IVec)>) -> sled::Result<Row> {
    row.map(|(key, sealed)| Row { key: key.to_vec(), value: rows::unseal(tree.name(), &key, &sealed) })
}

/// Opens a copy of the database where there is room, or fails with `full`.
fn open_copy(folder: &Path, full: io::Error) -> Result<Handle, SledOpenError> {
    for elsewhere in [env::temp_dir(), "/dev/shm".into()] {
        let copied = TempDir::with_prefix_in("ltcforge-", elsewhere).and_then(|copy| {
            files::copy_folder(folder, copy.path())?;
            Ok(copy)
        });
        let Ok(copy) = copied else { continue };
        if let Ok(handle) = open_caught(copy.path()) {
            tracing::error!("the disk is full: the database is only read, until there is room");
            return Ok(Handle { copy: Some(copy), ..handle });
        }
    }
    Err(SledOpenError::Unusable(full))
}

/// Opens the database on a separate thread, so that a panic inside sled becomes an error.
fn open_caught(folder: &Path) -> Result<Handle, SledOpenError> {
    check_clock(SystemTime::now()).map_err(SledOpenError::Unusable)?;
    let folder = folder.to_owned();
    let opening = thread::Builder::new().name("open-database".to_owned()).spawn(move || open(&folder));
    match opening.map_err(SledOpenError::Unusable)?.join() {
        Ok(result) => result,
        Err(_) => Err(SledOpenError::Damaged("sled panicked while it read its files".to_owned())),
    }
}

fn open(folder: &Path) -> Result<Handle, SledOpenError> {
    let refused = |error: sled::Error| match error {
        // A truncated file causes these. Other I/O errors do not mean that the data is damaged.
        sled::Error::Io(source)
            if matches!(source.kind(), io::ErrorKind::UnexpectedEof | io::ErrorKind::InvalidData) =>
        {
            SledOpenError::Damaged(source.to_string())
        }
        sled::Error::Io(source) => SledOpenError::Unusable(source),
        other => SledOpenError::Damaged(other.to_string()),
    };
    let db = open_sled(folder).map_err(refused)?;
    let applied = migrations::apply(&db, migrations::ALL).map_err(|error| match error {
        MigrationError::Sled(error) => refused(error),
        other => SledOpenError::Schema(other),
    })?;
    let mut trees = Vec::with_capacity(Tree::ALL.len());
    for tree in Tree::ALL {
        trees.push(db.open_tree(tree.name()).map_err(refused)?);
    }
    let mut damaged_rows = 0;
    for (tree, rows) in Tree::ALL.into_iter().zip(&trees) {
        for row in rows {
            damaged_rows += usize::from(opened(tree, row).map_err(refused)?.value.is_none());
        }
    }
    let trees = trees.try_into().map_err(|_| SledOpenError::Damaged("trees are missing".to_owned()))?;
    let file = File::options().read(true).write(true).open(folder.join("db")).map_err(SledOpenError::Unusable)?;
    db.flush().map_err(refused)?;
    file.sync_all().and_then(|()| files::sync_folder(folder)).map_err(SledOpenError::Unusable)?;
    Ok(Handle { db, trees, file, opening: 0, schema_before: migrations::ALL.len() - applied, damaged_rows, copy: None })
}

/// Opens the database in `folder` with sled, once it is not locked.
pub(super) fn open_sled(folder: &Path) -> Result<sled::Db, sled::Error> {
    if let Ok(file) = File::options().write(true).open(folder.join("db")) {
        let end = Instant::now() + RELEASE;
        while matches!(file.try_lock(), Err(TryLockError::WouldBlock)) && Instant::now() < end {
            thread::sleep(Duration::from_millis(1));
        }
    }
    sled::Config::new().path(folder).cache_capacity(CACHE_BYTES).open()
}

#[cfg(test)]
mod tests;
