//! The best of the stored tables.

use std::{
    collections::HashMap,
    sync::{Mutex, PoisonError},
};

use crate::{
    digest::Digest,
    service::{ServiceError, core::Core, manifest::MANIFEST_VERSION},
};

/// Rows of the catalogue that are read at a time.
const PAGE: usize = 256;

/// Mean errors that were read from manifests: a table's never changes.
#[derive(Debug, Default)]
pub(in crate::service) struct MeanErrors(Mutex<HashMap<Digest, f64>>);

impl Core {
    /// The table whose manifest has the lowest mean distance between nodes, `report.between.sw1.mean`; where no table
    /// has a manifest of this version, the newest. Of equals the newest.
    pub(super) fn best_table(&self) -> Result<Option<Digest>, ServiceError> {
        let (mut newest, mut best) = (None, None::<(f64, Digest)>);
        let mut cursor = None;
        loop {
            let (rows, next) = self.catalogue.page(cursor.as_deref(), PAGE)?;
            for table in rows.iter().map(|row| row.digest).filter(|table| self.store.blobs.contains(*table)) {
                newest.get_or_insert(table);
                let Some(error) = self.mean_error(table)? else { continue };
                if best.is_none_or(|(least, _)| error < least) {
                    best = Some((error, table));
                }
            }
            if next.is_none() {
                return Ok(best.map(|(_, table)| table).or(newest));
            }
            cursor = next;
        }
    }

    fn mean_error(&self, table: Digest) -> Result<Option<f64>, ServiceError> {
        let read = |known: &MeanErrors| known.0.lock().unwrap_or_else(PoisonError::into_inner).get(&table).copied();
        if let Some(error) = read(&self.mean_errors) {
            return Ok(Some(error));
        }
        let Some(row) = self.catalogue.manifest(table)?.filter(|row| row.version == MANIFEST_VERSION) else {
            return Ok(None);
        };
        let manifest: serde_json::Value = serde_json::from_str(&row.text).unwrap_or_default();
        let error = manifest["report"]["between"]["sw1"]["mean"].as_f64();
        if let Some(error) = error {
            self.mean_errors.0.lock().unwrap_or_else(PoisonError::into_inner).insert(table, error);
        }
        Ok(error)
    }
}
