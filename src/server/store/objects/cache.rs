//! A bounded cache of blobs on disk.

use std::{
    collections::{BTreeMap, HashMap},
    fs, io,
    path::{Path, PathBuf},
    sync::{
        Mutex, MutexGuard, PoisonError,
        atomic::{AtomicU64, Ordering},
    },
};

use ltcforge_files::digest::Digest;

/// Prefix of files that are being written.
const TEMPORARY: &str = ".tmp-";

/// Blobs as files of a folder, the ones used last. Several processes may share the folder; each keeps its own account.
#[derive(Debug)]
pub(super) struct BlobCache {
    folder: PathBuf,
    limit_bytes: u64,
    account: Mutex<Account>,
    writes: AtomicU64,
}

#[derive(Debug, Default)]
struct Account {
    /// By digest: bytes, and when it was used.
    blobs: HashMap<Digest, (u64, u64)>,
    by_use: BTreeMap<u64, Digest>,
    bytes: u64,
    uses: u64,
}

impl Account {
    fn remove(&mut self, digest: &Digest) {
        if let Some((bytes, used)) = self.blobs.remove(digest) {
            self.by_use.remove(&used);
            self.bytes -= bytes;
        }
    }

    fn add(&mut self, digest: Digest, bytes: u64) {
        self.remove(&digest);
        self.uses += 1;
        self.blobs.insert(digest, (bytes, self.uses));
        self.by_use.insert(self.uses, digest);
        self.bytes += bytes;
    }

    /// Takes out the blob that was used longest ago if there are too many bytes.
    fn evict(&mut self, limit_bytes: u64) -> Option<Digest> {
        let (_, oldest) = self.by_use.first_key_value().filter(|_| self.bytes > limit_bytes)?;
        let oldest = *oldest;
        self.remove(&oldest);
        Some(oldest)
    }
}

impl BlobCache {
    /// The cache in `folder`, with what an earlier process left there.
    pub(super) fn open(folder: &Path, limit_bytes: u64) -> io::Result<Self> {
        fs::create_dir_all(folder)?;
        let mut account = Account::default();
        for entry in fs::read_dir(folder)? {
            let entry = entry?;
            let name = entry.file_name().to_string_lossy().into_owned();
            match name.parse() {
                Ok(digest) => account.add(digest, entry.metadata()?.len()),
                // One that a process was writing when it was killed. Should another be writing it, it does without.
                Err(_) if name.starts_with(TEMPORARY) => drop(fs::remove_file(entry.path())),
                Err(_) => {}
            }
        }
        let cache =
            Self { folder: folder.to_owned(), limit_bytes, account: Mutex::new(account), writes: AtomicU64::new(0) };
        cache.shrink();
        Ok(cache)
    }

    fn account(&self) -> MutexGuard<'_, Account> {
        self.account.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn path(&self, digest: Digest) -> PathBuf {
        self.folder.join(digest.hex())
    }

    /// The bytes of a blob, if they are here and have its digest.
    pub(super) fn get(&self, digest: Digest) -> Option<Vec<u8>> {
        let bytes = fs::read(self.path(digest)).ok()?;
        if Digest::of(&bytes) == digest {
            self.account().add(digest, bytes.len() as u64);
            return Some(bytes);
        }
        tracing::warn!(%digest, "a blob in the cache is damaged; it is fetched again");
        let _ = fs::remove_file(self.path(digest));
        self.account().remove(&digest);
        None
    }

    /// Keeps a blob. It is only a cache: what cannot be written is logged.
    pub(super) fn put(&self, digest: Digest, bytes: &[u8]) {
        if bytes.len() as u64 > self.limit_bytes {
            return;
        }
        let number = self.writes.fetch_add(1, Ordering::Relaxed);
        let temporary = self.folder.join(format!("{TEMPORARY}{}-{number}", std::process::id()));
        match fs::write(&temporary, bytes).and_then(|()| fs::rename(&temporary, self.path(digest))) {
            Ok(()) => self.account().add(digest, bytes.len() as u64),
            Err(error) => {
                tracing::warn!(%digest, %error, "a blob could not be kept in the cache");
                let _ = fs::remove_file(temporary);
            }
        }
        self.shrink();
    }

    fn shrink(&self) {
        loop {
            let oldest = self.account().evict(self.limit_bytes);
            let Some(oldest) = oldest else { return };
            let _ = fs::remove_file(self.path(oldest));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_blobs_used_last_stay_within_the_limit() {
        let dir = tempfile::tempdir().unwrap();
        let cache = BlobCache::open(dir.path(), 20).unwrap();
        let blobs = [b"aaaaaaaaaa", b"bbbbbbbbbb", b"cccccccccc"];
        let [a, b, c] = blobs.map(|blob| Digest::of(blob));
        cache.put(a, blobs[0]);
        cache.put(b, blobs[1]);
        assert_eq!(cache.get(a).unwrap(), blobs[0]);
        cache.put(c, blobs[2]);
        assert_eq!(cache.get(b), None, "it was used longest ago");
        assert_eq!(cache.get(a).unwrap(), blobs[0]);
        cache.put(Digest::of(&[0; 21]), &[0; 21]);
        assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 2);
        drop(cache);
        fs::write(dir.path().join(".tmp-1-1"), "half").unwrap();
        let cache = BlobCache::open(dir.path(), 10).unwrap();
        assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 1, "the next one keeps as many as it may");
        assert_eq!(usize::from(cache.get(a).is_some()) + usize::from(cache.get(c).is_some()), 1);
    }

    #[test]
    fn a_damaged_blob_is_not_served() {
        let dir = tempfile::tempdir().unwrap();
        let cache = BlobCache::open(dir.path(), 100).unwrap();
        let digest = Digest::of(b"table");
        cache.put(digest, b"table");
        fs::write(cache.path(digest), "tabel").unwrap();
        assert_eq!(cache.get(digest), None);
        assert!(!cache.path(digest).exists());
    }
}
