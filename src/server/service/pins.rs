//! Pins: names by which tables are kept, whatever the size of the store, until the pin is taken off.

use std::{collections::BTreeSet, fmt, str::FromStr, sync::PoisonError};

use jiff::Timestamp;
use serde::{Deserialize, Serialize};

use super::{Service, ServiceError};
use crate::store::{Batch, Condition, Rows, StoreError, Tree};
use ltcforge_client::{LockFile, LockFileError};
use ltcforge_files::{digest::Digest, text::without_mark};

/// Pins that a table may have.
const MOST_PINS: usize = 256;

/// Longest name of a pin.
const LONGEST_NAME: usize = 64;

/// The name of a pin: that of a project or a release, say.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(transparent)]
pub struct PinName(String);

/// A text is not the name of a pin.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("«{}» is not the name of a pin: a name is 1 to {LONGEST_NAME} letters, digits and -_.@", .0.escape_debug())]
pub struct ParsePinNameError(String);

impl FromStr for PinName {
    type Err = ParsePinNameError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let is_allowed = |byte: u8| byte.is_ascii_alphanumeric() || b"-_.@".contains(&byte);
        if (1..=LONGEST_NAME).contains(&text.len()) && text.bytes().all(is_allowed) {
            return Ok(Self(text.to_owned()));
        }
        Err(ParsePinNameError(text.to_owned()))
    }
}

impl fmt::Display for PinName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

/// A pin of a table.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct TablePin {
    /// Its name.
    pub name: PinName,
    /// When it was put on.
    pub created_at: Timestamp,
    /// Who put it on: the name of a token; `None` where none was needed.
    pub created_by: Option<String>,
}

/// A pin's row; its key has the rest.
#[derive(Debug, Serialize, Deserialize)]
struct PinRow {
    created_at: Timestamp,
    created_by: Option<String>,
}

/// What became of the tables of a lock file.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
pub struct PinnedLock {
    /// Those that have the pin now.
    pub pinned: Vec<LockedTable>,
    /// Those that are not stored here.
    pub unknown: Vec<LockedTable>,
    /// Tables that had the pin, are not in the lock file, and do not have it any more.
    pub unpinned: Vec<Digest>,
}

/// A table of a lock file.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct LockedTable {
    /// Its name there.
    pub name: String,
    /// Its digest.
    pub table: Digest,
}

/// Why a table was not pinned.
#[derive(Debug, thiserror::Error)]
pub enum PinError {
    /// It is not stored.
    #[error("no table with the digest {0} is stored")]
    Unknown(Digest),
    /// It has as many pins as a table may have.
    #[error("the table {0} has {MOST_PINS} pins, as many as a table may have")]
    TooMany(Digest),
    /// The text that was sent is no lock file.
    #[error("the lock file: {0}")]
    Lock(#[from] LockFileError),
    /// The store failed.
    #[error(transparent)]
    Store(#[from] ServiceError),
}

impl From<StoreError> for PinError {
    fn from(error: StoreError) -> Self {
        Self::Store(error.into())
    }
}

/// The key of a pin.
fn key(table: Digest, name: &PinName) -> Vec<u8> {
    [table.as_bytes().as_slice(), name.0.as_bytes()].concat()
}

/// The table and the name in a pin's key.
fn parts(key: &[u8]) -> Option<(Digest, PinName)> {
    let (table, name) = key.split_first_chunk()?;
    Some((Digest::from_bytes(*table), str::from_utf8(name).ok()?.parse().ok()?))
}

/// The condition that a table has no pin.
pub(super) fn unpinned(table: Digest) -> Condition {
    Condition::NoneBelow(Tree::Pins, table.as_bytes().to_vec())
}

/// The tables that have a pin, whatever is left of its row.
pub(super) fn pinned(rows: &dyn Rows) -> Result<BTreeSet<Digest>, StoreError> {
    let keys = rows.scan(Tree::Pins, &[])?.into_iter();
    Ok(keys.filter_map(|row| row.key.first_chunk().copied()).map(Digest::from_bytes).collect())
}

/// The pins of a table, by name.
pub(super) fn pins_of(rows: &dyn Rows, table: Digest) -> Result<Vec<TablePin>, StoreError> {
    let stored = rows.scan(Tree::Pins, table.as_bytes())?.into_iter();
    let pin = |row: crate::store::Row| {
        let (_, name) = parts(&row.key)?;
        let PinRow { created_at, created_by } = serde_json::from_slice(&row.value?).ok()?;
        Some(TablePin { name, created_at, created_by })
    };
    Ok(stored.filter_map(pin).collect())
}

impl Service {
    /// Puts a pin on a table, durably when this returns. Tells whether the table had it before; then it stays as it is.
    ///
    /// # Errors
    /// See [`PinError`].
    pub fn pin(&self, table: Digest, name: &PinName, by: Option<&str>) -> Result<(TablePin, bool), PinError> {
        // Only processes that share the store need more than this lock.
        let _keeping = self.state.naming.read().unwrap_or_else(PoisonError::into_inner);
        let rows = &self.state.tables.store.rows;
        let pins = pins_of(rows.as_ref(), table)?;
        if let Some(pin) = pins.iter().find(|pin| pin.name == *name) {
            return Ok((pin.clone(), true));
        }
        if pins.len() >= MOST_PINS {
            return Err(PinError::TooMany(table));
        }
        let row = PinRow { created_at: self.state.queue.now(), created_by: by.map(str::to_owned) };
        let value = serde_json::to_vec(&row).map_err(|error| StoreError::Database(error.to_string()))?;
        let mut batch = Batch::default();
        batch.put(Tree::Pins, key(table, name), value);
        if !rows.commit_if(&[Condition::There(Tree::Tables, table.as_bytes().to_vec())], &batch)? {
            return Err(PinError::Unknown(table));
        }
        let PinRow { created_at, created_by } = row;
        Ok((TablePin { name: name.clone(), created_at, created_by }, false))
    }

    /// Takes a pin off a table. Tells whether the table had it.
    ///
    /// # Errors
    /// When the store fails.
    pub fn unpin(&self, table: Digest, name: &PinName) -> Result<bool, ServiceError> {
        let rows = &self.state.tables.store.rows;
        let key = key(table, name);
        let had_it = rows.get(Tree::Pins, &key)?.is_some();
        let mut batch = Batch::default();
        batch.remove(Tree::Pins, key);
        rows.commit(&batch)?;
        Ok(had_it)
    }

    /// The pins of a table, by name; `None` if it is not stored.
    ///
    /// # Errors
    /// When the store fails.
    pub fn pins(&self, table: Digest) -> Result<Option<Vec<TablePin>>, ServiceError> {
        let tables = &self.state.tables;
        if tables.catalogue.table(table)?.is_none() {
            return Ok(None);
        }
        Ok(Some(pins_of(tables.store.rows.as_ref(), table)?))
    }

    /// Gives the pin `name` to the tables of a lock file, and takes it off all others: it then keeps what the project needs
    /// now. A table that is not stored here is told and changes nothing for the others.
    ///
    /// # Errors
    /// See [`PinError`]. The pins may have changed in part after an error of the store; the same call again completes it.
    pub fn pin_lock(&self, name: &PinName, lock: &[u8], by: Option<&str>) -> Result<PinnedLock, PinError> {
        let text =
            str::from_utf8(without_mark(lock)).map_err(|error| LockFileError::Syntax(format!("not UTF-8: {error}")));
        let lock = LockFile::parse(text?, "ltcforge.lock".as_ref())?;
        let mut done = PinnedLock::default();
        for pin in &lock.pins {
            let locked = LockedTable { name: pin.name.clone(), table: pin.digest };
            match self.pin(pin.digest, name, by) {
                Ok(_) => done.pinned.push(locked),
                Err(PinError::Unknown(_)) => done.unknown.push(locked),
                Err(error) => return Err(error),
            }
        }
        let wanted: BTreeSet<Digest> = lock.pins.iter().map(|pin| pin.digest).collect();
        let rows = &self.state.tables.store.rows;
        let mut batch = Batch::default();
        for row in rows.scan(Tree::Pins, &[])? {
            if let Some((table, other)) = parts(&row.key)
                && other == *name
                && !wanted.contains(&table)
            {
                batch.remove(Tree::Pins, row.key);
                done.unpinned.push(table);
            }
        }
        if !batch.is_empty() {
            rows.commit(&batch)?;
        }
        Ok(done)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_is_short_and_plain() {
        for good in ["metal", "film-2026.1", "a@b_c", &"x".repeat(64)] {
            let name: PinName = good.parse().unwrap();
            let table = Digest::of(b"table");
            assert_eq!(parts(&key(table, &name)), Some((table, name)));
        }
        for bad in ["", "a/b", "a b", "ü", "a\n", &"x".repeat(65)] {
            let error = bad.parse::<PinName>().unwrap_err().to_string();
            assert!(error.contains("1 to 64 letters"), "{error}");
        }
    }
}
