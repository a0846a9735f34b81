//! [`Rows`] in memory.

use std::{
    collections::BTreeMap,
    sync::{Mutex, MutexGuard, PoisonError},
};

use super::{Batch, Row, Rows, StoreError, Tree};

type ByKey = BTreeMap<(Tree, Vec<u8>), Vec<u8>>;

/// Rows in memory. They are lost when the process ends.
#[derive(Debug, Default)]
pub struct MemoryRows {
    rows: Mutex<ByKey>,
    refuses_jobs: bool,
}

impl MemoryRows {
    /// Rows that replace the database while the disk is full. Jobs are refused with [`StoreError::DiskFull`].
    #[must_use]
    pub fn of_full_disk() -> Self {
        Self { refuses_jobs: true, ..Self::default() }
    }

    fn rows(&self) -> MutexGuard<'_, ByKey> {
        self.rows.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Rows for MemoryRows {
    fn get(&self, tree: Tree, key: &[u8]) -> Result<Option<Vec<u8>>, StoreError> {
        Ok(self.rows().get(&(tree, key.to_vec())).cloned())
    }

    fn scan(&self, tree: Tree, prefix: &[u8]) -> Result<Vec<Row>, StoreError> {
        let rows = self.rows();
        let from = rows.range((tree, prefix.to_vec())..);
        let found = from.take_while(|((of, key), _)| *of == tree && key.starts_with(prefix));
        Ok(found.map(|((_, key), value)| (key.clone(), value.clone())).collect())
    }

    fn page(&self, tree: Tree, before: Option<&[u8]>, limit: usize) -> Result<Vec<Row>, StoreError> {
        let rows = self.rows();
        let all = rows
            .range((tree, vec![])..)
            .take_while(|((of, key), _)| *of == tree && before.is_none_or(|before| key.as_slice() < before));
        let mut found: Vec<Row> = all.map(|((_, key), value)| (key.clone(), value.clone())).collect();
        found.reverse();
        found.truncate(limit);
        Ok(found)
    }

    fn commit(&self, batch: &Batch) -> Result<(), StoreError> {
        let is_job = |tree: Tree| matches!(tree, Tree::Jobs | Tree::Results);
        if self.refuses_jobs && batch.changes.iter().any(|(tree, _, value)| is_job(*tree) && value.is_some()) {
            return Err(StoreError::DiskFull);
        }
        let mut rows = self.rows();
        for (tree, key, value) in &batch.changes {
            match value {
                Some(value) => rows.insert((*tree, key.clone()), value.clone()),
                None => rows.remove(&(*tree, key.clone())),
            };
        }
        Ok(())
    }

    fn fault(&self) -> Option<String> {
        self.refuses_jobs.then(|| super::DISK_FULL.to_owned())
    }
}
