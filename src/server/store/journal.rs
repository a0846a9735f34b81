//! The journal of jobs: every change of a job's row, appended to a file beside the database.
//!
//! sled can lose rows of a damaged file without an error. Rows that the journal has and the database lacks, or has with a
//! broken seal, are restored when the store is opened. A row that is intact stays as it is, because the journal may be
//! the older one of the two: a job is then at worst fitted again.
//!
//! An entry is a line: 16 hexadecimal digits of its seal, and the changes of a batch, each as tree, key and value in
//! hexadecimal, `-` for a row that was removed. A line break begins an entry and another ends it, so that one that was cut
//! off by a crash or a full disk ends where the next begins.

use std::{
    collections::BTreeMap,
    fs::{self, File, OpenOptions},
    io::{self, Write as _},
    path::{Path, PathBuf},
    sync::{Mutex, PoisonError},
};

use sha2::{Digest as _, Sha256};

use super::{Batch, Row, Rows, StoreError, Tree, files};
use crate::files::hex::{from_hex, to_hex};

/// The trees whose changes are kept. All others can be made again: shards by fitting, the catalogue from the blobs.
const KEPT: [Tree; 2] = [Tree::Jobs, Tree::JobOrder];

/// Bytes that are appended before the journal is written anew.
const MOST_APPENDED: usize = 64 << 20;

/// A row by the name of its tree and its key.
type Place = (&'static str, Vec<u8>);

/// The kept rows as the journal last saw them; `None` for a removed row.
type Latest = BTreeMap<Place, Option<Vec<u8>>>;

/// What was found when the journal was compared with the database.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Restored {
    /// Rows that the database had lost.
    pub(super) rows: usize,
    /// Entries of the journal that are damaged, an interrupted last one not counted.
    pub(super) damaged_entries: usize,
}

/// Rows whose jobs are in a journal as well.
#[derive(Debug)]
pub(super) struct JournalledRows<R> {
    rows: R,
    path: PathBuf,
    /// The journal, and how many bytes were appended since it was written anew.
    file: Mutex<(File, usize)>,
}

impl<R: Rows> JournalledRows<R> {
    /// Restores from the journal at `path` what `rows` lack, writes the journal anew, and appends to it from then on.
    ///
    /// # Errors
    /// When the journal cannot be read or written, or the database fails.
    pub(super) fn open(rows: R, path: &Path) -> Result<(Self, Restored), StoreError> {
        let of_io = |source| StoreError::of_io(path, source);
        let bytes = match fs::read(path) {
            Ok(bytes) => bytes,
            Err(error) if error.kind() == io::ErrorKind::NotFound => Vec::new(),
            Err(error) => return Err(of_io(error)),
        };
        let (latest, damaged_entries) = read(&bytes);
        let mut lost = Batch::default();
        for tree in KEPT {
            let stored: BTreeMap<Vec<u8>, Option<Vec<u8>>> =
                rows.scan(tree, &[])?.into_iter().map(|Row { key, value }| (key, value)).collect();
            for ((_, key), value) in latest.iter().filter(|((name, _), _)| *name == tree.name()) {
                match value {
                    // Missing, or with a broken seal.
                    Some(value) if stored.get(key).is_none_or(Option::is_none) => {
                        lost.put(tree, key.clone(), value.clone());
                    }
                    None if stored.contains_key(key) => lost.remove(tree, key.clone()),
                    _ => {}
                }
            }
        }
        let restored = Restored { rows: lost.changes.len(), damaged_entries };
        if !lost.is_empty() {
            rows.commit(&lost)?;
        }
        let file = write_anew(&rows, path)?;
        Ok((Self { rows, path: path.to_owned(), file: Mutex::new((file, 0)) }, restored))
    }

    fn append(&self, batch: &Batch, sync: bool) -> Result<(), StoreError> {
        let Some(entry) = entry(batch) else { return Ok(()) };
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

/// Writes a journal of the rows as they are, an entry each, and opens it to append.
fn write_anew(rows: &impl Rows, path: &Path) -> Result<File, StoreError> {
    let mut all = String::new();
    for tree in KEPT {
        for Row { key, value } in rows.scan(tree, &[])? {
            // A damaged row that the journal does not have stays where it is, for the queue to report.
            let Some(value) = value else { continue };
            let mut row = Batch::default();
            row.put(tree, key, value);
            all.extend(entry(&row));
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

/// The entry of a batch; `None` if it changes no kept tree.
fn entry(batch: &Batch) -> Option<String> {
    let mut changes = String::new();
    for (tree, key, value) in batch.changes.iter().filter(|(tree, ..)| KEPT.contains(tree)) {
        changes.push(' ');
        changes.push_str(tree.name());
        changes.push(' ');
        changes.push_str(&to_hex(key));
        changes.push(' ');
        changes.push_str(&value.as_deref().map_or_else(|| "-".to_owned(), to_hex));
    }
    (!changes.is_empty()).then(|| format!("\n{}{changes}\n", seal(&changes)))
}

/// The rows that a journal's entries leave, and how many entries are damaged. A last entry that was cut off was never
/// acknowledged.
fn read(bytes: &[u8]) -> (Latest, usize) {
    let (mut latest, mut damaged) = (Latest::new(), 0);
    let mut lines = bytes.split(|byte| *byte == b'\n').filter(|line| !line.is_empty()).peekable();
    while let Some(line) = lines.next() {
        match changes(line) {
            Some(changes) => latest.extend(changes),
            None if lines.peek().is_none() && !bytes.ends_with(b"\n") => {}
            None => damaged += 1,
        }
    }
    (latest, damaged)
}

/// The changes of an entry; `None` for one that is damaged.
fn changes(line: &[u8]) -> Option<Vec<(Place, Option<Vec<u8>>)>> {
    let text = std::str::from_utf8(line).ok()?;
    let (found, changes) = text.split_at_checked(16)?;
    if found != seal(changes) {
        return None;
    }
    let words: Vec<&str> = changes.split_ascii_whitespace().collect();
    let change = |words: &[&str]| {
        let [tree, key, value] = words else { return None };
        let tree = KEPT.iter().find(|kept| kept.name() == *tree)?;
        let value = if *value == "-" { None } else { Some(from_hex(value)?) };
        Some(((tree.name(), from_hex(key)?), value))
    };
    words.chunks(3).map(change).collect()
}

fn seal(changes: &str) -> String {
    to_hex(&Sha256::digest(changes.as_bytes())[..8])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::server::store::memory::MemoryRows;

    fn job(key: &str, value: Option<&str>) -> Batch {
        let mut batch = Batch::default();
        match value {
            Some(value) => {
                batch.put(Tree::Jobs, key, value);
                batch.put(Tree::JobOrder, format!("order of {key}"), key);
            }
            None => batch.remove(Tree::Jobs, key),
        }
        // What is not a job's is not kept.
        batch.put(Tree::Shards, key, "shard");
        batch
    }

    fn jobs(rows: &impl Rows) -> Vec<String> {
        let rows = rows.scan(Tree::Jobs, &[]).unwrap();
        rows.into_iter().map(|row| String::from_utf8(row.value.unwrap()).unwrap()).collect()
    }

    /// The journal of four jobs, of which one has changed and one was removed.
    fn journal(path: &Path) {
        let (rows, _) = JournalledRows::open(MemoryRows::default(), path).unwrap();
        for key in ["a", "b", "c", "d"] {
            rows.commit(&job(key, Some(&format!("{key} queued")))).unwrap();
        }
        rows.stage(&job("b", Some("b running"))).unwrap();
        rows.commit(&job("b", Some("b done"))).unwrap();
        rows.commit(&job("c", None)).unwrap();
    }

    #[test]
    fn what_the_database_lost_is_restored_and_what_it_has_stays() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("jobs.log");
        journal(&path);
        let partial = MemoryRows::default();
        partial.commit(&job("a", Some("a cancelled"))).unwrap();
        let (rows, restored) = JournalledRows::open(partial, &path).unwrap();
        assert_eq!(jobs(&rows), ["a cancelled", "b done", "d queued"]);
        assert_eq!(rows.get(Tree::JobOrder, b"order of d").unwrap().unwrap(), b"d");
        assert_eq!(restored.damaged_entries, 0);
        assert!(restored.rows >= 4, "{restored:?}");
        drop(rows);
        // The journal was written anew, and nothing more is to restore.
        let (rows, _) = JournalledRows::open(MemoryRows::default(), &path).unwrap();
        assert_eq!(jobs(&rows), ["a cancelled", "b done", "d queued"]);
        let (_, restored) = JournalledRows::open(rows.rows, &path).unwrap();
        assert_eq!(restored, Restored::default());
    }

    #[test]
    fn an_entry_that_was_cut_off_hides_no_other() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("jobs.log");
        journal(&path);
        let whole = fs::read(&path).unwrap();
        let end = whole.len() - 1;
        let last = whole[..end].iter().rposition(|byte| *byte == b'\n').unwrap();
        for cut in last + 1..end {
            fs::write(&path, &whole[..cut]).unwrap();
            let (rows, restored) = JournalledRows::open(MemoryRows::default(), &path).unwrap();
            // The last entry removed c.
            assert_eq!(jobs(&rows), ["a queued", "b done", "c queued", "d queued"], "cut at {cut}");
            assert_eq!(restored.damaged_entries, 0);
            rows.commit(&job("e", Some("e queued"))).unwrap();
        }
    }

    /// A whole entry was acknowledged, even if it is the last one. What an older entry says of its job does not undo what
    /// the database has.
    #[test]
    fn a_damaged_last_entry_is_counted_and_reverts_nothing() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("jobs.log");
        let (rows, _) = JournalledRows::open(MemoryRows::default(), &path).unwrap();
        rows.commit(&job("a", Some("a queued"))).unwrap();
        rows.commit(&job("a", Some("a cancelled"))).unwrap();
        let mut bytes = fs::read(&path).unwrap();
        let near_end = bytes.len() - 4;
        bytes[near_end] ^= 1;
        fs::write(&path, bytes).unwrap();
        let (rows, restored) = JournalledRows::open(rows.rows, &path).unwrap();
        assert_eq!(restored, Restored { rows: 0, damaged_entries: 1 });
        assert_eq!(jobs(&rows), ["a cancelled"]);
    }

    #[test]
    fn every_flipped_bit_is_found_and_costs_one_entry_at_most() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("jobs.log");
        journal(&path);
        let whole = fs::read(&path).unwrap();
        for at in 0..whole.len() {
            let mut flipped = whole.clone();
            flipped[at] ^= 1 << (at % 8);
            let (latest, damaged) = read(&flipped);
            let known = |key: &str| latest.contains_key(&(Tree::Jobs.name(), key.as_bytes().to_vec()));
            let missing = ["a", "b", "c", "d"].iter().filter(|key| !known(key)).count();
            // A line break that is gone, or a new one, concerns two entries.
            assert!(damaged <= 2 && missing <= 2, "bit {} of byte {at}: {damaged} {missing}", at % 8);
        }
    }
}
