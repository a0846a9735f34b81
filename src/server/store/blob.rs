//! Blobs, named by the digest of their bytes.

use std::{sync::Arc, time::Duration};

use jiff::Timestamp;

use super::StoreError;
use ltcforge_files::digest::Digest;

/// One blob in a list.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BlobInfo {
    /// Its name.
    pub digest: Digest,
    /// When it was stored.
    pub stored_at: Timestamp,
    /// Its size.
    pub bytes: u64,
}

/// A blob whose bytes have its digest.
#[derive(Debug, Clone)]
pub enum Checked {
    /// At most [`SHORT_BYTES`], or more where the storage cannot read parts of it.
    Bytes(Arc<Vec<u8>>),
    /// The length of a longer one, to be read in parts.
    Long(u64),
}

/// Bytes of a blob that may be in memory for each client.
pub const SHORT_BYTES: u64 = 1 << 20;

/// A content-addressed store. What [`Blobs::put`] returned survives a power cut.
pub trait Blobs: Send + Sync + std::fmt::Debug {
    /// Stores `bytes` durably and returns their digest. Storing equal bytes again changes nothing.
    ///
    /// # Errors
    /// [`StoreError::DiskFull`], or the storage's error. Nothing is stored then.
    fn put(&self, bytes: &[u8]) -> Result<Digest, StoreError>;

    /// The bytes of `digest`, checked against it.
    ///
    /// # Errors
    /// [`StoreError::Corrupt`] when they do not match. The blob is moved to quarantine and is absent from then on.
    fn get(&self, digest: Digest) -> Result<Option<Vec<u8>>, StoreError>;

    /// The length of a blob. It is not checked against its digest.
    ///
    /// # Errors
    /// When the storage does not tell.
    fn length(&self, digest: Digest) -> Result<Option<u64>, StoreError> {
        Ok(self.get(digest)?.map(|bytes| bytes.len() as u64))
    }

    /// At most `length` bytes of a blob, from the byte `from` on. It is not checked against its digest.
    ///
    /// # Errors
    /// When the storage fails.
    fn part(&self, digest: Digest, from: u64, length: usize) -> Result<Option<Vec<u8>>, StoreError> {
        let part = |bytes: Vec<u8>| bytes.into_iter().skip(from as usize).take(length).collect();
        Ok(self.get(digest)?.map(part))
    }

    /// A blob checked against its digest, as by [`Self::get`], now or before: where the storage tells that a file has not
    /// changed since, it is not hashed again. A long one may be read without being kept.
    ///
    /// # Errors
    /// As [`Self::get`].
    fn checked(&self, digest: Digest) -> Result<Option<Checked>, StoreError> {
        Ok(self.get(digest)?.map(|bytes| Checked::Bytes(Arc::new(bytes))))
    }

    /// As [`Self::checked`], but only what is known without reading a byte of the blob; `None` otherwise. It takes
    /// microseconds.
    fn known(&self, digest: Digest) -> Option<Checked> {
        let _ = digest;
        None
    }

    /// Whether [`Self::checked`] hashes a blob once rather than each time.
    fn remembers(&self) -> bool {
        false
    }

    /// Reads a blob from the disk and checks it against its digest, whatever is remembered of it. `go_on` is told the bytes
    /// of each part that was read; when it says no, nothing was checked.
    ///
    /// # Errors
    /// As [`Self::get`].
    fn recheck(&self, digest: Digest, go_on: &mut dyn FnMut(usize) -> bool) -> Result<(), StoreError> {
        let _ = (digest, go_on);
        Ok(())
    }

    /// Whether there is a blob of that name; its bytes are not read.
    ///
    /// # Errors
    /// When the storage does not tell.
    fn contains(&self, digest: Digest) -> Result<bool, StoreError>;

    /// Stores a blob that is about to become known, or has, if it was removed meanwhile: another process may have taken it for
    /// an orphan.
    ///
    /// # Errors
    /// As [`Self::put`].
    fn keep(&self, digest: Digest, bytes: &[u8]) -> Result<(), StoreError> {
        if !self.contains(digest)? {
            self.put(bytes)?;
        }
        Ok(())
    }

    /// Removes a blob, durably when this returns; a missing one is no error.
    ///
    /// # Errors
    /// When the storage fails.
    fn delete(&self, digest: Digest) -> Result<(), StoreError>;

    /// As [`Self::delete`], unless the blob is known. Where processes share the storage, one that becomes known meanwhile is put
    /// back: who makes a blob known calls [`Self::keep`] afterwards, so that it stays whichever comes first.
    ///
    /// # Errors
    /// When the storage, or `is_known`, fails.
    fn delete_unless(
        &self,
        digest: Digest,
        is_known: &dyn Fn(Digest) -> Result<bool, StoreError>,
    ) -> Result<(), StoreError> {
        if is_known(digest)? { Ok(()) } else { self.delete(digest) }
    }

    /// Drops this process's own copy of a blob that another process has removed.
    fn drop_copy(&self, digest: Digest) {
        let _ = digest;
    }

    /// All blobs that are regular files, by digest.
    ///
    /// # Errors
    /// When the storage cannot be listed.
    fn list(&self) -> Result<Vec<BlobInfo>, StoreError>;

    /// Whether the storage answers.
    fn is_reachable(&self) -> bool {
        true
    }

    /// A URL of the blob for a client, valid for so long; `None` if the storage has none.
    ///
    /// # Errors
    /// When it cannot be made.
    fn link(&self, digest: Digest, valid: Duration) -> Result<Option<String>, StoreError> {
        let _ = (digest, valid);
        Ok(None)
    }
}
