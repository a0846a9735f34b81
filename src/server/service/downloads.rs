//! Tables, manifests and recipes as their users fetch them.

use std::{
    panic::resume_unwind,
    sync::{Arc, atomic::Ordering},
    thread,
};

use super::{Page, Service, ServiceError, TableRow, core::Core, manifest::MANIFEST_VERSION};
use crate::{
    files::{digest::Digest, export::TableFileError},
    server::{
        queue::JobId,
        store::{Catalogue, ManifestRow, StoreError},
    },
};

impl Service {
    /// The canonical file of a table, checked against its digest.
    ///
    /// # Errors
    /// When the blob is damaged or unreadable. A damaged one is struck out of the catalogue: the next equal job fits
    /// it again.
    pub fn table(&self, digest: Digest) -> Result<Option<Arc<Vec<u8>>>, ServiceError> {
        self.core.table(digest)
    }

    /// The manifest of a table (see [`super::manifest_json`]) as JSON. It was made with the table; of one that was
    /// stored by an earlier version, or whose catalogue was lost, it is made now and kept.
    ///
    /// # Errors
    /// When the blob is damaged or unreadable.
    pub fn manifest(&self, digest: Digest) -> Result<Option<String>, ServiceError> {
        let core = &self.core;
        // A manifest is only true of a table that is there: read and hash the blob, as for the table itself.
        let Some(file) = self.table(digest)? else { return Ok(None) };
        if let Some(manifest) = core.catalogue.manifest(digest)?.filter(|row| row.version == MANIFEST_VERSION) {
            return Ok(Some(manifest.text));
        }
        let made = core.make_manifest(&file);
        let manifest = made.map_err(|error| ServiceError::Storage(format!("the blob {digest}: {error}")))?;
        core.store.rows.commit(&Catalogue::manifest_entry(digest, &manifest)?)?;
        Ok(Some(manifest.text))
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

impl Core {
    /// See [`Service::table`].
    pub(super) fn table(&self, digest: Digest) -> Result<Option<Arc<Vec<u8>>>, ServiceError> {
        match self.store.blobs.get(digest) {
            Ok(bytes) => Ok(bytes.map(Arc::new)),
            Err(error) => {
                if matches!(error, StoreError::Corrupt { .. }) {
                    self.blobs_corrupt.fetch_add(1, Ordering::Relaxed);
                    self.catalogue.forget(digest)?;
                }
                Err(error.into())
            }
        }
    }

    /// Measures a table and writes its manifest.
    pub(super) fn make_manifest(&self, file: &[u8]) -> Result<ManifestRow, TableFileError> {
        let measure = || self.measuring.install(|| self.engine.manifest(file));
        // The caller may be a thread of the fitting pool. If it waited for the other pool itself, rayon would have it
        // do other work of its own pool meanwhile: another worker's endless loop. So a thread of no pool waits.
        let made = thread::scope(|scope| scope.spawn(measure).join());
        let text = made.unwrap_or_else(|panic| resume_unwind(panic))?;
        Ok(ManifestRow { version: MANIFEST_VERSION, text })
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
