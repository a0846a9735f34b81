//! Files that users sent, as a list. They are the blobs that are no tables.

use jiff::Timestamp;
use serde::Serialize;

use super::{FileKind, Page, Service, ServiceError, TableCursor};
use crate::store::{BlobInfo, StoreError, age_key};
use ltcforge_files::digest::Digest;

/// A stored file in the list.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct FileRow {
    /// Its digest.
    pub digest: Digest,
    /// Its size.
    pub bytes: u64,
    /// When it was stored.
    pub created_at: Timestamp,
}

impl Service {
    /// Stored files of a kind, newest first.
    ///
    /// # Errors
    /// When the store fails.
    pub(super) fn files(
        &self,
        kind: FileKind,
        cursor: Option<&TableCursor>,
        limit: usize,
    ) -> Result<Page<FileRow>, ServiceError> {
        let mut rows = self.stored_files(kind)?;
        rows.retain(|(key, _)| cursor.is_none_or(|cursor| *key < cursor.0));
        let mut newest = rows.into_iter().rev();
        let page: Vec<_> = newest.by_ref().take(limit).collect();
        let next = newest.next().and_then(|_| Some(TableCursor(page.last()?.0.clone()).to_string()));
        Ok(Page { items: page.into_iter().map(|(_, row)| row).collect(), next })
    }

    /// All stored files of a kind with their places in the list, oldest first.
    pub(super) fn stored_files(&self, kind: FileKind) -> Result<Vec<(Vec<u8>, FileRow)>, StoreError> {
        let tables = &self.state.tables;
        let known = tables.catalogue.keys()?;
        let mut rows = Vec::new();
        for BlobInfo { digest, stored_at, .. } in tables.store.blobs.list()? {
            if known.contains(digest.as_bytes().as_slice()) {
                continue;
            }
            if let Some(bytes) = tables.length(kind, digest)? {
                rows.push((age_key(stored_at, digest), FileRow { digest, bytes, created_at: stored_at }));
            }
        }
        rows.sort_by(|(a, _), (b, _)| a.cmp(b));
        Ok(rows)
    }
}
