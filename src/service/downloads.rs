//! Tables, manifests and recipes as their users fetch them.

use std::sync::{Arc, atomic::Ordering};

use super::{Page, Service, ServiceError, TableRow};
use crate::{digest::Digest, queue::JobId, store::StoreError};

impl Service {
    /// The canonical file of a table, checked against its digest.
    ///
    /// # Errors
    /// When the blob is damaged or unreadable. A damaged one is struck out of the catalogue: the next equal job fits
    /// it again.
    pub fn table(&self, digest: Digest) -> Result<Option<Arc<Vec<u8>>>, ServiceError> {
        match self.core.store.blobs.get(digest) {
            Ok(bytes) => Ok(bytes.map(Arc::new)),
            Err(error) => {
                if matches!(error, StoreError::Corrupt { .. }) {
                    self.core.blobs_corrupt.fetch_add(1, Ordering::Relaxed);
                    self.core.catalogue.forget(digest)?;
                }
                Err(error.into())
            }
        }
    }

    /// The manifest of a table (see [`super::manifest_json`]) as JSON bytes.
    ///
    /// # Errors
    /// When the blob is damaged or unreadable.
    pub fn manifest(&self, digest: Digest) -> Result<Option<Vec<u8>>, ServiceError> {
        let Some(file) = self.table(digest)? else { return Ok(None) };
        match self.core.engine.manifest(&file) {
            Ok(manifest) => Ok(Some(manifest)),
            Err(error) => Err(ServiceError::Storage(format!("the blob {digest}: {error}"))),
        }
    }

    /// Tables, newest first.
    ///
    /// # Errors
    /// When the store fails.
    pub fn tables(&self, cursor: Option<&str>, limit: usize) -> Result<Page<TableRow>, ServiceError> {
        let cursor = cursor.and_then(from_hex);
        let (items, next) = self.core.catalogue.page(cursor.as_deref(), limit)?;
        Ok(Page { items, next: next.map(|key| to_hex(&key)) })
    }

    /// A known recipe's canonical JSON and its table, if it has been fitted.
    ///
    /// # Errors
    /// When the store fails.
    pub fn recipe(&self, digest: Digest) -> Result<Option<(String, Option<Digest>)>, ServiceError> {
        if let Some((recipe, table)) = self.core.catalogue.recipe(digest)? {
            let table = Some(table).filter(|table| self.core.store.blobs.contains(*table));
            return Ok(Some((recipe, table)));
        }
        let job = self.core.queue.job(JobId::of_recipe(&digest))?;
        Ok(job.filter(|job| job.recipe_digest == digest).map(|job| (job.recipe, None)))
    }
}

fn to_hex(bytes: &[u8]) -> String {
    use std::fmt::Write as _;
    bytes.iter().fold(String::with_capacity(2 * bytes.len()), |mut hex, byte| {
        // Writing to a String cannot fail.
        let _ = write!(hex, "{byte:02x}");
        hex
    })
}

fn from_hex(text: &str) -> Option<Vec<u8>> {
    let digits = text.as_bytes().chunks(2);
    digits.map(|pair| u8::from_str_radix(std::str::from_utf8(pair).ok()?, 16).ok()).collect()
}
