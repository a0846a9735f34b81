//! A bounded cache of blobs on disk.

use std::{
    fs::{self, File},
    io,
    path::{Path, PathBuf},
    sync::{Mutex, PoisonError},
    time::SystemTime,
};

use super::super::{
    error::is_full,
    files::{is_temporary, read_regular},
};
use ltcforge_files::{digest::Digest, replace::replace_cached_file};

/// Blobs as files of a folder. A file's time of modification is that of its last use. Several processes may share the
/// folder.
#[derive(Debug)]
pub(super) struct BlobCache {
    /// `None` where nothing is kept.
    folder: Option<PathBuf>,
    limit_bytes: u64,
    /// Bytes that this process has written since it last listed the folder. It does so after a sixteenth of the limit and
    /// leaves an eighth free, for what two processes write meanwhile.
    written: Mutex<u64>,
}

impl BlobCache {
    /// The cache in `folder`, with the files that an earlier process left there. With a limit of 0 nothing is kept, and the folder is
    /// left alone.
    pub(super) fn open(folder: &Path, limit_bytes: u64) -> io::Result<Self> {
        if limit_bytes == 0 {
            return Ok(Self { folder: None, limit_bytes, written: Mutex::default() });
        }
        fs::create_dir_all(folder)?;
        for entry in fs::read_dir(folder)? {
            let entry = entry?;
            // Left by a process that was killed. If another process is writing it now, that blob is not cached.
            if is_temporary(&entry.file_name().to_string_lossy()) {
                let _ = fs::remove_file(entry.path());
            }
        }
        shrink(folder, |_| limit_bytes - limit_bytes / 8)?;
        Ok(Self { folder: Some(folder.to_owned()), limit_bytes, written: Mutex::default() })
    }

    fn path(&self, digest: Digest) -> Option<PathBuf> {
        Some(self.folder.as_ref()?.join(digest.hex()))
    }

    /// The bytes of a blob, if they are here and have its digest.
    pub(super) fn get(&self, digest: Digest) -> Option<Vec<u8>> {
        let path = self.path(digest)?;
        let bytes = read_regular(&path).ok()?;
        if Digest::of(&bytes) == digest {
            touch(&path);
            return Some(bytes);
        }
        tracing::warn!(%digest, "a blob in the cache is damaged; it is fetched again");
        let _ = fs::remove_file(path);
        None
    }

    /// The file of a blob, if there is one. Its bytes are not checked.
    pub(super) fn file(&self, digest: Digest) -> Option<PathBuf> {
        self.path(digest).filter(|path| path.is_file())
    }

    /// Removes a blob. If that fails, it is removed as the others are.
    pub(super) fn remove(&self, digest: Digest) {
        let _ = self.path(digest).map(fs::remove_file);
    }

    /// Keeps a blob. A failure is logged: this is only a cache.
    pub(super) fn put(&self, digest: Digest, bytes: &[u8]) {
        let length = bytes.len() as u64;
        let Some(folder) = self.folder.as_ref().filter(|_| length <= self.limit_bytes) else { return };
        let path = folder.join(digest.hex());
        let kept = replace_cached_file(&path, bytes).or_else(|error| {
            if !is_full(error.kind()) {
                return Err(error);
            }
            shrink(folder, |total| total - length.max(total / 8).min(total))?;
            replace_cached_file(&path, bytes)
        });
        if let Err(error) = kept {
            tracing::warn!(%digest, %error, "a blob could not be kept in the cache");
            return;
        }
        touch(&path);
        let mut written = self.written.lock().unwrap_or_else(PoisonError::into_inner);
        *written += length;
        if *written > self.limit_bytes / 16 {
            *written = 0;
            if let Err(error) = shrink(folder, |_| self.limit_bytes - self.limit_bytes / 8) {
                tracing::warn!(%error, "the cache of blobs could not be listed");
            }
        }
    }
}

/// Records that a file was used. If that fails, it is removed earlier.
fn touch(path: &Path) {
    let _ = File::open(path).and_then(|file| file.set_modified(SystemTime::now()));
}

/// Removes the least recently used blobs while there are more bytes than `most`, which is told how many there are.
fn shrink(folder: &Path, most: impl Fn(u64) -> u64) -> io::Result<()> {
    let blob = |entry: io::Result<fs::DirEntry>| {
        let entry = entry.ok()?;
        entry.file_name().to_str()?.parse::<Digest>().ok()?;
        // Another process may have removed it.
        let metadata = entry.metadata().ok()?;
        Some((metadata.modified().ok()?, metadata.len(), entry.path()))
    };
    let mut blobs: Vec<_> = fs::read_dir(folder)?.filter_map(blob).collect();
    let mut total: u64 = blobs.iter().map(|(_, bytes, _)| bytes).sum();
    let most = most(total);
    blobs.sort();
    for (_, bytes, path) in blobs {
        if total > most && fs::remove_file(path).is_ok() {
            total -= bytes;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::store::tests::small_disk::SmallDisk;

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

    fn bytes_in(folder: &Path) -> u64 {
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().metadata().unwrap().len()).sum()
    }

    #[test]
    fn two_processes_in_one_folder_stay_within_the_limit_together() {
        let dir = tempfile::tempdir().unwrap();
        let caches = [1600, 1600].map(|limit| BlobCache::open(dir.path(), limit).unwrap());
        for n in 0..80_u8 {
            let blob = [n; 50];
            caches[usize::from(n) % 2].put(Digest::of(&blob), &blob);
            assert!(bytes_in(dir.path()) <= 1600, "after {n} blobs");
        }
        assert!(bytes_in(dir.path()) > 800, "it is used");
    }

    #[test]
    fn a_full_disk_makes_room_for_the_blob_used_last() {
        let dir = tempfile::tempdir().unwrap();
        let Some(disk) = SmallDisk::mount(dir.path().join("disk")) else { return };
        let cache = BlobCache::open(&disk.0.join("cache"), 1 << 30).unwrap();
        for n in 0..12_u8 {
            let blob = vec![n; 3 << 20];
            cache.put(Digest::of(&blob), &blob);
            assert!(cache.get(Digest::of(&blob)).is_some(), "blob {n}");
        }
        assert!(bytes_in(&disk.0.join("cache")) > 6 << 20, "it is used");
    }

    #[test]
    fn a_damaged_blob_is_not_served() {
        let dir = tempfile::tempdir().unwrap();
        let cache = BlobCache::open(dir.path(), 100).unwrap();
        let digest = Digest::of(b"table");
        cache.put(digest, b"table");
        let file = cache.path(digest).unwrap();
        fs::write(&file, "tabel").unwrap();
        assert_eq!(cache.get(digest), None);
        assert!(!file.exists());
    }

    #[test]
    fn a_cache_of_nothing_leaves_the_folder_alone() {
        let dir = tempfile::tempdir().unwrap();
        let digest = Digest::of(b"table");
        let kept = BlobCache::open(dir.path(), 100).unwrap();
        kept.put(digest, b"table");
        let none = BlobCache::open(dir.path(), 0).unwrap();
        none.put(Digest::of(b""), b"");
        none.remove(digest);
        assert_eq!((none.get(digest), none.file(digest)), (None, None));
        assert_eq!(kept.get(digest).unwrap(), b"table");
        assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 1);
    }
}
