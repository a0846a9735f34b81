//! [`Rows`] in sled.
//!
//! This module works around these properties of sled 0.34.7:
//! - `flush` calls `sync_file_range`, which does not protect against a power cut. Every commit therefore ends with an
//!   fsync of the database file.
//! - sled does not fsync its settings, but cannot open without them. Opening therefore ends with an fsync of every
//!   file.
//! - Truncated files can cause a panic inside sled. It is therefore opened on a separate thread, and the panic is
//!   caught.
//! - After a write error, such as a full disk, an open database refuses every operation. Commits therefore leave some
//!   space on the disk. After an error the process must be restarted.
//! - sled does not detect damaged values. Each value therefore has a hash in front of it, and opening reads every row.
//! - sled's threads may keep the file locked for a moment after the database is dropped. Opening waits until the file
//!   is unlocked.

use std::{
    collections::BTreeSet,
    fs::{File, TryLockError},
    io,
    path::{Path, PathBuf},
    sync::OnceLock,
    thread,
    time::{Duration, Instant, SystemTime},
};

use sled::transaction::{ConflictableTransactionError, TransactionError, Transactional as _};

use super::{
    Batch, OpenError, Row, Rows, StoreError, Tree,
    error::is_full,
    files, migrations,
    seal::{seal, unseal},
};
use ltcforge_files::replace::sync_folder;

/// Size of sled's page cache. The rows of all unfinished jobs fit into the cache.
const CACHE_BYTES: u64 = 16 << 20;

/// Space that a commit leaves on the disk. sled's log grows by segments of 512 KiB, and two segments may be open. The
/// disk must not be full when sled writes in the background.
pub(super) const HEADROOM_BYTES: u64 = 2 << 20;

/// Additional free space that a job with many shards needs.
const JOB_BYTES: u64 = 1 << 20;

/// Maximum time to wait until a closed database is unlocked.
const RELEASE: Duration = Duration::from_secs(2);

/// Rows in a sled database.
#[derive(Debug)]
pub struct SledRows {
    folder: PathBuf,
    db: sled::Db,
    trees: [sled::Tree; Tree::ALL.len()],
    /// sled's data file, which commits fsync.
    file: File,
    /// The error that closed the database.
    failure: OnceLock<String>,
}

impl SledRows {
    /// Opens or creates the database in `folder`, updates its schema, and reads every row. This runs on a separate
    /// thread, so a panic inside sled becomes an error.
    pub(super) fn open(folder: &Path) -> Result<Self, OpenError> {
        if SystemTime::UNIX_EPOCH.elapsed().is_err() {
            // sled would panic, and the database would look damaged.
            let error = io::Error::other("the clock of this machine is before 1970; set the clock");
            return Err(OpenError::Unusable(error));
        }
        let folder = folder.to_owned();
        let opening = thread::Builder::new().name("open-database".to_owned()).spawn(move || Self::open_here(folder))?;
        opening.join().unwrap_or_else(|_| Err(OpenError::Damaged("sled panicked while it read its files".to_owned())))
    }

    fn open_here(folder: PathBuf) -> Result<Self, OpenError> {
        if files::free_bytes(&folder)? < HEADROOM_BYTES {
            return Err(OpenError::Full);
        }
        let is_new = folder.read_dir()?.next().is_none();
        for name in ["db", "conf"].map(|name| folder.join(name)) {
            // Opening a FIFO would block forever.
            if name.symlink_metadata().is_ok_and(|metadata| !metadata.is_file()) {
                return Err(OpenError::Damaged(format!("{} is not a regular file", name.display())));
            }
        }
        wait_for_release(&folder.join("db"));
        let db = sled::Config::new().path(&folder).cache_capacity(CACHE_BYTES).open()?;
        migrations::apply(&db, is_new, migrations::ALL)?;
        let mut trees = Vec::with_capacity(Tree::ALL.len());
        for tree in Tree::ALL {
            let rows = db.open_tree(tree.name())?;
            for row in &rows {
                let (key, sealed) = row?;
                if unseal(tree.name(), &key, &sealed).is_none() {
                    return Err(OpenError::Damaged(format!("a row of {} does not match its hash", tree.name())));
                }
            }
            trees.push(rows);
        }
        let trees = trees.try_into().map_err(|_| OpenError::Damaged("trees are missing".to_owned()))?;
        let file = File::options().read(true).write(true).open(folder.join("db"))?;
        db.flush()?;
        for entry in folder.read_dir()? {
            let path = entry?.path();
            if path.is_file() {
                File::open(path)?.sync_all()?;
            }
        }
        sync_folder(&folder)?;
        Ok(Self { folder, db, trees, file, failure: OnceLock::new() })
    }

    fn tree(&self, tree: Tree) -> &sled::Tree {
        &self.trees[tree as usize]
    }

    /// Runs `operation` unless an earlier error closed the database.
    fn with<T>(&self, operation: impl FnOnce() -> Result<T, sled::Error>) -> Result<T, StoreError> {
        if let Some(failure) = self.failure.get() {
            return Err(StoreError::Database(failure.clone()));
        }
        operation().map_err(|error| {
            let failure = format!("it is closed after an error ({error}); restart the service");
            tracing::error!(%error, "the database is closed after an error; restart the service");
            // Later errors do not replace the first one.
            let _ = self.failure.set(failure.clone());
            match error {
                sled::Error::Io(source) if is_full(source.kind()) => StoreError::DiskFull,
                _ => StoreError::Database(failure),
            }
        })
    }

    /// Checks the rows in `found`, and removes their hashes.
    fn opened(
        &self,
        tree: Tree,
        found: impl Iterator<Item = sled::Result<(sled::IVec, sled::IVec)>>,
    ) -> Result<Vec<Row>, StoreError> {
        let rows = self.with(|| found.collect::<sled::Result<Vec<_>>>())?;
        rows.into_iter().map(|(key, sealed)| Ok((key.to_vec(), unsealed(tree, &key, &sealed)?))).collect()
    }

    fn apply(&self, batch: &Batch) -> Result<(), sled::Error> {
        let touched: BTreeSet<Tree> = batch.changes.iter().map(|(tree, ..)| *tree).collect();
        let trees: Vec<sled::Tree> = touched.iter().map(|tree| self.tree(*tree).clone()).collect();
        if trees.is_empty() {
            return Ok(());
        }
        let result = trees.as_slice().transaction(|views| {
            for (tree, key, value) in &batch.changes {
                // `touched` contains the trees of all changes.
                let Some((_, view)) = touched.iter().zip(views).find(|(name, _)| *name == tree) else { continue };
                match value {
                    Some(value) => view.insert(key.as_slice(), seal(tree.name(), key, value))?,
                    None => view.remove(key.as_slice())?,
                };
            }
            Ok::<(), ConflictableTransactionError<()>>(())
        });
        if let Err(TransactionError::Storage(error)) = result {
            return Err(error);
        }
        Ok(())
    }
}

impl Rows for SledRows {
    fn get(&self, tree: Tree, key: &[u8]) -> Result<Option<Vec<u8>>, StoreError> {
        let Some(sealed) = self.with(|| self.tree(tree).get(key))? else { return Ok(None) };
        unsealed(tree, key, &sealed).map(Some)
    }

    fn scan(&self, tree: Tree, prefix: &[u8]) -> Result<Vec<Row>, StoreError> {
        self.opened(tree, self.tree(tree).scan_prefix(prefix))
    }

    fn page(&self, tree: Tree, before: Option<&[u8]>, limit: usize) -> Result<Vec<Row>, StoreError> {
        let rows = match before {
            Some(before) => self.tree(tree).range(..before),
            None => self.tree(tree).iter(),
        };
        self.opened(tree, rows.rev().take(limit))
    }

    fn commit(&self, batch: &Batch) -> Result<(), StoreError> {
        let free = files::free_bytes(&self.folder).map_err(|source| StoreError::of_io(&self.folder, source))?;
        if free < HEADROOM_BYTES + batch.bytes() as u64 {
            return Err(StoreError::DiskFull);
        }
        self.with(|| {
            self.apply(batch)?;
            self.db.flush()?;
            self.file.sync_all().map_err(sled::Error::Io)
        })
    }

    fn fault(&self) -> Option<String> {
        let has_room = || files::free_bytes(&self.folder).is_ok_and(|free| free >= HEADROOM_BYTES + JOB_BYTES);
        self.failure.get().cloned().or_else(|| (!has_room()).then(|| super::DISK_FULL.to_owned()))
    }
}

/// Waits up to [`RELEASE`] until `file` is unlocked.
pub(super) fn wait_for_release(file: &Path) {
    let Ok(file) = File::options().write(true).open(file) else { return };
    let end = Instant::now() + RELEASE;
    while matches!(file.try_lock(), Err(TryLockError::WouldBlock)) && Instant::now() < end {
        thread::sleep(Duration::from_millis(1));
    }
}

fn unsealed(tree: Tree, key: &[u8], sealed: &[u8]) -> Result<Vec<u8>, StoreError> {
    unseal(tree.name(), key, sealed).ok_or_else(|| StoreError::DamagedRow { tree, key: key.to_vec() })
}
