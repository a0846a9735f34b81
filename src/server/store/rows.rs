//! Small rows in ordered trees: the interface of the database.

use std::fmt::Debug;

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

    /// Bytes of all keys and values.
    pub(super) fn bytes(&self) -> usize {
        self.changes.iter().map(|(_, key, value)| key.len() + value.as_ref().map_or(0, Vec::len)).sum()
    }
}

/// A key and its value.
pub type Row = (Vec<u8>, Vec<u8>);

/// Rows in ordered trees. All methods block. What [`Rows::commit`] acknowledged survives a power cut.
pub trait Rows: Send + Sync + Debug {
    /// The value of `key`.
    ///
    /// # Errors
    /// [`StoreError::DamagedRow`], or the database's error.
    fn get(&self, tree: Tree, key: &[u8]) -> Result<Option<Vec<u8>>, StoreError>;

    /// All rows whose key begins with `prefix`, in ascending order.
    ///
    /// # Errors
    /// [`StoreError::DamagedRow`], or the database's error.
    fn scan(&self, tree: Tree, prefix: &[u8]) -> Result<Vec<Row>, StoreError>;

    /// Up to `limit` rows below `before`, or from the last row if it is `None`, in descending order.
    ///
    /// # Errors
    /// [`StoreError::DamagedRow`], or the database's error.
    fn page(&self, tree: Tree, before: Option<&[u8]>, limit: usize) -> Result<Vec<Row>, StoreError>;

    /// Applies `batch`; it is durable when this returns.
    ///
    /// # Errors
    /// [`StoreError::DiskFull`], or the database's error. The batch may be stored after the next start, whole, or not.
    fn commit(&self, batch: &Batch) -> Result<(), StoreError>;

    /// Why a job could not be stored now, in words; `None` if it could.
    fn fault(&self) -> Option<String>;
}
