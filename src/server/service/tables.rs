//! The stored tables: their files, which are hashed when they are first read and once they changed, and the catalogue.

use std::{
    collections::{BTreeSet, HashMap},
    sync::{
        Arc, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicU64, Ordering},
    },
};

use quick_cache::sync::Cache;

use super::{
    ServiceError,
    reconcile::unless_full,
    uses::{UseRow, Uses, use_of},
};
use crate::store::{Catalogue, Checked, Row, Store, StoreError, Tree};
use ltcforge_files::{
    digest::Digest,
    manifest::MANIFEST_VERSION,
    tabulated::{TABULATED_HEADER_LIMIT_BYTES, is_tabulated},
};
use ltcforge_textures::is_light_texture;

/// The kinds of stored files.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FileKind {
    /// A table, or whatever is neither of the others.
    Table,
    /// A tabulated BRDF.
    Brdf,
    /// A prefiltered picture of a light.
    LightTexture,
}

impl FileKind {
    /// The kind of a file that begins so.
    fn of(start: &[u8]) -> Self {
        if is_light_texture(start) {
            Self::LightTexture
        } else if is_tabulated(start) {
            Self::Brdf
        } else {
            Self::Table
        }
    }

    /// Whether a file that begins so is of this kind.
    fn begins(self, start: &[u8]) -> bool {
        Self::of(start) == self
    }
}

/// The bytes at the start of a file that tell its kind.
const START: usize = 8 + TABULATED_HEADER_LIMIT_BYTES as usize;

/// Files whose kinds are remembered.
const KINDS: usize = 1 << 16;

/// The store and its catalogue.
#[derive(Debug)]
pub(super) struct Tables {
    pub(super) store: Store,
    pub(super) catalogue: Catalogue,
    /// The kinds of files that were read. A kind follows from the bytes, and so from the digest.
    kinds: Cache<Digest, FileKind>,
    /// Blobs found damaged or missing so far.
    damaged: AtomicU64,
    /// Tables whose file was missing when it was last asked for.
    missing: Mutex<BTreeSet<Digest>>,
    /// Which files were used since that was last written.
    pub(super) uses: Uses,
}

impl Tables {
    pub(super) fn new(store: Store) -> Self {
        let catalogue = Catalogue::new(Arc::clone(&store.rows));
        Self {
            store,
            catalogue,
            kinds: Cache::new(KINDS),
            damaged: AtomicU64::new(0),
            missing: Mutex::default(),
            uses: Uses::default(),
        }
    }

    /// As [`use_of`].
    pub(super) fn use_of(&self, digest: Digest) -> Result<Option<UseRow>, StoreError> {
        use_of(self.store.rows.as_ref(), digest)
    }

    /// All that is stored about uses.
    pub(super) fn all_uses(&self) -> Result<HashMap<Digest, UseRow>, StoreError> {
        let rows = self.store.rows.scan(Tree::Uses, &[])?.into_iter();
        let read = |row: Row| {
            let digest = Digest::from_bytes(row.key.try_into().ok()?);
            Some((digest, serde_json::from_slice(&row.value?).ok()?))
        };
        Ok(rows.filter_map(read).collect())
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
        let bytes = self.told(digest, self.store.blobs.get(digest))?.filter(|bytes| FileKind::Table.begins(bytes));
        if bytes.is_some() {
            self.uses.note(digest);
        }
        Ok(bytes.map(Arc::new))
    }

    /// As [`Self::read`], of any kind of file, but a long one is not kept in memory, and one that was checked before and has
    /// not changed since is not hashed again.
    pub(super) fn checked(&self, kind: FileKind, digest: Digest) -> Result<Option<Checked>, ServiceError> {
        let checked = self.told(digest, self.store.blobs.checked(digest))?;
        let actual = match &checked {
            Some(Checked::Bytes(bytes)) => Some(FileKind::of(bytes)),
            Some(Checked::Long(_)) => match self.kinds.get(&digest) {
                Some(kind) => Some(kind),
                None => self.store.blobs.part(digest, 0, START)?.map(|start| FileKind::of(&start)),
            },
            None => None,
        };
        if let Some(actual) = actual {
            self.kinds.insert(digest, actual);
            self.uses.note(digest);
        }
        Ok(checked.filter(|_| actual == Some(kind)))
    }

    /// As [`Self::checked`], but only what is known without reading a byte of the file; `None` otherwise.
    pub(super) fn known(&self, kind: FileKind, digest: Digest) -> Option<Checked> {
        self.kinds.get(&digest).filter(|known| *known == kind)?;
        let known = self.store.blobs.known(digest)?;
        self.uses.note(digest);
        Some(known)
    }

    /// What a request for less than the whole file needs of it. A storage that hashes a file once does so now; of another
    /// one only the length is asked.
    pub(super) fn glance(&self, kind: FileKind, digest: Digest) -> Result<Option<Checked>, ServiceError> {
        if self.store.blobs.remembers() {
            return self.checked(kind, digest);
        }
        let length = self.length(kind, digest)?;
        if length.is_some() {
            self.uses.note(digest);
        }
        Ok(length.map(Checked::Long))
    }

    /// What was read of a blob; notes that it is there, missing or damaged.
    pub(super) fn told<T>(
        &self,
        digest: Digest,
        read: Result<Option<T>, StoreError>,
    ) -> Result<Option<T>, ServiceError> {
        match read {
            Ok(Some(read)) => {
                self.missing().remove(&digest);
                Ok(Some(read))
            }
            Ok(None) => {
                self.tell_missing(digest)?;
                Ok(None)
            }
            Err(error) => {
                if matches!(error, StoreError::Corrupt { .. }) {
                    self.damaged.fetch_add(1, Ordering::Relaxed);
                    unless_full(self.catalogue.forget(digest).map(drop))?;
                }
                Err(error.into())
            }
        }
    }

    /// The length of a file, by its storage alone; `None` for a file of another kind.
    ///
    /// # Errors
    /// When the store fails.
    pub(super) fn length(&self, kind: FileKind, digest: Digest) -> Result<Option<u64>, StoreError> {
        let start = self.store.blobs.part(digest, 0, START)?;
        if start.is_none() {
            self.tell_missing(digest)?;
        }
        if start.is_some_and(|start| kind.begins(&start)) { self.store.blobs.length(digest) } else { Ok(None) }
    }

    /// The stored manifest of a table, if it is of the current version. Whether the table is intact is not checked.
    pub(super) fn stored_manifest(&self, table: Digest) -> Result<Option<String>, StoreError> {
        let row = self.catalogue.manifest(table)?;
        Ok(row.filter(|row| row.version == MANIFEST_VERSION).map(|row| row.text))
    }

    /// The table of a recipe, if it is in the catalogue and its file is there.
    pub(super) fn of_recipe(&self, recipe_digest: Digest) -> Result<Option<Digest>, StoreError> {
        match self.catalogue.recipe(recipe_digest)? {
            Some((_, table)) if self.contains(table)? => {
                self.uses.note(table);
                Ok(Some(table))
            }
            Some((_, table)) => self.tell_missing(table).map(|()| None),
            None => Ok(None),
        }
    }

    fn missing(&self) -> MutexGuard<'_, BTreeSet<Digest>> {
        self.missing.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Logs once that a table of the catalogue has no file. It was removed or renamed while the service ran.
    fn tell_missing(&self, digest: Digest) -> Result<(), StoreError> {
        if self.catalogue.table(digest)?.is_some() && self.missing().insert(digest) {
            self.damaged.fetch_add(1, Ordering::Relaxed);
            tracing::error!(table = %digest, "the file of a table is missing; its recipe is fitted again when it is submitted");
        }
        Ok(())
    }

    /// How many blobs were found damaged or missing so far.
    pub(super) fn damaged(&self) -> u64 {
        self.damaged.load(Ordering::Relaxed)
    }
}
