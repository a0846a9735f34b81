//! Blobs, named by the digest of their bytes.

use std::fmt::Debug;

use jiff::Timestamp;

use super::StoreError;
use ltcforge_files::digest::Digest;

/// One blob in a list.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BlobInfo {
    /// Its name.
    pub digest: Digest,
    /// When it was stored.
    pub stored_at: Timestamp,
    /// When it was last used. In a bucket, the time at which it was stored.
    pub used_at: Timestamp,
    /// Its size.
    pub bytes: u64,
}

/// A content-addressed store. All methods block. A blob that [`Blobs::put`] returned survives a power cut.
pub trait Blobs: Send + Sync + Debug {
    /// Stores `bytes` durably and returns their digest. Storing equal bytes again changes nothing.
    ///
    /// # Errors
    /// [`StoreError::DiskFull`], or the storage's error. Nothing is stored then.
    fn put(&self, bytes: &[u8]) -> Result<Digest, StoreError>;

    /// The bytes of `digest`, checked against it; `None` if there is no such blob.
    ///
    /// # Errors
    /// [`StoreError::Corrupt`] if the bytes of a file have another digest. The file is moved to quarantine, and the blob
    /// is missing from then on. In a bucket, [`StoreError::OtherBytes`].
    fn get(&self, digest: Digest) -> Result<Option<Vec<u8>>, StoreError>;

    /// Times and size of a blob. Its bytes are not read.
    ///
    /// # Errors
    /// The storage's error.
    fn stat(&self, digest: Digest) -> Result<Option<BlobInfo>, StoreError>;

    /// Records that the blob is used now, at most once a minute. Nothing happens in a bucket, or without such a blob.
    ///
    /// # Errors
    /// The storage's error.
    fn touch(&self, digest: Digest) -> Result<(), StoreError>;

    /// Deletes a blob durably, also on a full disk. A missing one is no error.
    ///
    /// # Errors
    /// The storage's error.
    fn delete(&self, digest: Digest) -> Result<(), StoreError>;

    /// All blobs, by digest.
    ///
    /// # Errors
    /// The storage's error.
    fn list(&self) -> Result<Vec<BlobInfo>, StoreError>;
}
