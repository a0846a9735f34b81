//! Rows in memory, with a simulated disk that can be full, for tests of the users of [`Rows`].

use std::{
    collections::BTreeMap,
    sync::{
        Mutex,
        atomic::{AtomicBool, AtomicU64, Ordering},
    },
};

use crate::store::{Batch, Row, Rows, Staged, StoreError, Tree};

type Map = BTreeMap<(Tree, Vec<u8>), Vec<u8>>;

/// [`Rows`] for tests.
#[derive(Debug, Default)]
pub(crate) struct MemoryRows {
    rows: Mutex<Map>,
    durable: Mutex<Map>,
    /// While set, every write fails.
    pub(crate) full: AtomicBool,
    /// While set, the process has no descriptor left for a write.
    pub(crate) without_descriptors: AtomicBool,
    /// Writes that failed for lack of a descriptor or of room.
    pub(crate) refused: AtomicU64,
    /// Number of acknowledged commits.
    pub(crate) commits: AtomicU64,
    /// Called while the next [`Rows::settle`] waits for the disk.
    pub(crate) while_settling: Mutex<Option<Meanwhile>>,
}

/// Runs while a test's disk is waited for.
pub(crate) struct Meanwhile(pub(crate) Box<dyn FnOnce() + Send>);

impl std::fmt::Debug for Meanwhile {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Meanwhile(..)")
    }
}

impl MemoryRows {
    /// The rows that a power cut now would leave.
    pub(crate) fn after_power_cut(&self) -> Self {
        let durable = self.durable.lock().unwrap().clone();
        Self { rows: Mutex::new(durable.clone()), durable: Mutex::new(durable), ..Self::default() }
    }

    /// Number of rows of `tree`.
    pub(crate) fn len(&self, tree: Tree) -> usize {
        self.rows.lock().unwrap().keys().filter(|(t, _)| *t == tree).count()
    }

    fn flush(&self) {
        *self.durable.lock().unwrap() = self.rows.lock().unwrap().clone();
        self.commits.fetch_add(1, Ordering::Relaxed);
    }

    fn collect<'a>(rows: impl Iterator<Item = (&'a (Tree, Vec<u8>), &'a Vec<u8>)>) -> Vec<Row> {
        rows.map(|((_, key), value)| Row { key: key.clone(), value: Some(value.clone()) }).collect()
    }
}

impl Rows for MemoryRows {
    fn get(&self, tree: Tree, key: &[u8]) -> Result<Option<Vec<u8>>, StoreError> {
        Ok(self.rows.lock().unwrap().get(&(tree, key.to_vec())).cloned())
    }

    fn scan(&self, tree: Tree, prefix: &[u8]) -> Result<Vec<Row>, StoreError> {
        let rows = self.rows.lock().unwrap();
        Ok(Self::collect(rows.iter().filter(|((t, key), _)| *t == tree && key.starts_with(prefix))))
    }

    fn page(&self, tree: Tree, before: Option<&[u8]>, limit: usize) -> Result<Vec<Row>, StoreError> {
        let rows = self.rows.lock().unwrap();
        let below = |key: &[u8]| before.is_none_or(|before| key < before);
        Ok(Self::collect(rows.iter().rev().filter(|((t, key), _)| *t == tree && below(key)).take(limit)))
    }

    fn commit(&self, batch: &Batch) -> Result<(), StoreError> {
        self.stage(batch)?;
        self.flush();
        Ok(())
    }

    fn is_writable(&self) -> bool {
        !self.full.load(Ordering::Relaxed)
    }

    fn settle(&self, _staged: Staged) -> Result<(), StoreError> {
        let meanwhile = self.while_settling.lock().unwrap().take();
        if let Some(meanwhile) = meanwhile {
            (meanwhile.0)();
        }
        if self.full.load(Ordering::Relaxed) {
            return Err(StoreError::DiskFull);
        }
        self.flush();
        Ok(())
    }

    fn stage(&self, batch: &Batch) -> Result<Staged, StoreError> {
        if self.full.load(Ordering::Relaxed) {
            self.refused.fetch_add(1, Ordering::Relaxed);
            return Err(StoreError::DiskFull);
        }
        if self.without_descriptors.load(Ordering::Relaxed) {
            self.refused.fetch_add(1, Ordering::Relaxed);
            let source = std::io::Error::from_raw_os_error(rustix::io::Errno::MFILE.raw_os_error());
            return Err(StoreError::of_io("db", source));
        }
        let mut rows = self.rows.lock().unwrap();
        for (tree, key, value) in &batch.changes {
            match value {
                Some(value) => rows.insert((*tree, key.clone()), value.clone()),
                None => rows.remove(&(*tree, key.clone())),
            };
        }
        Ok(Staged(0))
    }
}
