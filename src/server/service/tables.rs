//! Reads tables: files, lists, manifests, recipes and exports. Also deletes tables.

use std::sync::{Arc, PoisonError};

use bytes::Bytes;
use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;

use super::{
    DeleteError, ExportFailure, FileKind, MadeExport, Service, ServiceError, TableCursor, TableRow,
    catalogue::Catalogue, exports::key,
};
use crate::queue::JobId;
use ltcforge_files::{digest::Digest, hex::to_hex, manifest::MANIFEST_VERSION};
use ltcforge_textures::Export;

/// A page of a list.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Page<T> {
    /// The items, newest first.
    pub items: Vec<T>,
    /// The `cursor` of the next page; `None` on the last page.
    pub next: Option<String>,
}

/// A table in the list of tables.
#[derive(Debug, Clone, Serialize)]
pub struct ListedTable {
    /// Digests, size and age.
    #[serde(flatten)]
    pub(super) row: TableRow,
    /// Its canonical recipe. `None` if its row is missing.
    recipe: Option<Box<RawValue>>,
    /// The mean errors between nodes. `None` until the manifest is made.
    errors: Option<Between>,
}

/// Mean errors between nodes, as in a manifest.
#[derive(Debug, Clone, Copy, Serialize)]
struct Between {
    /// Relative to the width of the lobe.
    width: f64,
    /// Of the light of square lights, relative to the energy of the lobe.
    light: f64,
}

impl Between {
    fn of_manifest(text: &str) -> Option<Self> {
        #[derive(Deserialize)]
        struct Manifest {
            report: Report,
        }
        #[derive(Deserialize)]
        struct Report {
            between: Means,
        }
        #[derive(Deserialize)]
        struct Means {
            width: Mean,
            light: Mean,
        }
        #[derive(Deserialize)]
        struct Mean {
            mean: f64,
        }
        let Means { width, light } = serde_json::from_str::<Manifest>(text).ok()?.report.between;
        Some(Self { width: width.mean, light: light.mean })
    }
}

impl Service {
    /// The verified bytes of a file, if they are in memory. Does not block.
    #[must_use]
    pub fn cached_file(&self, kind: FileKind, digest: Digest) -> Option<Bytes> {
        self.state.files.cached(kind, digest)
    }

    /// The bytes of a file, verified against its digest.
    ///
    /// # Errors
    /// When the file is damaged or unreadable. A damaged file is moved to quarantine. Submitting the recipe fits the
    /// table again.
    pub fn file(&self, kind: FileKind, digest: Digest) -> Result<Option<Bytes>, ServiceError> {
        self.state.files.read(kind, digest)
    }

    /// The manifest of a table (see [`ltcforge_files::manifest::manifest_json`]) as JSON. It is stored with the table.
    /// If it is missing or has another version, this call makes it.
    ///
    /// # Errors
    /// See [`Self::file`]. The manifest of a damaged table is not returned.
    pub fn manifest(&self, digest: Digest) -> Result<Option<String>, ServiceError> {
        let state = &self.state;
        let Some(file) = self.file(FileKind::Table, digest)? else { return Ok(None) };
        if let Some(text) = state.files.catalogue.manifest(digest, MANIFEST_VERSION)? {
            return Ok(Some(text));
        }
        let made = state.pool.install(|| state.fitter.manifest(&file, &|| !state.is_stopping()));
        let made = made.map_err(|error| ServiceError::Storage(format!("the blob {digest}: {error}")))?;
        let text = made.ok_or(ServiceError::Stopping)?;
        let row = Catalogue::manifest_entry(digest, MANIFEST_VERSION, &text)?;
        if let Err(error) = state.files.catalogue.rows.commit(&row) {
            tracing::warn!(table = %digest, %error, "could not store the manifest");
        }
        Ok(Some(text))
    }

    /// Tables, newest first.
    ///
    /// # Errors
    /// When the store fails.
    pub fn tables(&self, cursor: Option<&TableCursor>, limit: usize) -> Result<Page<ListedTable>, ServiceError> {
        let cursor = cursor.map(|cursor| cursor.0.as_slice());
        let catalogue = &self.state.files.catalogue;
        let (rows, next) = catalogue.page(cursor, limit)?;
        let mut items = Vec::with_capacity(rows.len());
        for row in rows {
            let recipe = catalogue.recipe(row.recipe_digest)?.and_then(|(text, _)| RawValue::from_string(text).ok());
            let manifest = catalogue.manifest(row.digest, MANIFEST_VERSION)?;
            items.push(ListedTable { row, recipe, errors: manifest.as_deref().and_then(Between::of_manifest) });
        }
        Ok(Page { items, next: next.map(|key| to_hex(&key)) })
    }

    /// Deletes a table. Submitting its recipe fits it again.
    ///
    /// # Errors
    /// See [`DeleteError`].
    pub fn delete_table(&self, table: Digest, by: Option<&str>) -> Result<(), DeleteError> {
        let state = &self.state;
        let _alone = state.naming.write().unwrap_or_else(PoisonError::into_inner);
        if state.files.read(FileKind::Table, table)?.is_none() {
            return Err(DeleteError::UnknownTable(table));
        }
        state.files.delete(table)?;
        state.exports.forget(table);
        tracing::info!(%table, by, "the table was deleted");
        Ok(())
    }

    /// The canonical JSON of a known recipe, and its table if it is stored.
    ///
    /// # Errors
    /// When the store fails.
    pub fn recipe(&self, digest: Digest) -> Result<Option<(String, Option<Digest>)>, ServiceError> {
        if let Some((recipe, table)) = self.state.files.catalogue.recipe(digest)? {
            let is_stored = self.state.files.contains(table)?;
            return Ok(Some((recipe, is_stored.then_some(table))));
        }
        let job = self.state.queue.job(JobId::of_recipe(&digest))?;
        Ok(job.filter(|job| job.recipe_digest == digest).map(|job| (job.recipe, None)))
    }

    /// The exports that the layout of a table allows. An engine may still refuse the size of the table.
    ///
    /// # Errors
    /// See [`Self::file`].
    pub fn exports(&self, table: Digest) -> Result<Option<Vec<Export>>, ExportFailure> {
        let file = self.file(FileKind::Table, table)?;
        file.map(|file| self.state.fitter.exports(table, &file)).transpose()
    }

    /// An export of a table. The first request makes it. It is kept in memory while there is room.
    ///
    /// # Errors
    /// See [`ExportFailure`].
    pub fn export(&self, table: Digest, export: Export) -> Result<Option<Arc<MadeExport>>, ExportFailure> {
        self.state.exports.get(key(table, export), || {
            if self.state.is_stopping() {
                return Err(ServiceError::Stopping.into());
            }
            let Some(file) = self.file(FileKind::Table, table)? else { return Ok(None) };
            let Some(manifest) = self.manifest(table)? else { return Ok(None) };
            let made = self.state.pool.install(|| self.state.fitter.export(table, &file, &manifest, export));
            Ok(Some(made?.into()))
        })
    }
}
