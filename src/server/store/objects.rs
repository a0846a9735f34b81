//! [`Blobs`] in an object store.

mod connect;

use std::sync::Arc;

use futures_util::TryStreamExt as _;
use jiff::Timestamp;
use object_store::{Error, ObjectMeta, ObjectStore, ObjectStoreExt as _, PutPayload, WriteMultipart, path::Path};

use super::{BlobInfo, Blobs, ConnectError, StoreError, threads::Threads};
use ltcforge_files::digest::Digest;

/// Maximum bytes of one upload request. Even at 350 kB per second, two concurrent requests end before the timeout.
const PART: usize = 5 << 20;
const PARTS_AT_ONCE: usize = 2;

/// Blobs in an object store, under the names `PREFIX/ab/ab12...`.
#[derive(Debug)]
pub struct ObjectBlobs {
    threads: Threads,
    store: Arc<dyn ObjectStore>,
    prefix: Path,
}

impl ObjectBlobs {
    /// Opens the blobs at `url`, such as `s3://BUCKET/PREFIX`. The bucket must exist. If `writes`, a test object is
    /// written to it.
    ///
    /// # Errors
    /// The reason, as text.
    pub fn open(url: &str, writes: bool) -> Result<Self, ConnectError> {
        let (store, prefix) = connect::connect(url)?;
        let blobs = Self::new(store, prefix)
            .map_err(|error| connect::lacking(url, &format!("no thread can be started: {error}")))?;
        blobs.block_on(connect::probe(&*blobs.store, &blobs.prefix, url, writes))?;
        Ok(blobs)
    }

    fn new(store: Arc<dyn ObjectStore>, prefix: Path) -> std::io::Result<Self> {
        Ok(Self { threads: Threads::start("blobs")?, store, prefix })
    }

    fn block_on<T>(&self, work: impl Future<Output = T>) -> T {
        self.threads.block_on(work)
    }

    fn path(&self, digest: Digest) -> Path {
        let hex = digest.hex();
        self.prefix.clone().join(&hex[..2]).join(hex.as_str())
    }

    async fn upload(&self, path: &Path, bytes: &[u8]) -> Result<(), Error> {
        if bytes.len() <= PART {
            return self.store.put(path, PutPayload::from(bytes.to_vec())).await.map(drop);
        }
        let mut parts = WriteMultipart::new_with_chunk_size(self.store.put_multipart(path).await?, PART);
        for part in bytes.chunks(PART) {
            if let Err(error) = parts.wait_for_capacity(PARTS_AT_ONCE).await {
                // If this also fails, a lifecycle rule of the bucket should remove the parts.
                let _ = parts.abort().await;
                return Err(error);
            }
            parts.write(part);
        }
        parts.finish().await.map(drop)
    }
}

/// The result of a request for an object. `None` if the object is missing.
fn found<T>(answer: Result<T, Error>) -> Result<Option<T>, StoreError> {
    match answer {
        Ok(answer) => Ok(Some(answer)),
        Err(Error::NotFound { .. }) => Ok(None),
        Err(error) => Err(failure(&error)),
    }
}

fn failure(error: &Error) -> StoreError {
    match error {
        Error::PermissionDenied { .. } | Error::Unauthenticated { .. } => StoreError::Refused(connect::text(error)),
        _ => StoreError::Unavailable(connect::text(error)),
    }
}

/// The metadata of an object. `None` if its name is not a digest.
fn info(object: &ObjectMeta) -> Option<BlobInfo> {
    let digest = object.location.filename()?.parse().ok()?;
    let stored_at = Timestamp::from_microsecond(object.last_modified.timestamp_micros()).ok()?;
    Some(BlobInfo { digest, stored_at, used_at: stored_at, bytes: object.size })
}

impl Blobs for ObjectBlobs {
    /// Writes the object even if it exists, which repairs a damaged object.
    fn put(&self, bytes: &[u8]) -> Result<Digest, StoreError> {
        let digest = Digest::of(bytes);
        self.block_on(self.upload(&self.path(digest), bytes)).map_err(|error| failure(&error))?;
        Ok(digest)
    }

    /// Damaged bytes are a temporary error, because a proxy may have damaged them while the object is intact.
    fn get(&self, digest: Digest) -> Result<Option<Vec<u8>>, StoreError> {
        let path = self.path(digest);
        for _ in 0..2 {
            let fetched = self.block_on(async { self.store.get(&path).await?.bytes().await });
            let Some(bytes) = found(fetched)? else { return Ok(None) };
            if Digest::of(&bytes) == digest {
                return Ok(Some(bytes.into()));
            }
        }
        tracing::error!(%digest, "the object store returned damaged bytes twice");
        Err(StoreError::OtherBytes(digest))
    }

    fn stat(&self, digest: Digest) -> Result<Option<BlobInfo>, StoreError> {
        let head = found(self.block_on(self.store.head(&self.path(digest))))?;
        Ok(head.and_then(|object| info(&object)))
    }

    fn touch(&self, _digest: Digest) -> Result<(), StoreError> {
        Ok(())
    }

    fn delete(&self, digest: Digest) -> Result<(), StoreError> {
        found(self.block_on(self.store.delete(&self.path(digest)))).map(drop)
    }

    fn list(&self) -> Result<Vec<BlobInfo>, StoreError> {
        let listed = self.store.list(Some(&self.prefix));
        let blobs = listed.try_filter_map(|object| std::future::ready(Ok(info(&object)))).try_collect::<Vec<_>>();
        let mut blobs = self.block_on(blobs).map_err(|error| failure(&error))?;
        blobs.sort_by_key(|blob| blob.digest);
        Ok(blobs)
    }
}

#[cfg(test)]
mod tests {
    use object_store::memory::InMemory;

    use super::*;

    fn blobs() -> ObjectBlobs {
        ObjectBlobs::new(Arc::new(InMemory::new()), Path::from("tables")).unwrap()
    }

    #[test]
    fn a_blob_can_be_read_listed_and_put_again() {
        let blobs = blobs();
        let digest = blobs.put(b"table").unwrap();
        assert_eq!(blobs.put(b"table").unwrap(), digest);
        assert_eq!(blobs.get(digest).unwrap().unwrap(), b"table");
        let info = blobs.stat(digest).unwrap().unwrap();
        assert_eq!((info.digest, info.bytes), (digest, 5));
        assert_eq!(blobs.list().unwrap(), [info]);
        let other = Digest::of(b"other");
        assert!(blobs.get(other).unwrap().is_none() && blobs.stat(other).unwrap().is_none());
        blobs.touch(digest).unwrap();
        blobs.delete(digest).unwrap();
        blobs.delete(digest).unwrap();
        assert_eq!(blobs.list().unwrap(), []);
    }

    #[test]
    fn a_blob_that_is_uploaded_in_parts_is_whole() {
        let blobs = blobs();
        let bytes: Vec<u8> = (0..=u8::MAX).cycle().take(2 * PART + 1000).collect();
        let digest = blobs.put(&bytes).unwrap();
        assert!(blobs.get(digest).unwrap().is_some_and(|got| got == bytes));
    }

    #[test]
    fn other_bytes_are_never_returned_and_putting_repairs_them() {
        let blobs = blobs();
        let digest = Digest::of(b"table");
        blobs.block_on(blobs.store.put(&blobs.path(digest), PutPayload::from_static(b"tabel"))).unwrap();
        assert!(matches!(blobs.get(digest), Err(StoreError::OtherBytes(_))));
        blobs.put(b"table").unwrap();
        assert_eq!(blobs.get(digest).unwrap().unwrap(), b"table");
    }
}
