//! Small rows in ordered trees: the interface of the database.

use sha2::{Digest as _, Sha256};

use super::{StoreError, Tree};

/// Changes that are made together or not at all.
#[derive(Debug, Clone, Default)]
pub struct Batch {
    pub(super) changes: Vec<(Tree, Vec<u8>, Option<Vec<u8>>)>,
}

impl Batch {
    /// Sets a row.
    pub fn put(&mut self, tree: Tree, key: impl Into<Vec<u8>>, value: impl Into<Vec<u8>>) {
        self.changes.push((tree, key.into(), Some(value.into())));
    }

    /// Removes a row; a missing row is no error.
    pub fn remove(&mut self, tree: Tree, key: impl Into<Vec<u8>>) {
        self.changes.push((tree, key.into(), None));
    }

    /// Adds the changes of `other`, after those already here.
    pub fn extend(&mut self, other: Self) {
        self.changes.extend(other.changes);
    }

    /// Whether there is nothing to change.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.changes.is_empty()
    }

    /// The changes of rows that the journal has, and all others.
    pub(super) fn split_journalled(&self) -> (Self, Self) {
        let (journalled, others) = self.changes.iter().cloned().partition(|(tree, ..)| tree.is_journalled());
        (Self { changes: journalled }, Self { changes: others })
    }

    /// Bytes of all keys and values.
    pub(super) fn bytes(&self) -> usize {
        self.changes.iter().map(|(_, key, value)| key.len() + value.as_ref().map_or(0, Vec::len)).sum()
    }
}

/// One row of a scan.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Row {
    /// Its key.
    pub key: Vec<u8>,
    /// Its value; `None` if it does not match the hash stored with it.
    pub value: Option<Vec<u8>>,
}

/// What has to be so for a batch to be applied.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Condition {
    /// There is a row with this key.
    There(Tree, Vec<u8>),
    /// No key begins so.
    NoneBelow(Tree, Vec<u8>),
}

/// Changes that were staged: which opening of the database has them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Staged(pub(super) u64);

/// Rows in ordered trees. What [`Rows::commit`] acknowledged survives a power cut.
pub trait Rows: Send + Sync + std::fmt::Debug {
    /// The value of `key`.
    ///
    /// # Errors
    /// [`StoreError::DamagedRow`], or the database's error.
    fn get(&self, tree: Tree, key: &[u8]) -> Result<Option<Vec<u8>>, StoreError>;

    /// All rows whose key begins with `prefix`, in ascending order.
    ///
    /// # Errors
    /// The database's error. Damaged rows are in the result, without a value.
    fn scan(&self, tree: Tree, prefix: &[u8]) -> Result<Vec<Row>, StoreError>;

    /// Up to `limit` rows below `before`, or from the last row if it is `None`, in descending order.
    ///
    /// # Errors
    /// The database's error. Damaged rows are in the result, without a value.
    fn page(&self, tree: Tree, before: Option<&[u8]>, limit: usize) -> Result<Vec<Row>, StoreError>;

    /// Number of tables in the catalogue and bytes of their files, where they are counted as they change.
    ///
    /// # Errors
    /// The database's error.
    fn totals(&self) -> Result<Option<(u64, u64)>, StoreError> {
        Ok(None)
    }

    /// Applies `batch`; it is durable when this returns. Where jobs and pins have a journal, their changes come last.
    ///
    /// # Errors
    /// [`StoreError::DiskFull`], or the database's error. The batch is then not acknowledged: after the next start it
    /// may be stored or not, or without its changes of jobs and pins.
    fn commit(&self, batch: &Batch) -> Result<(), StoreError>;

    /// Applies `batch` as [`Self::commit`] does, if all `conditions` hold, and tells whether they did. Of the processes that
    /// share a database, one at a time does so; the callers in one process see to it themselves.
    ///
    /// # Errors
    /// As [`Self::commit`].
    fn commit_if(&self, conditions: &[Condition], batch: &Batch) -> Result<bool, StoreError> {
        for condition in conditions {
            let holds = match condition {
                Condition::There(tree, key) => self.get(*tree, key)?.is_some(),
                Condition::NoneBelow(tree, prefix) => self.scan(*tree, prefix)?.is_empty(),
            };
            if !holds {
                return Ok(false);
            }
        }
        self.commit(batch).map(|()| true)
    }

    /// Whether the disk has room for what a submission commits.
    fn is_writable(&self) -> bool {
        true
    }

    /// Applies `batch` without waiting for the disk; it is durable with the next [`Rows::commit`] or [`Rows::settle`].
    ///
    /// # Errors
    /// As [`Rows::commit`].
    fn stage(&self, batch: &Batch) -> Result<Staged, StoreError>;

    /// Waits until the staged changes, and all before them, are durable. Others may stage and read meanwhile.
    ///
    /// # Errors
    /// The database's error, or that it was closed since by the error of another write: the changes may be stored or
    /// not, but never in part.
    fn settle(&self, staged: Staged) -> Result<(), StoreError>;
}

/// Bytes of the hash in front of each stored value.
const SEAL_BYTES: usize = 8;

/// A value as it is stored: the beginning of the SHA-256 of tree, key and value, then the value. This detects bit flips
/// and values under a wrong key.
pub(super) fn seal(tree: &str, key: &[u8], value: &[u8]) -> Vec<u8> {
    let mut sealed = hash(tree, key, value).to_vec();
    sealed.extend_from_slice(value);
    sealed
}

/// The inverse of [`seal`]; `None` when the hash does not match.
pub(super) fn unseal(tree: &str, key: &[u8], sealed: &[u8]) -> Option<Vec<u8>> {
    let (found, value) = sealed.split_at_checked(SEAL_BYTES)?;
    (found == hash(tree, key, value)).then(|| value.to_vec())
}

fn hash(tree: &str, key: &[u8], value: &[u8]) -> [u8; SEAL_BYTES] {
    let mut hasher = Sha256::new();
    for part in [tree.as_bytes(), key] {
        hasher.update((part.len() as u64).to_le_bytes());
        hasher.update(part);
    }
    hasher.update(value);
    let full = hasher.finalize();
    std::array::from_fn(|i| full[i])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sealed_value_opens_under_its_own_key_only_and_every_bit_flip_is_detected() {
        let sealed = seal("jobs", b"key", b"value");
        assert_eq!(unseal("jobs", b"key", &sealed).unwrap(), b"value");
        assert!(unseal("jobs", b"kex", &sealed).is_none());
        assert!(unseal("shards", b"key", &sealed).is_none());
        for bit in 0..sealed.len() * 8 {
            let mut damaged = sealed.clone();
            damaged[bit / 8] ^= 1 << (bit % 8);
            assert!(unseal("jobs", b"key", &damaged).is_none(), "bit {bit}");
        }
        assert!(unseal("jobs", b"key", b"short").is_none());
    }
}
