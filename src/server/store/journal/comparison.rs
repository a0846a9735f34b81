//! A database compared with its journal: whichever has the newer revision of a row is right.

use std::collections::{BTreeMap, BTreeSet};

use super::entries::{self, Change, Entries, KEPT, Place};
use crate::store::{Batch, Findings, Row, Rows, StoreError, Tree, numbered};
use ltcforge_files::hex::to_hex;

/// Key of the journal's last entry in the database.
pub(super) const LAST: &[u8] = b"last";
/// Jobs that a database from before there were revisions may have and its journal not: the one whose commit a crash
/// interrupted between the two.
const UNFINISHED: usize = 1;

/// What a database lacks of its journal.
#[derive(Debug)]
pub(super) struct Comparison {
    /// The newest revision of the two.
    pub(super) revision: u64,
    /// The changes of the database, values joined with their revisions, that bring it up to date.
    pub(super) changes: Batch,
    /// Whether the database has rows that are older than the journal's.
    pub(super) database_is_older: bool,
}

/// A row with the revision of its last change; `None` for one with a broken seal.
type StoredRow = Option<(u64, Vec<u8>)>;

/// What a database has of its jobs.
struct Stored {
    rows: BTreeMap<Place, StoredRow>,
    /// The last entry of its journal, with its revision and whether it changes anything.
    last: Option<(u64, bool, Vec<u8>)>,
}

impl Stored {
    fn read(rows: &dyn Rows) -> Result<Self, StoreError> {
        let mut stored = BTreeMap::new();
        for (tree, _) in KEPT {
            for Row { key, value } in rows.scan(tree, &[])? {
                let value = value.as_deref().and_then(numbered::split);
                stored.insert((tree, key), value.map(|(revision, value)| (revision, value.to_vec())));
            }
        }
        let last = match rows.get(Tree::Journal, LAST) {
            Err(StoreError::DamagedRow { .. }) => None,
            found => found?,
        };
        let last = last.and_then(|line| {
            let (revision, has_changes) = entries::revision_of(&line)?;
            Some((revision, has_changes, line))
        });
        Ok(Self { rows: stored, last })
    }

    /// The newest revision of which it knows.
    fn revision(&self) -> u64 {
        let of_rows = self.rows.values().flatten().map(|(revision, _)| *revision);
        of_rows.chain(self.last.iter().map(|(revision, ..)| *revision)).max().unwrap_or(0)
    }

    /// Keys of all jobs, and whether the row is intact.
    fn jobs(&self) -> impl Iterator<Item = (&Vec<u8>, bool)> {
        let jobs = self.rows.iter().filter(|((tree, _), _)| *tree == Tree::Jobs);
        jobs.map(|((_, key), row)| (key, row.is_some()))
    }

    /// Number of intact jobs of which a journal knows nothing.
    fn lacking_in(&self, entries: &Entries) -> usize {
        let is_known = |key: &Vec<u8>| entries.latest.contains_key(&(Tree::Jobs, key.clone()));
        self.jobs().filter(|(key, is_intact)| *is_intact && !is_known(key)).count()
    }
}

/// Compares `rows` with the journal whose bytes are `journal`, `None` if it has no file. `was_journalled` tells whether
/// `rows` ever had one. `found` is told what was lost or reverted, and which jobs can be restored.
///
/// # Errors
/// When the database fails.
pub(super) fn compare(
    rows: &dyn Rows,
    journal: Option<&[u8]>,
    was_journalled: bool,
    found: &mut Findings,
) -> Result<Comparison, StoreError> {
    let stored = Stored::read(rows)?;
    let mut entries = entries::read(journal.unwrap_or_default());
    let has_entries = entries.intact > 0;
    found.database_is_older = has_entries && stored.revision() < entries.revision();
    // The database gets a change before the journal does. If it knows of none after the last whole entry, the one that was
    // cut off was acknowledged, and the database has lost it.
    let has_revisions = stored.revision() > 0 || entries.head.is_some();
    let lacks_cut_off = match entries.in_cut_off.take() {
        Some(jobs) if has_revisions && stored.revision() <= entries.revision() => {
            entries.in_damaged.extend(jobs);
            true
        }
        _ => false,
    };
    // A crash may have come between the database and the journal.
    if let Some((revision, true, last)) = &stored.last
        && *revision > entries.revision()
    {
        entries.add(last);
    }
    let revision = entries.revision().max(stored.revision());
    let lacks_all = !has_entries
        && (found.database_was_replaced || journal.is_some() || revision > 0 || stored.jobs().next().is_some());
    let lacks_some = if revision > 0 || entries.head.is_some() {
        entries.missing(revision) > 0
    } else {
        stored.lacking_in(&entries) > UNFINISHED + entries.damaged
    };
    found.journal_is_incomplete =
        (was_journalled || found.database_was_replaced || revision > 0) && (lacks_all || lacks_some || lacks_cut_off);

    let mut changes = Batch::default();
    let (mut restored_jobs, mut reverted_jobs) = (BTreeSet::new(), BTreeSet::new());
    let places: BTreeSet<&Place> = stored.rows.keys().chain(entries.latest.keys()).collect();
    let mut database_is_older = false;
    for place @ (tree, key) in places {
        let row = stored.rows.get(place);
        let Some(change) = wanted(row, place, &entries) else { continue };
        let was_intact = matches!(row, Some(Some(_)));
        database_is_older |= was_intact;
        if *tree == Tree::Jobs && (was_intact || change.value.is_some()) {
            let jobs = if was_intact { &mut reverted_jobs } else { &mut restored_jobs };
            jobs.insert(to_hex(key));
        }
        match &change.value {
            Some(value) => changes.put(*tree, key.clone(), numbered::join(change.revision, value)),
            None => changes.remove(*tree, key.clone()),
        }
    }
    let is_changed = |key: &Vec<u8>| changes.changes.iter().any(|(tree, other, _)| *tree == Tree::Jobs && other == key);
    let broken = stored.jobs().filter(|(_, is_intact)| !is_intact).map(|(key, _)| key);
    found.lost_jobs = broken.filter(|key| !is_changed(key)).map(|key| to_hex(key)).collect();
    let known = stored.rows.keys().chain(entries.latest.keys()).filter(|(tree, _)| *tree == Tree::Jobs);
    let known: Vec<&Vec<u8>> = known.map(|(_, key)| key).collect();
    let in_damaged = entries.in_damaged.iter().filter(|key| !known.iter().any(|known| may_be(known, key)));
    found.doubtful_jobs = in_damaged.map(|key| to_hex(key)).collect();
    found.restored_rows = changes.changes.len();
    found.restored_jobs = restored_jobs.into_iter().collect();
    found.reverted_jobs = reverted_jobs.into_iter().collect();
    found.damaged_journal_entries = entries.damaged;
    if stored.last.is_none_or(|(last, ..)| last != revision) {
        changes.put(Tree::Journal, LAST, entries::entry(revision, &Batch::default()).trim());
    }
    Ok(Comparison { revision, changes, database_is_older })
}

/// Part of a key, as one in so many bytes, that may differ in the same key misread.
const MISREAD: usize = 4;

/// Whether `read`, found in a damaged entry, may be the key `known` with wrong or missing bytes. Keys of jobs are parts of
/// digests: two jobs' differ in nearly all bytes.
fn may_be(known: &[u8], read: &[u8]) -> bool {
    let different = known.iter().zip(read).filter(|(a, b)| a != b).count();
    known.starts_with(read) || (known.len() == read.len() && MISREAD * different <= known.len())
}

/// What the row at `place` has to be, if it is not what it has to be; `row` is `None` if there is none.
fn wanted(row: Option<&StoredRow>, place: &Place, entries: &Entries) -> Option<Change> {
    match row {
        Some(Some((revision, value))) => {
            let last = entries.last_change(place, *revision)?;
            (*revision < last.revision && last.value.as_ref() != Some(value)).then_some(last)
        }
        Some(None) => entries.latest.get(place).cloned(),
        None => entries.latest.get(place).filter(|last| last.value.is_some()).cloned(),
    }
}
