//! A bounded cache of blobs on disk.

use std::{
    fs::{self, File},
    io,
    path::{Path, PathBuf},
    sync::{Mutex, PoisonError},
    time::SystemTime,
};

use super::super::files::{is_temporary, read_regular};
use ltcforge_files::{digest::Digest, replace::replace_cached_file};

/// Blobs as files of a folder. A file's time of modification is that of its last use. Several processes may share the
/// folder.
#[derive(Debug)]
pub(super) struct BlobCache {
    folder: PathBuf,
    limit_bytes: u64,
    /// Bytes of the files when they were last listed, and those written since.
    bytes: Mutex<u64>,
}

impl BlobCache {
    /// The cache in `folder`, with the files that an earlier process left there.
    pub(super) fn open(folder: &Path, limit_bytes: u64) -> io::Result<Self> {
        fs::create_dir_all(folder)?;
        for entry in fs::read_dir(folder)? {
            let entry = entry?;
            // Left by a process that was killed. If another process is writing it now, that blob is not cached.
            if is_temporary(&entry.file_name().to_string_lossy()) {
                let _ = fs::remove_file(entry.path());
            }
        }
        let bytes = Mutex::new(shrink(folder, limit_bytes)?);
        Ok(Self { folder: folder.to_owned(), limit_bytes, bytes })
    }

    fn path(&self, digest: Digest) -> PathBuf {
        self.folder.join(digest.hex())
    }

    /// The bytes of a blob, if they are here and have its digest.
    pub(super) fn get(&self, digest: Digest) -> Option<Vec<u8>> {
        let path = self.path(digest);
        let bytes = read_regular(&path).ok()?;
        if Digest::of(&bytes) == digest {
            touch(&path);
            return Some(bytes);
        }
        tracing::warn!(%digest, "a blob in the cache is damaged; it is fetched again");
        let _ = fs::remove_file(path);
        None
    }

    /// Keeps a blob. A failure is logged: this is only a cache.
    pub(super) fn put(&self, digest: Digest, bytes: &[u8]) {
        if bytes.len() as u64 > self.limit_bytes {
            return;
        }
        if let Err(error) = replace_cached_file(&self.path(digest), bytes) {
            tracing::warn!(%digest, %error, "a blob could not be kept in the cache");
            return;
        }
        touch(&self.path(digest));
        let mut total = self.bytes.lock().unwrap_or_else(PoisonError::into_inner);
        *total += bytes.len() as u64;
        if *total > self.limit_bytes {
            match shrink(&self.folder, self.limit_bytes) {
                Ok(left) => *total = left,
                Err(error) => tracing::warn!(%error, "the cache of blobs could not be listed"),
            }
        }
    }
}

/// Records that a file was used. If that fails, it is removed earlier.
fn touch(path: &Path) {
    let _ = File::open(path).and_then(|file| file.set_modified(SystemTime::now()));
}

/// Removes the least recently used blobs if there are more than `limit_bytes`, until an eighth is free, so that the
/// folder is seldom listed. Returns the bytes that are left.
fn shrink(folder: &Path, limit_bytes: u64) -> io::Result<u64> {
    let blob = |entry: io::Result<fs::DirEntry>| {
        let entry = entry.ok()?;
        entry.file_name().to_str()?.parse::<Digest>().ok()?;
        // Another process may have removed it.
        let metadata = entry.metadata().ok()?;
        Some((metadata.modified().ok()?, metadata.len(), entry.path()))
    };
    let mut blobs: Vec<_> = fs::read_dir(folder)?.filter_map(blob).collect();
    let mut total: u64 = blobs.iter().map(|(_, bytes, _)| bytes).sum();
    if total > limit_bytes {
        blobs.sort();
        for (_, bytes, path) in blobs {
            if total > limit_bytes - limit_bytes / 8 && fs::remove_file(path).is_ok() {
                total -= bytes;
            }
        }
    }
    Ok(total)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_blobs_used_last_stay_within_the_limit() {
        let dir = tempfile::tempdir().unwrap();
        let cache = BlobCache::open(dir.path(), 24).unwrap();
        let blobs = [b"aaaaaaaaaa", b"bbbbbbbbbb", b"cccccccccc"];
        let [a, b, c] = blobs.map(|blob| Digest::of(blob));
        cache.put(a, blobs[0]);
        cache.put(b, blobs[1]);
        assert_eq!(cache.get(a).unwrap(), blobs[0]);
        cache.put(c, blobs[2]);
        assert_eq!(cache.get(b), None, "it was used longest ago");
        assert_eq!(cache.get(a).unwrap(), blobs[0]);
        cache.put(Digest::of(&[0; 25]), &[0; 25]);
        assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 2);
        drop(cache);
        fs::write(dir.path().join(".ltcforge.x.part"), "half").unwrap();
        let cache = BlobCache::open(dir.path(), 12).unwrap();
        assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 1, "the next one keeps as many as it may");
        assert!(cache.get(a).is_some());
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
