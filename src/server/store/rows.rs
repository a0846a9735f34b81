//! The interface of the database: small rows in ordered trees.

use std::fmt::Debug;

use super::{StoreError, Tree};

/// Changes that are applied together or not at all.
#[derive(Debug, Clone, Default)]
pub struct Batch {
    pub(super) changes: Vec<(Tree, Vec<u8>, Option<Vec<u8>>)>,
}

impl Batch {
    /// Sets a row.
    pub fn put(&mut self, tree: Tree, key: impl Into<Vec<u8>>, value: impl Into<Vec<u8>>) {
        self.changes.push((tree, key.into(), Some(value.into())));
    }

    /// Removes a row. A missing row is not an error.
    pub fn remove(&mut self, tree: Tree, key: impl Into<Vec<u8>>) {
        self.changes.push((tree, key.into(), None));
    }

    /// Appends the changes of `other`.
    pub fn extend(&mut self, other: Self) {
        self.changes.extend(other.changes);
    }

    /// Whether the batch has no changes.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.changes.is_empty()
    }

    /// The number of bytes of all keys and values.
    pub(super) fn bytes(&self) -> usize {
        self.changes.iter().map(|(_, key, value)| key.len() + value.as_ref().map_or(0, Vec::len)).sum()
    }
}

/// A key and its value.
pub type Row = (Vec<u8>, Vec<u8>);

/// Rows in ordered trees. All methods block. A batch survives power cuts once [`Rows::commit`] has returned.
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

    /// Up to `limit` rows with keys below `before`, in descending order. `None` starts at the last row.
    ///
    /// # Errors
    /// [`StoreError::DamagedRow`], or the database's error.
    fn page(&self, tree: Tree, before: Option<&[u8]>, limit: usize) -> Result<Vec<Row>, StoreError>;

    /// Applies `batch` durably.
    ///
    /// # Errors
    /// [`StoreError::DiskFull`], or the database's error. After a restart, either the whole batch is stored or
    /// nothing.
    fn commit(&self, batch: &Batch) -> Result<(), StoreError>;

    /// The reason why a job cannot be stored now. `None` if it can be stored.
    fn fault(&self) -> Option<String>;
}
