//! The journal of jobs and pins, `jobs.log`: the one place where they are stored.
//!
//! A line has the changes of a batch, the first has the number of lines with which the journal began:
//!
//! ```text
//! HASH head LINES
//! HASH jobs KEY VALUE pins KEY VALUE ...
//! ```
//!
//! The hash is the beginning of the words' SHA-256. Hash, keys and values are hexadecimal; the value `-` removes a
//! job or a pin. Later lines win. A line break begins a line and another ends it, so that a damaged line hides no other.
//! Earlier versions put a revision in front of the changes, and had a tree `job_order`; both are skipped.

use std::{
    collections::{BTreeMap, BTreeSet},
    fs::{self, File, OpenOptions},
    io::{self, Write as _},
    path::{Path, PathBuf},
    sync::Arc,
};

use sha2::{Digest as _, Sha256};

use super::{Batch, Damage, Row, StoreError, Tree, files, sled_rows::SyncFn};
use ltcforge_files::hex::{from_hex, to_hex};

/// Bytes that are appended before the journal is written anew.
const MOST_APPENDED: u64 = 64 << 20;

/// The trees whose rows are here. Their names are words of a line.
const TREES: [(Tree, &str); 2] = [(Tree::Jobs, "jobs"), (Tree::Pins, "pins")];

/// Where a row is.
type Place = (Tree, Vec<u8>);

/// A row's place and its value; `None` if it was removed.
type Change = (Place, Option<Vec<u8>>);

/// The open journal.
pub(super) struct Journal {
    path: PathBuf,
    quarantine: PathBuf,
    file: File,
    sync: SyncFn,
    /// Its length without a line that could not be written whole.
    length: u64,
    /// The length beyond which it is written anew.
    most: u64,
    /// Whether a line could not be written whole. It is cut off before the next.
    is_torn: bool,
    /// All pins, which are few and asked for often.
    pins: BTreeMap<Vec<u8>, Vec<u8>>,
}

impl Journal {
    /// Opens the journal at `path` or creates it, and writes it anew with one line a row. A damaged one is copied to
    /// `quarantine` first. Jobs of `earlier` that it does not mention are added; a row without a value is a lost job. On a
    /// full disk it stays as it is, unless jobs are to be added.
    ///
    /// # Errors
    /// When it cannot be read, copied or written.
    pub(super) fn open(
        path: &Path,
        quarantine: &Path,
        earlier: Vec<Row>,
        damage: &mut Damage,
    ) -> Result<Self, StoreError> {
        let mut contents = read(path)?;
        let may_stay = earlier.is_empty() && path.is_file();
        for Row { key, value } in earlier {
            let place = (Tree::Jobs, key);
            if value.is_none() && !contents.rows.contains_key(&place) {
                contents.lost.insert(place);
            } else {
                contents.rows.entry(place).or_insert(value);
            }
        }
        damage.damaged_journal_entries = contents.damaged;
        damage.journal_is_incomplete |= contents.is_cut_short;
        let lost = |wanted| contents.lost.iter().filter(move |(tree, _)| *tree == wanted).map(|(_, key)| key);
        damage.lost_jobs = lost(Tree::Jobs).map(|key| to_hex(key)).collect();
        damage.lost_pins = lost(Tree::Pins).map(|key| pin_in_words(key)).collect();

        contents.rows.retain(|_, value| value.is_some());
        let mut text = line(&format!(" head {}", contents.rows.len()));
        for ((tree, key), value) in &contents.rows {
            text.push_str(&line(&words(*tree, key, value.as_deref())));
        }
        let written = (|| {
            if contents.damaged > 0 || contents.is_cut_short {
                let copied_to = files::copy_to_quarantine(path, quarantine, "jobs.log")?;
                tracing::error!(copied_to = %copied_to.display(), "the damaged journal of jobs was copied to quarantine");
            }
            files::write_durably(path, text.as_bytes())
        })();
        match written {
            Err(StoreError::DiskFull) if may_stay => tracing::warn!("the disk is full: jobs.log was not written anew"),
            written => written?,
        }
        let opened = OpenOptions::new().append(true).open(path);
        let file = opened.map_err(|source| StoreError::of_io(path, source))?;
        let length = file.metadata().map_err(|source| StoreError::of_io(path, source))?.len();
        let (path, quarantine) = (path.to_owned(), quarantine.to_owned());
        let (sync, most) = (Arc::new(File::sync_data), length + MOST_APPENDED);
        let pins = contents.rows.into_iter().filter(|((tree, _), _)| *tree == Tree::Pins);
        let pins = pins.filter_map(|((_, key), value)| Some((key, value?))).collect();
        Ok(Self { path, quarantine, file, sync, length, most, is_torn: false, pins })
    }

    /// Appends the changes of `batch`, which concern jobs and pins alone; `durably` waits for the disk.
    ///
    /// # Errors
    /// [`StoreError::DiskFull`], or the system's error.
    pub(super) fn append(&mut self, batch: &Batch, durably: bool) -> Result<(), StoreError> {
        if self.is_torn {
            self.file.set_len(self.length).map_err(|source| StoreError::of_io(&self.path, source))?;
            self.is_torn = false;
        }
        if self.length > self.most {
            let mut damage = Damage::default();
            *self = Self::open(&self.path, &self.quarantine, vec![], &mut damage)?;
            damage.log();
        }
        let changes = batch.changes.iter().map(|(tree, key, value)| words(*tree, key, value.as_deref()));
        let line = line(&changes.collect::<String>());
        let written = self.file.write_all(line.as_bytes());
        let written = written.and_then(|()| if durably { (self.sync)(&self.file) } else { Ok(()) });
        self.is_torn = written.is_err();
        written.map_err(|source| StoreError::of_io(&self.path, source))?;
        self.length += line.len() as u64;
        for (_, key, value) in batch.changes.iter().filter(|(tree, ..)| *tree == Tree::Pins) {
            match value {
                Some(value) => self.pins.insert(key.clone(), value.clone()),
                None => self.pins.remove(key),
            };
        }
        Ok(())
    }

    /// All rows of `tree`, one of those that are here, in order.
    ///
    /// # Errors
    /// When it cannot be read.
    pub(super) fn rows(&self, tree: Tree) -> Result<Vec<Row>, StoreError> {
        if tree == Tree::Pins {
            return Ok(self
                .pins
                .iter()
                .map(|(key, value)| Row { key: key.clone(), value: Some(value.clone()) })
                .collect());
        }
        let rows = read(&self.path)?.rows.into_iter().filter(|((other, _), value)| *other == tree && value.is_some());
        Ok(rows.map(|((_, key), value)| Row { key, value }).collect())
    }
}

/// The contents of a journal.
#[derive(Debug, Default)]
struct Contents {
    /// The last change of each row.
    rows: BTreeMap<Place, Option<Vec<u8>>>,
    /// Number of damaged lines.
    damaged: usize,
    /// Rows in damaged lines that no later line has.
    lost: BTreeSet<Place>,
    /// Whether there are fewer lines than there were at first, or none that can be read.
    is_cut_short: bool,
}

/// Reads the journal at `path`; a missing one has no rows.
fn read(path: &Path) -> Result<Contents, StoreError> {
    let bytes = match files::refuse_irregular(path).and_then(|()| fs::read(path)) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Vec::new(),
        read => read.map_err(|source| StoreError::of_io(path, source))?,
    };
    let mut contents = Contents::default();
    let (mut lines, mut lines_at_first, mut is_journal) = (0, 0, bytes.is_empty());
    for line in bytes.split(|byte| *byte == b'\n').filter(|line| !line.is_empty()) {
        let line_read = read_line(line);
        is_journal |= line_read.is_some();
        match line_read {
            Some(Line::Head(count)) => lines_at_first = count,
            Some(Line::Changes(changes)) => {
                lines += 1;
                for (place, value) in changes {
                    contents.lost.remove(&place);
                    contents.rows.insert(place, value);
                }
            }
            None => {
                lines += 1;
                contents.damaged += 1;
                contents.lost.extend(places_in_damaged(line));
            }
        }
    }
    contents.is_cut_short = lines < lines_at_first || !is_journal;
    Ok(contents)
}

enum Line {
    Head(usize),
    Changes(Vec<Change>),
}

/// `None` for a damaged line.
fn read_line(line: &[u8]) -> Option<Line> {
    let (found, words) = std::str::from_utf8(line).ok()?.split_at_checked(16)?;
    if found != hash(words) {
        return None;
    }
    let words: Vec<&str> = words.split_ascii_whitespace().collect();
    if let ["head", .., lines] = words[..] {
        return Some(Line::Head(lines.parse().ok()?));
    }
    let has_revision = words.first().is_some_and(|word| word.parse::<u64>().is_ok());
    let change = |words: &[&str]| match words {
        [tree, key, "-"] => Some(((tree_of(tree)?, from_hex(key)?), None)),
        [tree, key, value] => Some(((tree_of(tree)?, from_hex(key)?), Some(from_hex(value)?))),
        _ => None,
    };
    let changes = words[usize::from(has_revision)..].chunks(3).filter(|words| words[0] != "job_order");
    Some(Line::Changes(changes.map(change).collect::<Option<_>>()?))
}

/// The rows that a damaged line still names. One may be misread.
fn places_in_damaged(line: &[u8]) -> Vec<Place> {
    let text = String::from_utf8_lossy(line);
    let words: Vec<&str> = text.split_ascii_whitespace().collect();
    words.windows(2).filter_map(|words| Some((tree_of(words[0])?, from_hex(words[1])?))).collect()
}

fn tree_of(word: &str) -> Option<Tree> {
    TREES.into_iter().find(|(_, name)| *name == word).map(|(tree, _)| tree)
}

/// The table and the name in a pin's key.
fn pin_in_words(key: &[u8]) -> String {
    let (table, name) = key.split_at(key.len().min(32));
    format!("sha256:{} {}", to_hex(table), String::from_utf8_lossy(name).escape_debug())
}

fn words(tree: Tree, key: &[u8], value: Option<&[u8]>) -> String {
    // A batch for the journal has no other tree.
    let name = TREES.iter().find(|(known, _)| *known == tree).map_or("", |(_, name)| name);
    format!(" {name} {} {}", to_hex(key), value.map_or_else(|| "-".to_owned(), to_hex))
}

fn line(words: &str) -> String {
    format!("\n{}{words}\n", hash(words))
}

fn hash(words: &str) -> String {
    to_hex(&Sha256::digest(words.as_bytes())[..8])
}

#[cfg(test)]
mod tests;
