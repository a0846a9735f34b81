//! Rows that fail on demand.

use std::sync::{
    Arc,
    atomic::{AtomicBool, Ordering},
};

use crate::store::{Batch, MemoryRows, Row, Rows, StoreError, Tree};

/// Rows in memory. They outlive the queue that uses them.
#[derive(Debug, Default, Clone)]
pub(crate) struct PowerRows {
    pub(crate) rows: Arc<MemoryRows>,
    /// While this is set, nothing can be written.
    pub(crate) is_full: Arc<AtomicBool>,
}

impl Rows for PowerRows {
    fn get(&self, tree: Tree, key: &[u8]) -> Result<Option<Vec<u8>>, StoreError> {
        self.rows.get(tree, key)
    }

    fn scan(&self, tree: Tree, prefix: &[u8]) -> Result<Vec<Row>, StoreError> {
        self.rows.scan(tree, prefix)
    }

    fn page(&self, tree: Tree, before: Option<&[u8]>, limit: usize) -> Result<Vec<Row>, StoreError> {
        self.rows.page(tree, before, limit)
    }

    fn commit(&self, batch: &Batch) -> Result<(), StoreError> {
        if self.is_full.load(Ordering::Relaxed) { Err(StoreError::DiskFull) } else { self.rows.commit(batch) }
    }

    fn fault(&self) -> Option<String> {
        self.is_full.load(Ordering::Relaxed).then(|| "full".to_owned())
    }
}
