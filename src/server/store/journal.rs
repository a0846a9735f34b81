//! The journal of jobs: every change of a job's row that was acknowledged, appended to a file beside the database.
//!
//! sled can lose rows of a damaged file without an error, or have them as they once were. Each change of jobs has a revision,
//! one more than the change before it. The database stores it with the row and the journal with the entry, so when the
//! store is opened, whichever of the two has the newer revision of a row is right. The database also has the last entry:
//! it tells how far the journal has to reach.
//!
//! A staged change does not count as acknowledged. It has the revision of the last commit and no entry.

mod comparison;
mod entries;

use std::{
    fs::{self, File, OpenOptions},
    io::{self, Write as _},
    path::{Path, PathBuf},
    sync::{Arc, Mutex, MutexGuard, PoisonError},
};

use super::{Batch, Findings, Row, Rows, Staged, StoreError, Tree, files, numbered};

/// Bytes that are appended before the journal is written anew.
const MOST_APPENDED: usize = 64 << 20;

/// Where a journal and what belongs to it are.
#[derive(Debug, Clone, Copy)]
pub(super) struct Paths<'a> {
    /// The journal.
    pub(super) journal: &'a Path,
    /// The folder of the database.
    pub(super) database: &'a Path,
    /// Where copies of damaged files go.
    pub(super) quarantine: &'a Path,
}

/// Rows whose jobs are in a journal as well.
#[derive(Debug)]
pub(super) struct JournalledRows<R> {
    rows: R,
    path: PathBuf,
    end: Mutex<End>,
}

/// The end of the journal.
#[derive(Debug)]
struct End {
    file: File,
    /// Bytes that were appended since it was written anew.
    appended: usize,
    /// Whether an entry could not be written.
    is_behind: bool,
    /// Revision of the last change of jobs.
    revision: u64,
}

impl<R: Rows> JournalledRows<R> {
    /// Brings `rows` up to date with their journal, writes the journal anew, and appends to it from then on. A journal that
    /// is damaged is copied to quarantine first; so are journal and database if the database is the older one.
    /// `was_journalled` tells whether `rows` ever had a journal, `found` what is known of them; what the journal tells is
    /// added to it.
    ///
    /// # Errors
    /// When the journal cannot be read, copied or written, or the database fails.
    pub(super) fn open(
        rows: R,
        paths: Paths<'_>,
        was_journalled: bool,
        found: &mut Findings,
    ) -> Result<Self, StoreError> {
        let bytes = read_file(paths.journal)?;
        let compared = comparison::compare(&rows, bytes.as_deref(), was_journalled, found)?;
        let is_damaged = found.damaged_journal_entries > 0 || found.journal_is_incomplete;
        if bytes.is_some() && (is_damaged || compared.database_is_older) {
            let copied_to = files::copy_to_quarantine(paths.journal, paths.quarantine, "jobs.log")?;
            tracing::error!(copied_to = %copied_to.display(), "a copy of the journal of jobs was made in quarantine");
        }
        if compared.database_is_older && paths.database.is_dir() {
            let copied_to = files::copy_to_quarantine(paths.database, paths.quarantine, "db")?;
            tracing::error!(copied_to = %copied_to.display(), "a copy of the older database was made in quarantine");
        }
        if !compared.changes.is_empty() {
            rows.commit(&compared.changes)?;
        }
        let file = write_anew(&rows, paths.journal, compared.revision)?;
        let end = End { file, appended: 0, is_behind: false, revision: compared.revision };
        Ok(Self { rows, path: paths.journal.to_owned(), end: Mutex::new(end) })
    }

    fn end(&self) -> MutexGuard<'_, End> {
        self.end.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Appends an entry, or writes the journal anew from the database, which has the change already.
    fn append(&self, end: &mut End, entry: &str) -> Result<(), StoreError> {
        end.appended += entry.len();
        if end.is_behind || end.appended > MOST_APPENDED {
            end.is_behind = true;
            end.file = write_anew(&self.rows, &self.path, end.revision)?;
            (end.appended, end.is_behind) = (0, false);
            return Ok(());
        }
        let written = end.file.write_all(entry.as_bytes()).and_then(|()| end.file.sync_data());
        end.is_behind = written.is_err();
        written.map_err(|source| StoreError::of_io(&self.path, source))
    }
}

/// Brings `rows`, opened again while the process runs, up to date with the journal at `path`, and logs it.
///
/// # Errors
/// When the journal cannot be read, or the database fails.
pub(super) fn restore_again(rows: &Arc<dyn Rows>, path: &Path) -> Result<(), StoreError> {
    let mut found = Findings::default();
    let compared = comparison::compare(rows.as_ref(), read_file(path)?.as_deref(), true, &mut found)?;
    if !compared.changes.is_empty() {
        rows.commit(&compared.changes)?;
    }
    found.log();
    Ok(())
}

/// The bytes of the journal at `path`; `None` if there is none.
fn read_file(path: &Path) -> Result<Option<Vec<u8>>, StoreError> {
    match fs::read(path) {
        Ok(bytes) => Ok(Some(bytes)),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
        Err(source) => Err(StoreError::of_io(path, source)),
    }
}

/// Writes a journal of the rows as they are at `revision`, and opens it to append.
fn write_anew(rows: &impl Rows, path: &Path, revision: u64) -> Result<File, StoreError> {
    let (mut all, mut count) = (String::new(), 0);
    for (tree, _) in entries::KEPT {
        for Row { key, value } in rows.scan(tree, &[])? {
            // A damaged row that the journal does not have stays where it is, for the queue to report.
            let Some((of, value)) = value.as_deref().and_then(numbered::split) else { continue };
            all.push_str(&entries::row(of, tree, &key, value));
            count += 1;
        }
    }
    all.insert_str(0, &entries::head(revision, count));
    files::write_durably(path, all.as_bytes())?;
    OpenOptions::new().append(true).open(path).map_err(|source| StoreError::of_io(path, source))
}

/// Whether a batch changes what is kept in the journal.
fn concerns_jobs(batch: &Batch) -> bool {
    batch.changes.iter().any(|(tree, ..)| entries::is_kept(*tree))
}

/// The batch as it is stored: values of kept trees joined with `revision`.
fn with_revision(batch: &Batch, revision: u64) -> Batch {
    let mut numbered = batch.clone();
    for (tree, _, value) in &mut numbered.changes {
        if let Some(value) = value.as_mut().filter(|_| entries::is_kept(*tree)) {
            *value = numbered::join(revision, value);
        }
    }
    numbered
}

/// The row as it was before it was joined with its revision.
fn without_revision(tree: Tree, row: Row) -> Row {
    if !entries::is_kept(tree) {
        return row;
    }
    let value = row.value.as_deref().and_then(numbered::split).map(|(_, value)| value.to_vec());
    Row { value, ..row }
}

impl<R: Rows> Rows for JournalledRows<R> {
    fn get(&self, tree: Tree, key: &[u8]) -> Result<Option<Vec<u8>>, StoreError> {
        let Some(value) = self.rows.get(tree, key)? else { return Ok(None) };
        let row = without_revision(tree, Row { key: key.to_vec(), value: Some(value) });
        row.value.map(Some).ok_or(StoreError::DamagedRow { tree, key: row.key })
    }

    fn scan(&self, tree: Tree, prefix: &[u8]) -> Result<Vec<Row>, StoreError> {
        let rows = self.rows.scan(tree, prefix)?;
        Ok(rows.into_iter().map(|row| without_revision(tree, row)).collect())
    }

    fn page(&self, tree: Tree, before: Option<&[u8]>, limit: usize) -> Result<Vec<Row>, StoreError> {
        let rows = self.rows.page(tree, before, limit)?;
        Ok(rows.into_iter().map(|row| without_revision(tree, row)).collect())
    }

    /// The database comes first: it keeps room on the disk for what it and the journal write. Changes of jobs are made one
    /// at a time, so that the journal is behind by one entry at most.
    fn commit(&self, batch: &Batch) -> Result<(), StoreError> {
        if !concerns_jobs(batch) {
            return self.rows.commit(batch);
        }
        let mut end = self.end();
        let revision = end.revision + 1;
        let entry = entries::entry(revision, batch);
        let mut numbered = with_revision(batch, revision);
        numbered.put(Tree::Journal, comparison::LAST, entry.trim());
        self.rows.commit(&numbered)?;
        end.revision = revision;
        self.append(&mut end, &entry)
    }

    fn settle(&self, staged: Staged) -> Result<(), StoreError> {
        self.rows.settle(staged)
    }

    fn stage(&self, batch: &Batch) -> Result<Staged, StoreError> {
        if !concerns_jobs(batch) {
            return self.rows.stage(batch);
        }
        let end = self.end();
        self.rows.stage(&with_revision(batch, end.revision))
    }
}

#[cfg(test)]
mod tests;
