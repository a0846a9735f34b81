//! Removing tables: the rows first, with a note that the table was removed, then the file.
//!
//! Invariant: a table with a pin is not removed. A process that ends between the two steps leaves a file that the note
//! names; the next look removes it.

use std::sync::PoisonError;

use super::{
    RemovalReason, RemovedTable, Service, ServiceError, TablePin,
    pins::{pins_of, unpinned},
    tables::Tables,
    uses::UseRow,
};
use crate::store::{Condition, StoreError, Tree};
use jiff::Timestamp;
use ltcforge_files::digest::Digest;

/// Why a table was not deleted.
#[derive(Debug, thiserror::Error)]
pub enum DeleteTableError {
    /// It is not stored.
    #[error("no table with the digest {0} is stored")]
    Unknown(Digest),
    /// It is pinned.
    #[error("the table {table} is pinned: {}; take the pins off first", .pins.iter().map(|pin| pin.name.to_string()).collect::<Vec<_>>().join(", "))]
    Pinned {
        /// The table.
        table: Digest,
        /// Its pins.
        pins: Vec<TablePin>,
    },
    /// The store failed.
    #[error(transparent)]
    Store(#[from] ServiceError),
}

impl From<StoreError> for DeleteTableError {
    fn from(error: StoreError) -> Self {
        Self::Store(error.into())
    }
}

impl Tables {
    /// Removes a table unless it is pinned; tells whether it did. Nobody in this process pins, submits or stores meanwhile.
    pub(super) fn remove_table(&self, table: Digest, why: RemovalReason, at: Timestamp) -> Result<bool, StoreError> {
        let Some(row) = self.catalogue.table(table)? else { return Ok(false) };
        let recipe = self.catalogue.recipe(row.recipe_digest)?.map(|(recipe, _)| recipe).unwrap_or_default();
        let used_at = self.use_of(table)?.map_or(row.created_at, |row| row.used_at);
        let mut note = UseRow { used_at, removed: Some(RemovedTable { at, why, recipe, has_file: true }) };
        let mut batch = self.catalogue.removal(&row)?;
        note.put(&mut batch, table)?;
        let is_there = Condition::There(Tree::Tables, table.as_bytes().to_vec());
        if !self.store.rows.commit_if(&[is_there, unpinned(table)], &batch)? {
            return Ok(false);
        }
        self.remove_file(table, &mut note)?;
        Ok(true)
    }

    /// The second step: the file of a table that was removed, unless it was fitted again meanwhile.
    pub(super) fn remove_file(&self, table: Digest, note: &mut UseRow) -> Result<(), StoreError> {
        let is_known = |digest| Ok(self.catalogue.table(digest)?.is_some());
        self.store.blobs.delete_unless(table, &is_known)?;
        let is_noted = |row: &UseRow| row.removed.is_some();
        if let (Some(removed), true) = (&mut note.removed, self.use_of(table)?.as_ref().is_some_and(is_noted)) {
            removed.has_file = false;
            let mut batch = crate::store::Batch::default();
            note.put(&mut batch, table)?;
            // After a power cut it is looked for once more.
            self.store.rows.stage(&batch)?;
        }
        Ok(())
    }
}

impl Service {
    /// Deletes a table that nobody has pinned. Its recipe is fitted again when it is submitted.
    ///
    /// # Errors
    /// See [`DeleteTableError`]; then nothing has changed.
    pub fn delete_table(&self, table: Digest, by: Option<&str>) -> Result<(), DeleteTableError> {
        let tables = &self.state.tables;
        let (why, at) = (RemovalReason::Deleted(by.map(str::to_owned)), self.state.queue.now());
        let alone = self.state.naming.write().unwrap_or_else(PoisonError::into_inner);
        if tables.remove_table(table, why, at)? {
            self.state.exports.forget(table);
            tracing::info!(%table, by, "the table was deleted");
            return Ok(());
        }
        drop(alone);
        if tables.catalogue.table(table)?.is_none() {
            return Err(DeleteTableError::Unknown(table));
        }
        Err(DeleteTableError::Pinned { table, pins: pins_of(tables.store.rows.as_ref(), table)? })
    }

    /// When and why a table was removed; `None` if that is not known, or it is stored.
    ///
    /// # Errors
    /// When the store fails.
    pub fn removed_table(&self, table: Digest) -> Result<Option<RemovedTable>, ServiceError> {
        Ok(self.state.tables.use_of(table)?.and_then(|row| row.removed))
    }
}
