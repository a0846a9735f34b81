//! [`Rows`] of a data folder: jobs in the journal, everything else in sled.

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
        if tree != Tree::Jobs {
            return self.sled.get(tree, key);
        }
        Ok(self.journal().jobs()?.into_iter().find(|row| row.key == key).and_then(|row| row.value))
    }

    fn scan(&self, tree: Tree, prefix: &[u8]) -> Result<Vec<Row>, StoreError> {
        if tree != Tree::Jobs {
            return self.sled.scan(tree, prefix);
        }
        let mut jobs = self.journal().jobs()?;
        jobs.retain(|row| row.key.starts_with(prefix));
        Ok(jobs)
    }

    fn page(&self, tree: Tree, before: Option<&[u8]>, limit: usize) -> Result<Vec<Row>, StoreError> {
        if tree != Tree::Jobs {
            return self.sled.page(tree, before, limit);
        }
        let jobs = self.journal().jobs()?.into_iter().rev();
        Ok(jobs.filter(|row| before.is_none_or(|before| row.key.as_slice() < before)).take(limit).collect())
    }

    fn commit(&self, batch: &Batch) -> Result<(), StoreError> {
        let (jobs, others) = batch.split_jobs();
        if jobs.is_empty() {
            return self.sled.commit(&others);
        }
        self.sled.ensure_room(batch)?;
        if !others.is_empty() {
            self.sled.commit(&others)?;
        }
        self.journal().append(&jobs, true)
    }

    fn stage(&self, batch: &Batch) -> Result<Staged, StoreError> {
        let (jobs, others) = batch.split_jobs();
        let staged = self.sled.stage(&others)?;
        if !jobs.is_empty() {
            self.journal().append(&jobs, false)?;
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
