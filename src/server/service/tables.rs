//! The stored tables: their files, which are hashed on every read, and the catalogue.

use std::sync::{
    Arc,
    atomic::{AtomicU64, Ordering},
};

use super::ServiceError;
use crate::store::{Catalogue, Store, StoreError};
use ltcforge_files::{digest::Digest, manifest::MANIFEST_VERSION};

/// The store and its catalogue.
#[derive(Debug)]
pub(super) struct Tables {
    pub(super) store: Store,
    pub(super) catalogue: Catalogue,
    /// Blobs found damaged so far.
    damaged: AtomicU64,
}

impl Tables {
    pub(super) fn new(store: Store) -> Self {
        let catalogue = Catalogue::new(Arc::clone(&store.rows));
        Self { store, catalogue, damaged: AtomicU64::new(0) }
    }

    /// Whether there is a file with this digest. Its bytes are not read.
    pub(super) fn contains(&self, digest: Digest) -> Result<bool, StoreError> {
        self.store.blobs.contains(digest)
    }

    /// The canonical file of a table, checked against its digest.
    ///
    /// # Errors
    /// When the blob is damaged or unreadable. A damaged one is moved to quarantine and removed from the catalogue, so
    /// that the next equal job fits the table again.
    pub(super) fn read(&self, digest: Digest) -> Result<Option<Arc<Vec<u8>>>, ServiceError> {
        match self.store.blobs.get(digest) {
            Ok(bytes) => Ok(bytes.map(Arc::new)),
            Err(error) => {
                if matches!(error, StoreError::Corrupt { .. }) {
                    self.damaged.fetch_add(1, Ordering::Relaxed);
                    self.catalogue.forget(digest)?;
                }
                Err(error.into())
            }
        }
    }

    /// The stored manifest of a table, if it is of the current version. Whether the table is intact is not checked.
    pub(super) fn stored_manifest(&self, table: Digest) -> Result<Option<String>, StoreError> {
        let row = self.catalogue.manifest(table)?;
        Ok(row.filter(|row| row.version == MANIFEST_VERSION).map(|row| row.text))
    }

    /// The table of a recipe, if it is in the catalogue and its file is there.
    pub(super) fn of_recipe(&self, recipe_digest: Digest) -> Result<Option<Digest>, StoreError> {
        match self.catalogue.recipe(recipe_digest)? {
            Some((_, table)) if self.contains(table)? => Ok(Some(table)),
            _ => Ok(None),
        }
    }

    /// How many blobs were found damaged so far.
    pub(super) fn damaged(&self) -> u64 {
        self.damaged.load(Ordering::Relaxed)
    }
}
