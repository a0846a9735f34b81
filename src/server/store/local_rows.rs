//! [`Rows`] of a data folder: jobs and pins in the journal, everything else in sled.

use std::sync::{Mutex, MutexGuard, PoisonError};

use super::{Batch, Row, Rows, SledRows, Staged, StoreError, Tree, journal::Journal};

/// Rows of a data folder.
pub(super) struct LocalRows {
    pub(super) sled: SledRows,
    journal: Mutex<Journal>,
}

impl std::fmt::Debug for LocalRows {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("LocalRows").field("sled", &self.sled).finish_non_exhaustive()
    }
}

impl LocalRows {
    pub(super) fn new(sled: SledRows, journal: Journal) -> Self {
        Self { sled, journal: Mutex::new(journal) }
    }

    fn journal(&self) -> MutexGuard<'_, Journal> {
        self.journal.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Rows for LocalRows {
    fn get(&self, tree: Tree, key: &[u8]) -> Result<Option<Vec<u8>>, StoreError> {
        if !tree.is_journalled() {
            return self.sled.get(tree, key);
        }
        Ok(self.journal().rows(tree)?.into_iter().find(|row| row.key == key).and_then(|row| row.value))
    }

    fn scan(&self, tree: Tree, prefix: &[u8]) -> Result<Vec<Row>, StoreError> {
        if !tree.is_journalled() {
            return self.sled.scan(tree, prefix);
        }
        let mut rows = self.journal().rows(tree)?;
        rows.retain(|row| row.key.starts_with(prefix));
        Ok(rows)
    }

    fn page(&self, tree: Tree, before: Option<&[u8]>, limit: usize) -> Result<Vec<Row>, StoreError> {
        if !tree.is_journalled() {
            return self.sled.page(tree, before, limit);
        }
        let rows = self.journal().rows(tree)?.into_iter().rev();
        Ok(rows.filter(|row| before.is_none_or(|before| row.key.as_slice() < before)).take(limit).collect())
    }

    fn commit(&self, batch: &Batch) -> Result<(), StoreError> {
        let (journalled, others) = batch.split_journalled();
        if journalled.is_empty() {
            return self.sled.commit(&others);
        }
        self.sled.ensure_room(batch)?;
        if !others.is_empty() {
            self.sled.commit(&others)?;
        }
        self.journal().append(&journalled, true)
    }

    fn stage(&self, batch: &Batch) -> Result<Staged, StoreError> {
        let (journalled, others) = batch.split_journalled();
        let staged = self.sled.stage(&others)?;
        if !journalled.is_empty() {
            self.journal().append(&journalled, false)?;
        }
        Ok(staged)
    }

    fn is_writable(&self) -> bool {
        self.sled.is_writable()
    }

    fn settle(&self, staged: Staged) -> Result<(), StoreError> {
        self.sled.settle(staged)
    }
}
