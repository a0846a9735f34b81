//! The journal of jobs: every change of a job's row, appended to a file beside the database.
//!
//! sled can lose rows of a damaged file without an error. Rows that the journal has and the database lacks, or has with a
//! broken seal, are restored when the store is opened. A row that is intact stays as it is, because the journal may be
//! the older one of the two: a job is then at worst fitted again.

mod entries;

use std::{
    collections::{BTreeMap, BTreeSet},
    fs::{self, File, OpenOptions},
    io::{self, Write as _},
    path::{Path, PathBuf},
    sync::{Arc, Mutex, PoisonError},
};

use entries::{Entries, KEPT};

use super::{Batch, Findings, Row, Rows, StoreError, Tree, files};
use crate::files::hex::to_hex;

/// Bytes that are appended before the journal is written anew.
const MOST_APPENDED: usize = 64 << 20;

/// Rows whose jobs are in a journal as well.
#[derive(Debug)]
pub(super) struct JournalledRows<R> {
    rows: R,
    path: PathBuf,
    /// The journal, and how many bytes were appended since it was written anew.
    file: Mutex<(File, usize)>,
}

impl<R: Rows> JournalledRows<R> {
    /// Restores from the journal at `path` what `rows` lack, writes the journal anew, and appends to it from then on. A
    /// journal that is damaged is copied to `quarantine` first. `was_journalled` tells whether `rows` ever had a journal,
    /// `found` what is known of them; what the journal tells is added to it.
    ///
    /// # Errors
    /// When the journal cannot be read, copied or written, or the database fails.
    pub(super) fn open(
        rows: R,
        path: &Path,
        quarantine: &Path,
        was_journalled: bool,
        found: &mut Findings,
    ) -> Result<Self, StoreError> {
        let bytes = read_file(path)?;
        let entries = entries::read(bytes.as_deref().unwrap_or_default());
        let stored = Stored::read(&rows)?;
        found.journal_is_incomplete = (was_journalled || found.database_was_replaced)
            && (entries.intact == 0
                && (found.database_was_replaced || bytes.is_some() || stored.jobs().next().is_some())
                || stored.lacking_in(&entries) > UNFINISHED + entries.damaged);
        restore(&rows, &stored, &entries, found)?;
        if bytes.is_some() && (entries.damaged > 0 || found.journal_is_incomplete) {
            let copied_to = files::copy_to_quarantine(path, quarantine, "jobs.log")?;
            tracing::error!(copied_to = %copied_to.display(), "the journal of jobs is damaged; a copy was made in quarantine");
        }
        let file = write_anew(&rows, path)?;
        Ok(Self { rows, path: path.to_owned(), file: Mutex::new((file, 0)) })
    }

    fn append(&self, batch: &Batch, sync: bool) -> Result<(), StoreError> {
        let Some(entry) = entries::entry(batch) else { return Ok(()) };
        let mut guard = self.file.lock().unwrap_or_else(PoisonError::into_inner);
        let (file, appended) = &mut *guard;
        *appended += entry.len();
        if *appended > MOST_APPENDED {
            // The database has this change already.
            *guard = (write_anew(&self.rows, &self.path)?, 0);
            return Ok(());
        }
        let written = file.write_all(entry.as_bytes()).and_then(|()| if sync { file.sync_data() } else { Ok(()) });
        written.map_err(|source| StoreError::of_io(&self.path, source))
    }
}

/// Restores from the journal at `path` what `rows`, opened again while the process runs, lack, and logs it.
///
/// # Errors
/// When the journal cannot be read, or the database fails.
pub(super) fn restore_again(rows: &Arc<dyn Rows>, path: &Path) -> Result<(), StoreError> {
    let entries = entries::read(&read_file(path)?.unwrap_or_default());
    let stored = Stored::read(rows.as_ref())?;
    let is_incomplete = entries.intact == 0 || stored.lacking_in(&entries) > UNFINISHED + entries.damaged;
    let mut found = Findings { journal_is_incomplete: is_incomplete, ..Findings::default() };
    restore(rows.as_ref(), &stored, &entries, &mut found)?;
    found.log();
    Ok(())
}

/// Jobs that a database may have and its journal not: the one whose commit a crash interrupted between the two.
const UNFINISHED: usize = 1;

/// The kept rows of a database; `None` for one with a broken seal.
struct Stored(BTreeMap<Tree, BTreeMap<Vec<u8>, Option<Vec<u8>>>>);

impl Stored {
    fn read(rows: &dyn Rows) -> Result<Self, StoreError> {
        let mut stored = BTreeMap::new();
        for tree in KEPT {
            let rows = rows.scan(tree, &[])?.into_iter().map(|Row { key, value }| (key, value));
            stored.insert(tree, rows.collect());
        }
        Ok(Self(stored))
    }

    /// Keys of all jobs, and whether the row is intact.
    fn jobs(&self) -> impl Iterator<Item = (&Vec<u8>, bool)> {
        self.0.get(&Tree::Jobs).into_iter().flatten().map(|(key, value)| (key, value.is_some()))
    }

    /// Number of intact jobs of which a journal knows nothing.
    fn lacking_in(&self, entries: &Entries) -> usize {
        let is_known = |key: &Vec<u8>| entries.latest.contains_key(&(Tree::Jobs.name(), key.clone()));
        self.jobs().filter(|(key, is_intact)| *is_intact && !is_known(key)).count()
    }
}

/// Restores in `rows`, which are `stored`, what they lack of the journal. `found` is told what was restored, and which
/// jobs were not.
fn restore(rows: &dyn Rows, stored: &Stored, entries: &Entries, found: &mut Findings) -> Result<(), StoreError> {
    let mut batch = Batch::default();
    for (tree, stored) in &stored.0 {
        for ((_, key), value) in entries.latest.iter().filter(|((name, _), _)| *name == tree.name()) {
            match value {
                // Missing, or with a broken seal.
                Some(value) if stored.get(key).is_none_or(Option::is_none) => {
                    batch.put(*tree, key.clone(), value.clone());
                }
                None if stored.contains_key(key) => batch.remove(*tree, key.clone()),
                _ => {}
            }
        }
    }
    let changed: BTreeMap<&Vec<u8>, bool> = batch
        .changes
        .iter()
        .filter(|(tree, ..)| *tree == Tree::Jobs)
        .map(|(_, key, value)| (key, value.is_some()))
        .collect();
    found.restored_rows = batch.changes.len();
    found.restored_jobs = changed.iter().filter(|(_, is_put)| **is_put).map(|(key, _)| to_hex(key)).collect();
    let broken = stored.jobs().filter(|(_, is_intact)| !is_intact).map(|(key, _)| key);
    let in_damaged = entries.in_damaged.iter().filter(|key| {
        !entries.latest.contains_key(&(Tree::Jobs.name(), (*key).clone()))
            && !stored.jobs().any(|(other, _)| other == *key)
    });
    let lost: BTreeSet<&Vec<u8>> = broken.chain(in_damaged).filter(|key| !changed.contains_key(key)).collect();
    found.lost_jobs = lost.into_iter().map(|key| to_hex(key)).collect();
    found.damaged_journal_entries = entries.damaged;
    if batch.is_empty() { Ok(()) } else { rows.commit(&batch) }
}

/// The bytes of the journal at `path`; `None` if there is none.
fn read_file(path: &Path) -> Result<Option<Vec<u8>>, StoreError> {
    match fs::read(path) {
        Ok(bytes) => Ok(Some(bytes)),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
        Err(source) => Err(StoreError::of_io(path, source)),
    }
}

/// Writes a journal of the rows as they are, an entry each, and opens it to append.
fn write_anew(rows: &impl Rows, path: &Path) -> Result<File, StoreError> {
    let mut all = entries::first();
    for tree in KEPT {
        for Row { key, value } in rows.scan(tree, &[])? {
            // A damaged row that the journal does not have stays where it is, for the queue to report.
            let Some(value) = value else { continue };
            let mut row = Batch::default();
            row.put(tree, key, value);
            all.extend(entries::entry(&row));
        }
    }
    files::write_durably(path, all.as_bytes())?;
    OpenOptions::new().append(true).open(path).map_err(|source| StoreError::of_io(path, source))
}

impl<R: Rows> Rows for JournalledRows<R> {
    fn get(&self, tree: Tree, key: &[u8]) -> Result<Option<Vec<u8>>, StoreError> {
        self.rows.get(tree, key)
    }

    fn scan(&self, tree: Tree, prefix: &[u8]) -> Result<Vec<Row>, StoreError> {
        self.rows.scan(tree, prefix)
    }

    fn page(&self, tree: Tree, before: Option<&[u8]>, limit: usize) -> Result<Vec<Row>, StoreError> {
        self.rows.page(tree, before, limit)
    }

    /// The database comes first: it keeps room on the disk for what it and the journal write.
    fn commit(&self, batch: &Batch) -> Result<(), StoreError> {
        self.rows.commit(batch)?;
        self.append(batch, true)
    }

    fn stage(&self, batch: &Batch) -> Result<(), StoreError> {
        self.rows.stage(batch)?;
        self.append(batch, false)
    }
}

#[cfg(test)]
mod tests;
