//! Opening the data folder.

use std::{
    fs::{self, File, TryLockError},
    io,
    path::Path,
    sync::Arc,
};

use super::{
    Blobs, Checks, FileBlobs, Findings, Rows, SledRows, StoreError, files,
    journal::{self, JournalledRows, Paths},
    migrations::MigrationError,
    sled_rows::SledOpenError,
};

/// The opened data folder. Other processes are locked out until it is dropped.
#[derive(Debug)]
pub struct Store {
    /// Tables by digest.
    pub blobs: Arc<dyn Blobs>,
    /// Jobs, shards and the catalogue.
    pub rows: Arc<dyn Rows>,
    /// What was wrong when it was opened. The catalogue must then be compared with the blobs.
    pub found: Findings,
    /// What is checked when a write error closed the database and it was opened again.
    pub checks: Checks,
    /// Dropping it unlocks the folder. A store that processes share has no folder.
    _lock: Option<File>,
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
    /// Every row of the database is read and checked. A database that does not open or cannot be read is copied to
    /// `quarantine/db-N` and replaced by an empty one. Jobs that it lost, or has as they once were, are restored from their
    /// journal. A damaged journal is copied to `quarantine/jobs.log-N` before it is written anew; so are both if the
    /// database is the older one.
    ///
    /// # Errors
    /// See [`StoreOpenError`]. A full disk is [`StoreOpenError::Unusable`]; nothing is moved then.
    pub fn open(dir: &Path) -> Result<Self, StoreOpenError> {
        files::make_folder(dir)?;
        let lock = lock(&dir.join("lock"))?;
        let quarantine = dir.join("quarantine");
        let blobs = FileBlobs::open(&dir.join("blobs"), &quarantine)?;
        let mut found = Findings::default();
        let (database, journal) = (dir.join("db"), dir.join("jobs.log"));
        let had_bytes = fs::metadata(database.join("db")).map_or(0, |metadata| metadata.len());
        let was_used = had_bytes > 0 || journal.exists() || !blobs.list()?.is_empty();
        let rows = open_rows(&database, &quarantine, &mut found)?;
        if rows.was_empty && was_used && !found.database_was_replaced {
            tracing::error!(had_bytes, "the database is missing, or sled could not read its file and started over");
            found.database_was_replaced = true;
        }
        let (checks, was_journalled) = (rows.checks.clone(), rows.was_journalled);
        let paths = Paths { journal: &journal, database: &database, quarantine: &quarantine };
        let rows = JournalledRows::open(rows, paths, was_journalled, &mut found)?;
        found.log();
        checks.add(move |rows| journal::restore_again(rows, &journal));
        Ok(Self { blobs: Arc::new(blobs), rows: Arc::new(rows), found, checks, _lock: Some(lock) })
    }
}

impl Store {
    /// A store that any number of processes share.
    #[must_use]
    pub fn shared(blobs: Arc<dyn Blobs>, rows: Arc<dyn Rows>) -> Self {
        Self { blobs, rows, found: Findings::default(), checks: Checks::default(), _lock: None }
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
    let file = File::options().create(true).truncate(false).write(true).open(path).map_err(StoreOpenError::Unusable)?;
    match file.try_lock() {
        Ok(()) => Ok(file),
        Err(TryLockError::WouldBlock) => Err(StoreOpenError::Locked),
        Err(TryLockError::Error(source)) => Err(StoreOpenError::Unusable(source)),
    }
}

/// The database of `folder`, after every row of it was read. One that does not open or cannot be read is copied to
/// `quarantine` and replaced by an empty one. `found` is told what went wrong.
fn open_rows(folder: &Path, quarantine: &Path, found: &mut Findings) -> Result<SledRows, StoreOpenError> {
    files::make_folder(folder)?;
    let reason = match open_and_read(folder) {
        Ok((rows, damaged_rows)) => {
            found.damaged_rows = damaged_rows;
            return Ok(rows);
        }
        Err(SledOpenError::Damaged(reason)) => reason,
        Err(error) => return Err(refusal(error)),
    };
    // The copy is made before sled changes the files any further.
    let copied_to = files::copy_to_quarantine(folder, quarantine, "db")?;
    tracing::error!(reason, copied_to = %copied_to.display(), "the database is damaged; a copy was made in quarantine");
    found.database_was_replaced = true;
    // A damaged snapshot prevents opening. The log has everything that is in a snapshot, unless it is damaged as well.
    if files::remove_matching(folder, "snap.")? > 0 {
        match open_and_read(folder) {
            Ok((rows, damaged_rows)) if !rows.was_empty => {
                tracing::warn!("the database was opened without its snapshots");
                found.damaged_rows = damaged_rows;
                return Ok(rows);
            }
            Ok(_) | Err(SledOpenError::Damaged(_)) => {}
            Err(error) => return Err(refusal(error)),
        }
    }
    tracing::error!("starting with an empty database");
    fs::remove_dir_all(folder).map_err(StoreOpenError::Unusable)?;
    files::make_folder(folder)?;
    SledRows::open(folder, Arc::new(File::sync_all)).map_err(refusal)
}

fn open_and_read(folder: &Path) -> Result<(SledRows, usize), SledOpenError> {
    let rows = SledRows::open(folder, Arc::new(File::sync_all))?;
    let damaged = rows.read_all().map_err(unreadable)?;
    Ok((rows, damaged))
}

/// Rows that cannot be read are damaged, unless the machine lacks something for a moment: then they are left as they are.
fn unreadable(error: StoreError) -> SledOpenError {
    match error {
        StoreError::Io { ref source, .. } if error.is_passing() => {
            SledOpenError::Unusable(io::Error::new(source.kind(), error.to_string()))
        }
        other => SledOpenError::Damaged(other.to_string()),
    }
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
mod tests {
    use std::path::PathBuf;

    use super::*;
    use crate::store::{Batch, Tree, sled_rows::open_sled};

    fn one_job(store: &Store) {
        let mut batch = Batch::default();
        batch.put(Tree::Jobs, "key", "job");
        store.rows.commit(&batch).unwrap();
    }

    #[test]
    fn a_folder_is_opened_by_one_at_a_time() {
        let dir = tempfile::tempdir().unwrap();
        let store = Store::open(dir.path()).unwrap();
        assert!(matches!(Store::open(dir.path()), Err(StoreOpenError::Locked)));
        one_job(&store);
        drop(store);
        let store = Store::open(dir.path()).unwrap();
        assert_eq!(store.found, Findings::default());
        assert_eq!(store.rows.get(Tree::Jobs, b"key").unwrap().unwrap(), b"job");
    }

    #[test]
    fn a_file_in_place_of_the_folder_is_unusable() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("file");
        fs::write(&path, "").unwrap();
        assert!(matches!(Store::open(&path), Err(StoreOpenError::Unusable(_))));
    }

    #[test]
    fn a_later_schema_is_refused_and_left_alone() {
        let dir = tempfile::tempdir().unwrap();
        drop(Store::open(dir.path()).unwrap());
        let db = open_sled(&dir.path().join("db")).unwrap();
        db.open_tree("migrations").unwrap().insert(99_u32.to_be_bytes(), b"").unwrap();
        drop(db);
        assert!(matches!(Store::open(dir.path()), Err(StoreOpenError::FromTheFuture { found: 99, known: 4 })));
        assert!(!dir.path().join("quarantine").exists());
    }

    /// Bits flipped, pages zeroed and ends cut off all over sled's file, after a clean close and in the state that
    /// kill -9 leaves.
    #[test]
    fn no_damage_to_the_database_loses_a_job() {
        const JOBS: u32 = 12;
        let of = |n: u32| format!("job {n} {}", "x".repeat(600));
        let dir = tempfile::tempdir().unwrap();
        let (open, killed) = (dir.path().join("open"), dir.path().join("killed"));
        let store = Store::open(&open).unwrap();
        for n in 0..JOBS {
            let mut batch = Batch::default();
            batch.put(Tree::Jobs, n.to_be_bytes(), of(n));
            batch.put(Tree::JobOrder, n.to_be_bytes(), n.to_be_bytes());
            store.rows.commit(&batch).unwrap();
        }
        files::copy_folder(&open, &killed).unwrap();
        drop(store);
        // There is a snapshot after a second start.
        drop(Store::open(&open).unwrap());
        let (mut damaged, mut restored) = (0, 0);
        for from in [&open, &killed] {
            let whole = fs::read(from.join("db/db")).unwrap();
            let used = whole.iter().rposition(|byte| *byte != 0).unwrap_or_default() + 1;
            for step in 0..16 {
                let at = used * step / 16;
                let end = (at + 4096).min(used);
                for kind in 0..3 {
                    let mut bytes = whole.clone();
                    match kind {
                        0 => bytes[at] ^= 1 << (step % 8),
                        1 => bytes[at..end].fill(0),
                        _ => bytes.truncate(at),
                    }
                    let copy = dir.path().join("copy");
                    files::copy_folder(from, &copy).unwrap();
                    fs::write(copy.join("db/db"), bytes).unwrap();
                    let store = Store::open(&copy).unwrap();
                    for n in 0..JOBS {
                        let found = store.rows.get(Tree::Jobs, &n.to_be_bytes());
                        assert_eq!(found.unwrap().unwrap(), of(n).as_bytes(), "damage {kind} at {at}");
                    }
                    damaged += 1;
                    restored += usize::from(store.found.restored_rows > 0);
                    drop(store);
                    fs::remove_dir_all(copy).unwrap();
                }
            }
        }
        assert!(restored > damaged / 4, "only {restored} of {damaged} damages concerned a job");
    }

    /// Writes a job into the tree past the seals.
    fn spoil(dir: &Path, key: &str) {
        let db = open_sled(&dir.join("db")).unwrap();
        db.open_tree(Tree::Jobs.name()).unwrap().insert(key, b"12345678another".as_slice()).unwrap();
        db.flush().unwrap();
    }

    #[test]
    fn a_job_whose_row_is_damaged_is_restored_or_named_as_lost() {
        let dir = tempfile::tempdir().unwrap();
        one_job(&Store::open(dir.path()).unwrap());
        spoil(dir.path(), "key");
        spoil(dir.path(), "unknown");
        let store = Store::open(dir.path()).unwrap();
        let named = |key: &str| vec![ltcforge_files::hex::to_hex(key.as_bytes())];
        assert_eq!(store.rows.get(Tree::Jobs, b"key").unwrap().unwrap(), b"job");
        let (restored_jobs, lost_jobs) = (named("key"), named("unknown"));
        let found = Findings { damaged_rows: 2, restored_rows: 1, restored_jobs, lost_jobs, ..Findings::default() };
        assert_eq!(store.found, found);
    }

    fn snapshots(dir: &Path) -> Vec<PathBuf> {
        let files = fs::read_dir(dir.join("db")).unwrap().map(|entry| entry.unwrap().path());
        files.filter(|path| path.file_name().unwrap().to_string_lossy().starts_with("snap.")).collect()
    }

    #[test]
    fn a_database_that_does_not_open_is_copied_to_quarantine_and_the_blobs_stay() {
        let dir = tempfile::tempdir().unwrap();
        let store = Store::open(dir.path()).unwrap();
        (0..50).for_each(|_| one_job(&store));
        let digest = store.blobs.put(b"table").unwrap();
        drop(store);
        // After a second start there is a snapshot, by which sled knows that the file had contents.
        drop(Store::open(dir.path()).unwrap());
        let db = dir.path().join("db/db");
        let length = fs::metadata(&db).unwrap().len();
        fs::write(&db, vec![0x5a; usize::try_from(length).unwrap()]).unwrap();
        let store = Store::open(dir.path()).unwrap();
        assert!(store.found.database_was_replaced);
        assert_eq!(store.found.restored_rows, 1);
        assert_eq!(store.rows.get(Tree::Jobs, b"key").unwrap().unwrap(), b"job");
        assert_eq!(store.blobs.get(digest).unwrap().unwrap(), b"table");
        let aside = fs::read(dir.path().join("quarantine/db-1/db")).unwrap();
        assert_eq!((aside.len() as u64, aside[0]), (length, 0x5a));
    }

    #[test]
    fn a_truncated_database_never_prevents_the_start_and_loses_no_job() {
        for cut in [0, 1, 100, 4096] {
            let dir = tempfile::tempdir().unwrap();
            let store = Store::open(dir.path()).unwrap();
            (0..50).for_each(|_| one_job(&store));
            drop(store);
            drop(Store::open(dir.path()).unwrap());
            let db = dir.path().join("db/db");
            fs::write(&db, &fs::read(&db).unwrap()[..cut]).unwrap();
            let store = Store::open(dir.path()).unwrap();
            assert_eq!(store.rows.get(Tree::Jobs, b"key").unwrap().unwrap(), b"job", "cut at {cut}");
            one_job(&store);
        }
    }

    #[test]
    fn a_damaged_snapshot_costs_nothing() {
        let dir = tempfile::tempdir().unwrap();
        one_job(&Store::open(dir.path()).unwrap());
        drop(Store::open(dir.path()).unwrap());
        assert!(!snapshots(dir.path()).is_empty(), "sled left no snapshot to damage");
        for path in snapshots(dir.path()) {
            let mut bytes = fs::read(&path).unwrap();
            let middle = bytes.len() / 2;
            bytes[middle] ^= 0xff;
            fs::write(path, bytes).unwrap();
        }
        let store = Store::open(dir.path()).unwrap();
        assert!(store.rows.get(Tree::Jobs, b"key").unwrap().is_some());
    }
}
