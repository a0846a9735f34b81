//! Files for download: tables, manifests, recipes, exports and pictures.

use std::{sync::Arc, time::Duration};

use bytes::Bytes;

use super::{
    Checked, ExportFailure, FileKind, MadeExport, Page, PictureError, PictureReply, Service, ServiceError, Subject,
    TableCursor, TableRow, exports::key, reconcile::unless_full, state::ServiceState,
};
use crate::{
    queue::JobId,
    store::{Catalogue, ManifestRow},
};
use ltcforge_files::{container::TableFileError, digest::Digest, manifest::MANIFEST_VERSION};
use ltcforge_fit::GoOn;
use ltcforge_textures::Export;

/// How long a URL of a table is valid.
const LINK: Duration = Duration::from_secs(300);

impl Service {
    /// A stored file whose bytes have its digest, if it is in memory. It does not block.
    #[must_use]
    pub fn cached_file(&self, kind: FileKind, digest: Digest) -> Option<Bytes> {
        match self.known(kind, digest)? {
            Checked::Bytes(bytes) => Some(Bytes::from((*bytes).clone())),
            Checked::Long(_) => None,
        }
    }

    /// A stored file whose bytes have its digest; `None` if it is missing or of another kind.
    ///
    /// # Errors
    /// As [`Self::table`].
    pub fn file(&self, kind: FileKind, digest: Digest) -> Result<Option<Bytes>, ServiceError> {
        let bytes = match self.checked(kind, digest)? {
            None => return Ok(None),
            Some(Checked::Bytes(bytes)) => Some((*bytes).clone()),
            Some(Checked::Long(_)) => self.state.tables.told(digest, self.state.tables.store.blobs.get(digest))?,
        };
        Ok(bytes.map(Bytes::from))
    }

    /// The canonical file of a table, checked against its digest.
    ///
    /// # Errors
    /// When the blob is damaged or unreadable. A damaged one is moved to quarantine and removed from the catalogue, so
    /// that the next equal job fits the table again.
    pub fn table(&self, digest: Digest) -> Result<Option<Arc<Vec<u8>>>, ServiceError> {
        self.state.tables.read(digest)
    }

    /// A file checked against its digest, now or before it last changed, of which a long one is read and not kept.
    ///
    /// # Errors
    /// As [`Self::table`].
    pub fn checked(&self, kind: FileKind, digest: Digest) -> Result<Option<Checked>, ServiceError> {
        self.state.tables.checked(kind, digest)
    }

    /// As [`Self::checked`], but only what is known without reading a byte of the file; `None` otherwise. Alone of all
    /// methods it does not block: it takes one look at the file's metadata, some microseconds.
    #[must_use]
    pub fn known(&self, kind: FileKind, digest: Digest) -> Option<Checked> {
        self.state.tables.known(kind, digest)
    }

    /// A file of which less than all is asked for: checked as by [`Self::checked`] in a data folder, and by its length alone
    /// in a store elsewhere.
    ///
    /// # Errors
    /// As [`Self::table`].
    pub fn glance(&self, kind: FileKind, digest: Digest) -> Result<Option<Checked>, ServiceError> {
        self.state.tables.glance(kind, digest)
    }

    /// At most `length` bytes of a stored file, from the byte `from` on, not checked against its digest.
    ///
    /// # Errors
    /// When the store fails.
    pub fn part(&self, digest: Digest, from: u64, length: usize) -> Result<Option<Vec<u8>>, ServiceError> {
        Ok(self.state.tables.store.blobs.part(digest, from, length)?)
    }

    /// The manifest of a table (see [`ltcforge_files::manifest::manifest_json`]) as JSON. It is made with the table. If
    /// it is of another version, or was lost with the catalogue, it is made and stored now.
    ///
    /// # Errors
    /// As [`Self::table`]: the manifest of a damaged table is not served.
    pub fn manifest(&self, digest: Digest) -> Result<Option<String>, ServiceError> {
        let state = &self.state;
        // The blob is checked as for the table itself: a damaged table has no manifest.
        if let Some(text) = state.tables.stored_manifest(digest)? {
            return Ok(self.checked(FileKind::Table, digest)?.map(|_| text));
        }
        let Some(file) = self.table(digest)? else { return Ok(None) };
        let made = state.make_manifest(&file, &|| !state.is_stopping());
        let made = made.map_err(|error| ServiceError::Storage(format!("the blob {digest}: {error}")))?;
        let manifest = made.ok_or(ServiceError::Stopping)?;
        unless_full(state.tables.store.rows.commit(&Catalogue::manifest_entry(digest, &manifest)?))?;
        Ok(Some(manifest.text))
    }

    /// A URL under which a client can fetch a table from the store of blobs for some minutes; `None` if the store makes
    /// no URLs or there is no such table.
    ///
    /// # Errors
    /// When the store fails.
    pub fn table_link(&self, digest: Digest) -> Result<Option<String>, ServiceError> {
        if self.state.tables.catalogue.table(digest)?.is_none() || !self.state.tables.contains(digest)? {
            return Ok(None);
        }
        self.state.tables.uses.note(digest);
        Ok(self.state.tables.store.blobs.link(digest, LINK)?)
    }

    /// Tables, newest first.
    ///
    /// # Errors
    /// When the store fails.
    pub fn tables(&self, cursor: Option<&TableCursor>, limit: usize) -> Result<Page<TableRow>, ServiceError> {
        let (items, next) = self.state.tables.catalogue.page(cursor.map(|cursor| cursor.0.as_slice()), limit)?;
        Ok(Page { items, next: next.map(|key| TableCursor(key).to_string()) })
    }

    /// A known recipe's canonical JSON and its table, if it has been fitted.
    ///
    /// # Errors
    /// When the store fails.
    pub fn recipe(&self, digest: Digest) -> Result<Option<(String, Option<Digest>)>, ServiceError> {
        if let Some((recipe, table)) = self.state.tables.catalogue.recipe(digest)? {
            let is_stored = self.state.tables.contains(table)?;
            return Ok(Some((recipe, Some(table).filter(|_| is_stored))));
        }
        let job = self.state.queue.job(JobId::of_recipe(&digest))?;
        Ok(job.filter(|job| job.recipe_digest == digest).map(|job| (job.recipe, None)))
    }

    /// The exports of a table that its layout allows; an engine may still want another size.
    ///
    /// # Errors
    /// As [`Self::table`].
    pub fn exports(&self, table: Digest) -> Result<Option<Vec<Export>>, ExportFailure> {
        self.table(table)?.map(|file| self.state.backend.exports(&file)).transpose()
    }

    /// An export of a table, made at the first request and then kept, unless others push it out. Its files follow from
    /// the table, the export and this program. The table's error comes from its manifest, so that no export measures
    /// it.
    ///
    /// # Errors
    /// See [`ExportFailure`].
    pub fn export(&self, table: Digest, export: Export) -> Result<Option<Arc<MadeExport>>, ExportFailure> {
        let made = self.state.exports.get(key(table, export), || {
            if self.state.is_stopping() {
                return Err(ServiceError::Stopping.into());
            }
            let Some(file) = self.table(table)? else { return Ok(None) };
            let Some(manifest) = self.manifest(table)? else { return Ok(None) };
            let made = self.state.measuring_pool.install(|| self.state.backend.export(&file, &manifest, export));
            Ok(Some(made?.into()))
        })?;
        if made.is_some() {
            self.state.tables.uses.note(table);
        }
        Ok(made)
    }

    /// The picture of `subject` with a table; where it needs one and none is named, with the best stored one.
    /// `is_known` tells whether the caller has the picture of a tag.
    ///
    /// # Errors
    /// See [`PictureError`].
    pub fn picture(
        &self,
        table: Option<Digest>,
        subject: Subject,
        is_known: impl Fn(Digest) -> bool,
    ) -> Result<PictureReply, PictureError> {
        self.state.pictures.get(table, subject, is_known)
    }
}

impl ServiceState {
    /// Measures a table and makes its manifest; `None` as soon as `go_on` says no.
    pub(super) fn make_manifest(&self, file: &[u8], go_on: &GoOn) -> Result<Option<ManifestRow>, TableFileError> {
        let text = self.measuring_pool.install(|| self.backend.manifest(file, go_on))?;
        Ok(text.map(|text| ManifestRow { version: MANIFEST_VERSION, text }))
    }
}
