//! Small rows in ordered trees: the interface of the database.

use std::fmt::Debug;

use super::StoreError;

/// A tree of the database; `migrations/` creates them. Each variant says what key and value are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Tree {
    /// Job id: the job and its shards.
    Jobs,
    /// Job id and shard number, big-endian: a finished shard's bytes, until the job ends.
    Results,
    /// Table digest: its row in the list of tables.
    Tables,
    /// Microseconds since 1970, big-endian, and table digest: empty.
    TablesByAge,
    /// Recipe digest: the recipe and its table.
    Recipes,
    /// Table digest: the version of its manifest, and the manifest.
    Manifests,
    /// BRDF digest: its row in the list of BRDFs.
    Brdfs,
}

impl Tree {
    /// Every tree.
    pub const ALL: [Self; 7] =
        [Self::Jobs, Self::Results, Self::Tables, Self::TablesByAge, Self::Recipes, Self::Manifests, Self::Brdfs];

    /// The tree's name in the database.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Jobs => "jobs",
            Self::Results => "results",
            Self::Tables => "tables",
            Self::TablesByAge => "tables_by_age",
            Self::Recipes => "recipes",
            Self::Manifests => "manifests",
            Self::Brdfs => "brdfs",
        }
    }
}

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
