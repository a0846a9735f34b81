//! The entries of a journal as text, and what can be read of them when some are damaged.
//!
//! An entry is a line: 16 hexadecimal digits of its seal, and the changes of a batch, each as tree, key and value in
//! hexadecimal, `-` for a row that was removed. A line break begins an entry and another ends it, so that one that was cut
//! off by a crash or a full disk ends where the next begins. The first entry has no changes: a journal without any entry
//! is not one that this program left.

use std::collections::{BTreeMap, BTreeSet};

use sha2::{Digest as _, Sha256};

use crate::{
    files::hex::{from_hex, to_hex},
    server::store::{Batch, Tree},
};

/// The trees whose changes are kept. All others can be made again: shards by fitting, the catalogue from the blobs.
pub(super) const KEPT: [Tree; 2] = [Tree::Jobs, Tree::JobOrder];

/// A row by the name of its tree and its key.
type Place = (&'static str, Vec<u8>);

/// What the entries of a journal say.
#[derive(Debug, Default)]
pub(super) struct Entries {
    /// The kept rows as the journal last saw them; `None` for a removed row.
    pub(super) latest: BTreeMap<Place, Option<Vec<u8>>>,
    /// Entries that match their seal.
    pub(super) intact: usize,
    /// Entries that do not, an interrupted last one not counted.
    pub(super) damaged: usize,
    /// Keys of jobs that can be read in damaged entries.
    pub(super) in_damaged: BTreeSet<Vec<u8>>,
}

/// The entry that begins a journal.
pub(super) fn first() -> String {
    format!("\n{}\n", seal(""))
}

/// The entry of a batch; `None` if it changes no kept tree.
pub(super) fn entry(batch: &Batch) -> Option<String> {
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

/// Reads a journal. A last entry that was cut off was never acknowledged.
pub(super) fn read(bytes: &[u8]) -> Entries {
    let mut entries = Entries::default();
    let mut lines = bytes.split(|byte| *byte == b'\n').filter(|line| !line.is_empty()).peekable();
    while let Some(line) = lines.next() {
        match changes(line) {
            Some(changes) => {
                entries.latest.extend(changes);
                entries.intact += 1;
            }
            None if lines.peek().is_none() && !bytes.ends_with(b"\n") => {}
            None => {
                entries.damaged += 1;
                entries.in_damaged.extend(jobs_in_damaged(line));
            }
        }
    }
    entries
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

/// The keys of the jobs that a damaged entry still names. One may be wrong, so they serve only to name jobs that are
/// found nowhere else.
fn jobs_in_damaged(line: &[u8]) -> Vec<Vec<u8>> {
    let text = String::from_utf8_lossy(line);
    let words: Vec<&str> = text.split_ascii_whitespace().collect();
    words.windows(2).filter(|pair| pair[0] == Tree::Jobs.name()).filter_map(|pair| from_hex(pair[1])).collect()
}

fn seal(changes: &str) -> String {
    to_hex(&Sha256::digest(changes.as_bytes())[..8])
}
