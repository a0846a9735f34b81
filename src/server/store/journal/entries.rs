//! The entries of a journal as text, and what can be read of them when some are damaged.
//!
//! An entry is a line: 16 hexadecimal digits of its seal, and words. A line break begins an entry and another ends it, so
//! that one that was cut off by a crash or a full disk ends where the next begins.
//!
//! ```text
//! SEAL head R N                       first: the journal begins with all N rows that there were at revision R
//! SEAL R TREE KEY VALUE               N times: a row, with the revision of its last change
//! SEAL R TREE KEY VALUE ...           the changes of a batch, with revisions R + 1, R + 2 and so on
//! ```
//!
//! Keys and values are hexadecimal; the value `-` removes a row. Journals from before there were revisions have no numbers:
//! their entries count as of revision 0.

use std::collections::{BTreeMap, BTreeSet};

use sha2::{Digest as _, Sha256};

use crate::store::{Batch, Tree};
use ltcforge_files::hex::{from_hex, to_hex};

/// The trees whose changes are kept, with their names in the journal. All others can be made again: shards by fitting, the
/// catalogue from the blobs.
pub(super) const KEPT: [(Tree, &str); 2] = [(Tree::Jobs, "jobs"), (Tree::JobOrder, "job_order")];

/// A row by its tree and its key.
pub(super) type Place = (Tree, Vec<u8>);

/// A row as a change left it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Change {
    /// Revision of the change.
    pub(super) revision: u64,
    /// `None` for a removed row.
    pub(super) value: Option<Vec<u8>>,
}

/// What the entries of a journal say.
#[derive(Debug, Default)]
pub(super) struct Entries {
    /// The last change of each row that the journal has.
    pub(super) latest: BTreeMap<Place, Change>,
    /// The revision at which the journal began, and the number of rows that there were.
    pub(super) head: Option<(u64, usize)>,
    /// Rows among those with which it began that can be read.
    first_rows: usize,
    /// Revisions of the batches since then that can be read.
    revisions: BTreeSet<u64>,
    /// Entries that match their seal.
    pub(super) intact: usize,
    /// Entries that do not, a last one that was cut off not counted.
    pub(super) damaged: usize,
    /// Keys of jobs that can be read in damaged entries.
    pub(super) in_damaged: BTreeSet<Vec<u8>>,
    /// Keys of jobs that can be read in a last entry that was cut off; `None` if none was.
    pub(super) in_cut_off: Option<Vec<Vec<u8>>>,
}

impl Entries {
    /// The newest revision that can be read.
    pub(super) fn revision(&self) -> u64 {
        let head = self.head.map_or(0, |(revision, _)| revision);
        self.revisions.last().copied().unwrap_or(0).max(head)
    }

    /// The last change of a row whose last change in the database was at `revision`. A journal that has all rows with which
    /// it began tells also what was removed before.
    pub(super) fn last_change(&self, place: &Place, revision: u64) -> Option<Change> {
        let removed = || match self.head {
            Some((first, rows)) if rows == self.first_rows && revision < first => {
                Some(Change { revision: first, value: None })
            }
            _ => None,
        };
        self.latest.get(place).cloned().or_else(removed)
    }

    /// Number of entries that are missing in a journal that should reach `revision`, damaged ones not counted.
    pub(super) fn missing(&self, revision: u64) -> usize {
        let (first, rows) = self.head.unwrap_or_default();
        let batches = usize::try_from(revision.saturating_sub(first)).unwrap_or(usize::MAX);
        let found = self.revisions.range(..=revision).count();
        let missing = batches.saturating_sub(found).saturating_add(rows.saturating_sub(self.first_rows));
        missing.saturating_sub(self.damaged)
    }

    /// Adds the entry `line`, without its line breaks. Returns whether it matches its seal.
    pub(super) fn add(&mut self, line: &[u8]) -> bool {
        let Some(entry) = Entry::read(line) else { return false };
        self.intact += 1;
        match entry {
            Entry::Head { revision, rows } => self.head = Some((revision, rows)),
            Entry::Changes { revision, changes } => {
                if self.head.is_some_and(|(first, _)| revision <= first) {
                    self.first_rows += 1;
                } else if revision > 0 {
                    self.revisions.insert(revision);
                }
                for (place, value) in changes {
                    if self.latest.get(&place).is_none_or(|last| last.revision <= revision) {
                        self.latest.insert(place, Change { revision, value });
                    }
                }
            }
        }
        true
    }
}

/// The entry that begins a journal of `rows` rows at `revision`.
pub(super) fn head(revision: u64, rows: usize) -> String {
    line(&format!(" head {revision} {rows}"))
}

/// The entry of a row, as its change at `revision` left it.
pub(super) fn row(revision: u64, tree: Tree, key: &[u8], value: &[u8]) -> String {
    let mut words = format!(" {revision}");
    push(&mut words, tree, key, Some(value));
    line(&words)
}

/// The entry of a batch, or of those of its changes that concern a kept tree.
pub(super) fn entry(revision: u64, batch: &Batch) -> String {
    let mut words = format!(" {revision}");
    for (tree, key, value) in &batch.changes {
        push(&mut words, *tree, key, value.as_deref());
    }
    line(&words)
}

/// The revision of a batch's entry, and whether it changes anything; `None` if it is damaged.
pub(super) fn revision_of(line: &[u8]) -> Option<(u64, bool)> {
    match Entry::read(line)? {
        Entry::Changes { revision, changes } => Some((revision, !changes.is_empty())),
        Entry::Head { .. } => None,
    }
}

/// Whether `tree` is kept in the journal.
pub(super) fn is_kept(tree: Tree) -> bool {
    KEPT.iter().any(|(kept, _)| *kept == tree)
}

fn push(words: &mut String, tree: Tree, key: &[u8], value: Option<&[u8]>) {
    let Some((_, name)) = KEPT.iter().find(|(kept, _)| *kept == tree) else { return };
    for word in [*name, &to_hex(key), &value.map_or_else(|| "-".to_owned(), to_hex)] {
        words.push(' ');
        words.push_str(word);
    }
}

fn line(words: &str) -> String {
    format!("\n{}{words}\n", seal(words))
}

/// Reads a journal. Whether a last entry that was cut off was acknowledged, the database has to tell.
pub(super) fn read(bytes: &[u8]) -> Entries {
    let mut entries = Entries::default();
    let mut lines = bytes.split(|byte| *byte == b'\n').filter(|line| !line.is_empty()).peekable();
    while let Some(line) = lines.next() {
        let was_cut_off = lines.peek().is_none() && !bytes.ends_with(b"\n");
        if entries.add(line) {
            continue;
        }
        if was_cut_off {
            entries.in_cut_off = Some(jobs_in_damaged(line));
        } else {
            entries.damaged += 1;
            entries.in_damaged.extend(jobs_in_damaged(line));
        }
    }
    entries
}

enum Entry {
    Head { revision: u64, rows: usize },
    Changes { revision: u64, changes: Vec<(Place, Option<Vec<u8>>)> },
}

impl Entry {
    /// `None` for an entry that is damaged.
    fn read(line: &[u8]) -> Option<Self> {
        let text = std::str::from_utf8(line).ok()?;
        let (found, words) = text.split_at_checked(16)?;
        if found != seal(words) {
            return None;
        }
        let words: Vec<&str> = words.split_ascii_whitespace().collect();
        if let ["head", revision, rows] = words[..] {
            return Some(Self::Head { revision: revision.parse().ok()?, rows: rows.parse().ok()? });
        }
        let (revision, words) = match words.split_first() {
            Some((first, rest)) if first.bytes().all(|byte| byte.is_ascii_digit()) => (first.parse().ok()?, rest),
            _ => (0, &words[..]),
        };
        let change = |words: &[&str]| {
            let [tree, key, value] = words else { return None };
            let (tree, _) = KEPT.iter().find(|(_, name)| name == tree)?;
            let value = if *value == "-" { None } else { Some(from_hex(value)?) };
            Some(((*tree, from_hex(key)?), value))
        };
        let changes = words.chunks(3).map(change).collect::<Option<_>>()?;
        Some(Self::Changes { revision, changes })
    }
}

/// The keys of the jobs that a damaged entry still names, whole ones: a value follows. One may be wrong, so they serve only
/// to name jobs that are found nowhere else.
fn jobs_in_damaged(line: &[u8]) -> Vec<Vec<u8>> {
    let text = String::from_utf8_lossy(line);
    let words: Vec<&str> = text.split_ascii_whitespace().collect();
    words.windows(3).filter(|words| words[0] == "jobs").filter_map(|words| from_hex(words[1])).collect()
}

fn seal(words: &str) -> String {
    to_hex(&Sha256::digest(words.as_bytes())[..8])
}
