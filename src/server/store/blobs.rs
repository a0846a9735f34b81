//! Blobs, named by the digest of their bytes.

use std::fmt::Debug;

use jiff::Timestamp;

use super::StoreError;
use ltcforge_files::digest::Digest;

/// The metadata of a blob.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BlobInfo {
    /// The digest, which is the name.
    pub digest: Digest,
    /// The time when the blob was stored.
    pub stored_at: Timestamp,
    /// The time of its last use. In a bucket, the time when it was stored.
    pub used_at: Timestamp,
    /// The size.
    pub bytes: u64,
}

/// A content-addressed store. All methods block. A blob survives power cuts once [`Blobs::put`] has returned.
pub trait Blobs: Send + Sync + Debug {
    /// Stores `bytes` durably and returns their digest. Storing equal bytes again changes nothing.
    ///
    /// # Errors
    /// [`StoreError::DiskFull`], or the storage's error. Then nothing is stored.
    fn put(&self, bytes: &[u8]) -> Result<Digest, StoreError>;

    /// The bytes with this digest, verified; `None` if the blob is missing.
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

    /// Records that the blob is used now, at most once a minute. Does nothing in a bucket, or if the blob is missing.
    ///
    /// # Errors
    /// The storage's error.
    fn touch(&self, digest: Digest) -> Result<(), StoreError>;

    /// Deletes a blob durably, also on a full disk. A missing blob is not an error.
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
