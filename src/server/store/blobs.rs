//! Blobs. The name of a blob is the digest of its bytes.

use std::fmt::Debug;

use jiff::Timestamp;

use super::StoreError;
use ltcforge_files::digest::Digest;

/// The metadata of a blob.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BlobInfo {
    /// The digest, which is the name of the blob.
    pub digest: Digest,
    /// The time when the blob was stored.
    pub stored_at: Timestamp,
    /// The time when the blob was last used. In a bucket, the time when it was stored.
    pub used_at: Timestamp,
    /// The size of the blob.
    pub bytes: u64,
}

/// A content-addressed store. All methods block. A blob survives power cuts once [`Blobs::put`] has returned.
pub trait Blobs: Send + Sync + Debug {
    /// Stores `bytes` durably and returns their digest. Storing equal bytes again keeps the blob.
    ///
    /// # Errors
    /// [`StoreError::DiskFull`], or the storage's error. Then nothing is stored.
    fn put(&self, bytes: &[u8]) -> Result<Digest, StoreError>;

    /// The bytes of a blob, verified against its digest. `None` if the blob is missing.
    ///
    /// # Errors
    /// [`StoreError::Corrupt`] if the bytes of a file have another digest. The file is then moved to quarantine, so the
    /// blob is missing. In a bucket, the error is [`StoreError::OtherBytes`].
    fn get(&self, digest: Digest) -> Result<Option<Vec<u8>>, StoreError>;

    /// The times and the size of a blob. This does not read its bytes.
    ///
    /// # Errors
    /// The storage's error.
    fn stat(&self, digest: Digest) -> Result<Option<BlobInfo>, StoreError>;

    /// Records that the blob is used now, at most once a minute. Does nothing for a bucket or a missing blob.
    ///
    /// # Errors
    /// The storage's error.
    fn touch(&self, digest: Digest) -> Result<(), StoreError>;

    /// Deletes a blob durably, even on a full disk. A missing blob is not an error.
    ///
    /// # Errors
    /// The storage's error.
    fn delete(&self, digest: Digest) -> Result<(), StoreError>;

    /// All blobs, sorted by digest.
    ///
    /// # Errors
    /// The storage's error.
    fn list(&self) -> Result<Vec<BlobInfo>, StoreError>;
}
