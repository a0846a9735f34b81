//! [`Blobs`] in an object store.

use std::{
    collections::HashMap,
    fs,
    path::Path as FilePath,
    sync::{Arc, Mutex, PoisonError},
    time::{Duration, Instant},
};

use futures_util::TryStreamExt as _;
use jiff::Timestamp;
use object_store::{Error, ObjectMeta, ObjectStoreExt as _, PutPayload, WriteMultipart, path::Path};
use tokio::runtime::{Builder, Runtime};

use super::{
    cache::BlobCache,
    connect::{Access, Connected, ObjectsOpenError, connect, probe, text},
};
use crate::store::{
    BlobInfo, Blobs, Checked, SHORT_BYTES, StoreError,
    files::{read_part, regular_length},
};
use ltcforge_files::digest::Digest;

/// Bytes of one upload request, at most. A store that takes 350 kB a second takes two at once before the timeout.
const PART: usize = 5 << 20;
const PARTS_AT_ONCE: usize = 2;

/// The object that has the identity of the database.
pub(in crate::store) const IDENTITY: &str = "ltcforge-identity";

/// How long the store may take to say that it answers.
const PROBE: Duration = Duration::from_secs(5);

/// How long an object that was seen counts as present without another request.
const SEEN_FOR: Duration = Duration::from_secs(60);

/// Objects that are remembered as seen, at most.
const MOST_SEEN: usize = 1 << 16;

/// Blobs in an object store, as `PREFIX/ab/ab12...`.
#[derive(Debug)]
pub struct ObjectBlobs {
    /// `None` once this is being dropped.
    runtime: Option<Runtime>,
    connected: Connected,
    cache: BlobCache,
    /// When an object was last seen.
    seen: Mutex<HashMap<Digest, Instant>>,
}

impl Drop for ObjectBlobs {
    fn drop(&mut self) {
        if let Some(runtime) = self.runtime.take() {
            runtime.shutdown_background();
        }
    }
}

impl ObjectBlobs {
    /// The blobs at `url`, which must exist, with a cache of at most `cache_bytes` in the folder `cache`; of none if it is 0.
    ///
    /// # Errors
    /// See [`ObjectsOpenError`].
    pub fn open(url: &str, access: Access, cache: &FilePath, cache_bytes: u64) -> Result<Self, ObjectsOpenError> {
        let connected = connect(url)?;
        let unusable = |error: std::io::Error| ObjectsOpenError::Refused {
            url: cache.display().to_string(),
            verb: "used as a cache",
            reason: error.to_string(),
        };
        let runtime = Builder::new_multi_thread().worker_threads(1).thread_name("blobs").enable_all().build();
        let runtime = runtime.map_err(unusable)?;
        runtime.block_on(probe(&connected, url, access))?;
        let cache = BlobCache::open(cache, cache_bytes).map_err(unusable)?;
        Ok(Self { runtime: Some(runtime), connected, cache, seen: Mutex::default() })
    }

    fn block_on<T>(&self, work: impl Future<Output = T>) -> T {
        // Only `drop` takes it out.
        self.runtime.as_ref().unwrap_or_else(|| unreachable!("blobs that are being dropped were used")).block_on(work)
    }

    fn path(&self, digest: Digest) -> Path {
        let hex = digest.hex();
        self.connected.prefix.clone().join(&hex[..2]).join(hex.as_str())
    }

    fn see(&self, digest: Digest) {
        let mut seen = self.seen.lock().unwrap_or_else(PoisonError::into_inner);
        if seen.len() >= MOST_SEEN {
            seen.clear();
        }
        seen.insert(digest, Instant::now());
    }

    async fn upload(&self, path: &Path, bytes: &[u8]) -> Result<(), Error> {
        let store = &self.connected.store;
        if bytes.len() <= PART {
            return store.put(path, PutPayload::from(bytes.to_vec())).await.map(drop);
        }
        let mut parts = WriteMultipart::new_with_chunk_size(store.put_multipart(path).await?, PART);
        for part in bytes.chunks(PART) {
            if let Err(error) = parts.wait_for_capacity(PARTS_AT_ONCE).await {
                // If this fails too, a lifecycle rule of the bucket removes the parts.
                let _ = parts.abort().await;
                return Err(error);
            }
            parts.write(part);
        }
        parts.finish().await.map(drop)
    }

    async fn fetch(&self, path: &Path) -> Result<Option<Vec<u8>>, StoreError> {
        // Opening a FIFO would wait, and a device may have no end.
        let file = self.connected.local.as_ref().and_then(|local| local.path_to_filesystem(path).ok());
        let is_other = |kind: fs::FileType| !kind.is_file() && !kind.is_dir();
        if file.is_some_and(|file| file.symlink_metadata().is_ok_and(|metadata| is_other(metadata.file_type()))) {
            return Err(StoreError::Unavailable(format!("{path} is not a regular file")));
        }
        found(async { self.connected.store.get(path).await?.bytes().await }.await.map(|bytes| bytes.to_vec()))
    }

    fn fetch_blob(&self, digest: Digest) -> Result<Option<Vec<u8>>, StoreError> {
        self.block_on(self.fetch(&self.path(digest)))
    }

    /// The identity of the database whose tables are here; `None` if none was written.
    pub(in crate::store) async fn identity(&self) -> Result<Option<String>, StoreError> {
        let bytes = self.fetch(&self.connected.prefix.clone().join(IDENTITY)).await?;
        Ok(bytes.map(|bytes| String::from_utf8_lossy(&bytes).trim().to_owned()))
    }

    /// Writes the identity of the database whose tables are here.
    pub(in crate::store) async fn identify(&self, identity: &str) -> Result<(), StoreError> {
        let path = self.connected.prefix.clone().join(IDENTITY);
        let put = self.connected.store.put(&path, PutPayload::from(format!("{identity}\n"))).await;
        put.map(drop).map_err(|error| failure(&error))
    }

    /// Removes `orphan` as it was listed. One that was stored again since stays, and one that becomes known while it is
    /// removed is put back. A process that makes a blob known calls [`Blobs::keep`] afterwards, so the blob stays
    /// whichever comes first. Returns whether it was removed.
    ///
    /// # Errors
    /// When the store, or `is_known`, fails.
    pub fn remove(
        &self,
        orphan: &BlobInfo,
        is_known: &dyn Fn(Digest) -> Result<bool, StoreError>,
    ) -> Result<bool, StoreError> {
        let (digest, path) = (orphan.digest, self.path(orphan.digest));
        let Some(bytes) = self.fetch_blob(digest)? else { return Ok(false) };
        let stored = found(self.block_on(self.connected.store.head(&path)))?;
        if stored.and_then(|stored| info(&stored)).as_ref() != Some(orphan) {
            return Ok(false);
        }
        found(self.block_on(self.connected.store.delete(&path)))?;
        if is_known(digest)? {
            return self.put(&bytes).map(|_| false);
        }
        Ok(true)
    }
}

/// The answer about an object; `None` if there is no such object.
fn found<T>(answer: Result<T, Error>) -> Result<Option<T>, StoreError> {
    match answer {
        Ok(answer) => Ok(Some(answer)),
        Err(Error::NotFound { .. }) => Ok(None),
        Err(error) => Err(failure(&error)),
    }
}

fn failure(error: &Error) -> StoreError {
    match error {
        Error::PermissionDenied { .. } | Error::Unauthenticated { .. } => StoreError::Refused(text(error)),
        _ => StoreError::Unavailable(text(error)),
    }
}

fn info(object: &ObjectMeta) -> Option<BlobInfo> {
    let digest = object.location.filename()?.parse().ok()?;
    let stored_at = Timestamp::from_microsecond(object.last_modified.timestamp_micros()).ok()?;
    Some(BlobInfo { digest, stored_at, bytes: object.size })
}

impl Blobs for ObjectBlobs {
    /// Writes the object even if it exists. This renews its age, so that [`Self::remove`] leaves it until it
    /// becomes known, and repairs a damaged object.
    fn put(&self, bytes: &[u8]) -> Result<Digest, StoreError> {
        let digest = Digest::of(bytes);
        self.block_on(self.upload(&self.path(digest), bytes)).map_err(|error| failure(&error))?;
        self.see(digest);
        self.cache.put(digest, bytes);
        Ok(digest)
    }

    /// Bytes with another digest are a temporary error: a proxy may have sent them, and the object may be whole.
    fn get(&self, digest: Digest) -> Result<Option<Vec<u8>>, StoreError> {
        if let Some(bytes) = self.cache.get(digest) {
            return Ok(Some(bytes));
        }
        for _ in 0..2 {
            let Some(bytes) = self.fetch_blob(digest)? else { return Ok(None) };
            if Digest::of(&bytes) == digest {
                self.see(digest);
                self.cache.put(digest, &bytes);
                return Ok(Some(bytes));
            }
        }
        tracing::error!(%digest, "the object store gave other bytes than were stored, twice");
        Err(StoreError::OtherBytes(digest))
    }

    /// One that is not in the cache is fetched whole, and sent from the cache if there is room for it.
    fn checked(&self, digest: Digest) -> Result<Option<Checked>, StoreError> {
        let fetched = self.get(digest)?;
        let is_cached = || self.cache.file(digest).is_some();
        Ok(fetched.map(|bytes| match bytes.len() as u64 {
            length if length > SHORT_BYTES && is_cached() => Checked::Long(length),
            _ => Checked::Bytes(Arc::new(bytes)),
        }))
    }

    fn length(&self, digest: Digest) -> Result<Option<u64>, StoreError> {
        if let Some(length) = self.cache.file(digest).and_then(|file| regular_length(&file).ok()) {
            return Ok(Some(length));
        }
        let head = found(self.block_on(self.connected.store.head(&self.path(digest))))?;
        Ok(head.map(|head| head.size))
    }

    fn part(&self, digest: Digest, from: u64, length: usize) -> Result<Option<Vec<u8>>, StoreError> {
        if let Some(part) = self.cache.file(digest).and_then(|file| read_part(&file, from, length).ok()) {
            return Ok(Some(part));
        }
        let part = from..from + length as u64;
        let read = found(self.block_on(self.connected.store.get_range(&self.path(digest), part)))?;
        Ok(read.map(Vec::from))
    }

    fn contains(&self, digest: Digest) -> Result<bool, StoreError> {
        let seen = self.seen.lock().unwrap_or_else(PoisonError::into_inner).get(&digest).copied();
        if seen.is_some_and(|seen| seen.elapsed() < SEEN_FOR) {
            return Ok(true);
        }
        let is_there = found(self.block_on(self.connected.store.head(&self.path(digest))))?.is_some();
        if is_there {
            self.see(digest);
        }
        Ok(is_there)
    }

    fn delete(&self, digest: Digest) -> Result<(), StoreError> {
        found(self.block_on(self.connected.store.delete(&self.path(digest))))?;
        self.seen.lock().unwrap_or_else(PoisonError::into_inner).remove(&digest);
        self.cache.remove(digest);
        Ok(())
    }

    fn delete_unless(
        &self,
        digest: Digest,
        is_known: &dyn Fn(Digest) -> Result<bool, StoreError>,
    ) -> Result<(), StoreError> {
        let bytes = self.fetch_blob(digest)?;
        if is_known(digest)? {
            return Ok(());
        }
        self.delete(digest)?;
        match bytes {
            Some(bytes) if is_known(digest)? => self.put(&bytes).map(drop),
            _ => Ok(()),
        }
    }

    fn drop_copy(&self, digest: Digest) {
        self.seen.lock().unwrap_or_else(PoisonError::into_inner).remove(&digest);
        self.cache.remove(digest);
    }

    fn keep(&self, digest: Digest, bytes: &[u8]) -> Result<(), StoreError> {
        self.seen.lock().unwrap_or_else(PoisonError::into_inner).remove(&digest);
        if !self.contains(digest)? {
            self.put(bytes)?;
        }
        Ok(())
    }

    fn list(&self) -> Result<Vec<BlobInfo>, StoreError> {
        let listed = self.connected.store.list(Some(&self.connected.prefix));
        let blobs = listed.try_filter_map(|object| std::future::ready(Ok(info(&object)))).try_collect::<Vec<_>>();
        let mut blobs = self.block_on(blobs).map_err(|error| failure(&error))?;
        blobs.sort_by_key(|blob| blob.digest);
        Ok(blobs)
    }

    fn is_reachable(&self) -> bool {
        let path = self.connected.prefix.clone().join(IDENTITY);
        let asked = async { tokio::time::timeout(PROBE, self.connected.store.head(&path)).await };
        matches!(self.block_on(asked), Ok(Ok(_) | Err(Error::NotFound { .. })))
    }

    fn link(&self, digest: Digest, valid: Duration) -> Result<Option<String>, StoreError> {
        let Some(signer) = &self.connected.signer else { return Ok(None) };
        let path = self.path(digest);
        let signed = self.block_on(signer.signed_url(reqwest::Method::GET, &path, valid));
        signed.map(|url| Some(url.to_string())).map_err(|error| failure(&error))
    }
}

#[cfg(test)]
mod tests;
