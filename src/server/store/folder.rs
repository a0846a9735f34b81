//! Blobs as files in a folder.

use std::{
    fs, io,
    path::{Path, PathBuf},
    time::{Duration, SystemTime},
};

use jiff::Timestamp;
use rustix::fs::{AtFlags, CWD, Timespec, Timestamps, UTIME_NOW, UTIME_OMIT, utimensat};

use super::{BlobInfo, Blobs, StoreError, files};
use ltcforge_files::{
    digest::Digest,
    replace::{TEMPORARY_PREFIX, replace_file, sync_folder},
};

/// A file that was touched within this time is not touched again.
const TOUCHED: Duration = Duration::from_secs(60);

/// Blobs as files with the paths `ROOT/ab/ab12...`.
#[derive(Debug)]
pub struct FolderBlobs {
    root: PathBuf,
    quarantine: PathBuf,
}

impl FolderBlobs {
    /// The blobs in the folder `root`. Several processes may use the folder at the same time.
    ///
    /// # Errors
    /// When the folder cannot be created.
    pub fn shared(root: &Path, quarantine: &Path) -> Result<Self, StoreError> {
        files::make_folder(root)?;
        Ok(Self { root: root.to_owned(), quarantine: quarantine.to_owned() })
    }

    /// Like [`Self::shared`], for a folder that only this process uses. Removes temporary files that a crash has left.
    ///
    /// # Errors
    /// When the folder cannot be created or listed.
    pub fn open(root: &Path, quarantine: &Path) -> Result<Self, StoreError> {
        let blobs = Self::shared(root, quarantine)?;
        for file in blobs.files()? {
            let name = file.file_name().unwrap_or_default().to_string_lossy();
            // Older versions used the second prefix.
            if name.starts_with(TEMPORARY_PREFIX) || name.starts_with(".tmp-") {
                fs::remove_file(&file).map_err(|source| StoreError::of_io(&file, source))?;
            }
        }
        Ok(blobs)
    }

    fn path(&self, digest: Digest) -> PathBuf {
        let hex = digest.hex();
        self.root.join(&hex[..2]).join(hex)
    }

    /// All files, sorted by name.
    fn files(&self) -> Result<Vec<PathBuf>, StoreError> {
        let list = |folder: &Path| {
            let entries = fs::read_dir(folder).and_then(|entries| {
                entries.map(|entry| entry.map(|entry| entry.path())).collect::<io::Result<Vec<_>>>()
            });
            entries.map_err(|source| StoreError::of_io(folder, source))
        };
        let mut files = Vec::new();
        for folder in list(&self.root)? {
            if folder.is_dir() {
                files.extend(list(&folder)?);
            }
        }
        files.sort();
        Ok(files)
    }

    /// The times and the size of a blob's file. `None` if it is missing or not a regular file.
    fn info(path: &Path, digest: Digest) -> Result<Option<BlobInfo>, StoreError> {
        let Some(metadata) = found(files::regular_metadata(path), path)? else { return Ok(None) };
        let time = |time: io::Result<SystemTime>| {
            time.ok().and_then(|time| Timestamp::try_from(time).ok()).unwrap_or(Timestamp::UNIX_EPOCH)
        };
        let stored_at = time(metadata.modified());
        let used_at = time(metadata.accessed()).max(stored_at);
        Ok(Some(BlobInfo { digest, stored_at, used_at, bytes: metadata.len() }))
    }
}

/// The result of a file operation. `None` if the file is missing or not a regular file.
fn found<T>(answer: io::Result<T>, path: &Path) -> Result<Option<T>, StoreError> {
    match answer {
        Ok(answer) => Ok(Some(answer)),
        Err(error) if matches!(error.kind(), io::ErrorKind::NotFound | io::ErrorKind::InvalidData) => Ok(None),
        Err(source) => Err(StoreError::of_io(path, source)),
    }
}

impl Blobs for FolderBlobs {
    fn put(&self, bytes: &[u8]) -> Result<Digest, StoreError> {
        let digest = Digest::of(bytes);
        match self.get(digest) {
            Ok(Some(_)) => return self.touch(digest).map(|()| digest),
            // A damaged blob has just been moved to quarantine, so it is written again.
            Ok(None) | Err(StoreError::Corrupt { .. }) => {}
            Err(error) => return Err(error),
        }
        let path = self.path(digest);
        path.parent().map_or(Ok(()), files::make_folder)?;
        replace_file(&path, bytes).map_err(|source| StoreError::of_io(&path, source))?;
        Ok(digest)
    }

    fn get(&self, digest: Digest) -> Result<Option<Vec<u8>>, StoreError> {
        let path = self.path(digest);
        let bytes = match files::read_regular(&path) {
            Ok(bytes) => bytes,
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
            Err(error) if error.kind() == io::ErrorKind::InvalidData => {
                let moved_to = files::move_to_quarantine(&path, &self.quarantine, &digest.hex())?;
                tracing::error!(%digest, moved_to = %moved_to.display(), "a blob that is not a regular file was moved to quarantine");
                return Ok(None);
            }
            Err(source) => return Err(StoreError::of_io(path, source)),
        };
        let actual = Digest::of(&bytes);
        if actual == digest {
            return Ok(Some(bytes));
        }
        let moved_to = files::move_to_quarantine(&path, &self.quarantine, &digest.hex())?;
        tracing::error!(%digest, %actual, moved_to = %moved_to.display(), "a damaged blob was moved to quarantine");
        Err(StoreError::Corrupt { expected: digest, actual, moved_to })
    }

    fn stat(&self, digest: Digest) -> Result<Option<BlobInfo>, StoreError> {
        Self::info(&self.path(digest), digest)
    }

    fn touch(&self, digest: Digest) -> Result<(), StoreError> {
        let path = self.path(digest);
        let Some(metadata) = found(files::regular_metadata(&path), &path)? else { return Ok(()) };
        let used = metadata.accessed().ok().and_then(|used| used.elapsed().ok());
        if used.is_some_and(|ago| ago < TOUCHED) {
            return Ok(());
        }
        let time = |tv_nsec| Timespec { tv_sec: 0, tv_nsec };
        let times = Timestamps { last_access: time(UTIME_NOW), last_modification: time(UTIME_OMIT) };
        found(utimensat(CWD, &path, &times, AtFlags::SYMLINK_NOFOLLOW).map_err(io::Error::from), &path).map(drop)
    }

    fn delete(&self, digest: Digest) -> Result<(), StoreError> {
        let path = self.path(digest);
        let removed = fs::remove_file(&path).and_then(|()| path.parent().map_or(Ok(()), sync_folder));
        found(removed, &path).map(drop)
    }

    fn list(&self) -> Result<Vec<BlobInfo>, StoreError> {
        let mut blobs = Vec::new();
        for file in self.files()? {
            let name = file.file_name().unwrap_or_default().to_string_lossy();
            if let Ok(digest) = name.parse::<Digest>() {
                blobs.extend(Self::info(&file, digest)?);
            }
        }
        Ok(blobs)
    }
}

#[cfg(test)]
mod tests {
    use rustix::fs::{FileType, Mode};

    use super::*;

    fn blobs(dir: &Path) -> FolderBlobs {
        FolderBlobs::open(&dir.join("blobs"), &dir.join("quarantine")).unwrap()
    }

    #[test]
    fn a_blob_can_be_read_listed_and_put_again() {
        let dir = tempfile::tempdir().unwrap();
        let blobs = blobs(dir.path());
        let digest = blobs.put(b"table").unwrap();
        assert_eq!(digest, Digest::of(b"table"));
        assert_eq!(blobs.put(b"table").unwrap(), digest);
        assert_eq!(blobs.get(digest).unwrap().unwrap(), b"table");
        let info = blobs.stat(digest).unwrap().unwrap();
        assert_eq!((info.digest, info.bytes), (digest, 5));
        assert_eq!(blobs.list().unwrap(), [info]);
        let other = Digest::of(b"other");
        assert!(blobs.get(other).unwrap().is_none() && blobs.stat(other).unwrap().is_none());
        blobs.touch(other).unwrap();
        blobs.delete(digest).unwrap();
        blobs.delete(digest).unwrap();
        assert_eq!(blobs.list().unwrap(), []);
    }

    #[test]
    fn a_use_is_recorded_once_a_minute_and_the_time_of_storing_stays() {
        let dir = tempfile::tempdir().unwrap();
        let blobs = blobs(dir.path());
        let digest = blobs.put(b"table").unwrap();
        let old = SystemTime::now() - Duration::from_secs(3600);
        let file = fs::File::options().write(true).open(blobs.path(digest)).unwrap();
        let set = |used| file.set_times(fs::FileTimes::new().set_accessed(used).set_modified(old)).unwrap();
        set(old);
        let before = blobs.stat(digest).unwrap().unwrap();
        assert_eq!(before.used_at, before.stored_at);
        blobs.touch(digest).unwrap();
        let after = blobs.stat(digest).unwrap().unwrap();
        assert_eq!(after.stored_at, before.stored_at);
        assert!(after.used_at.duration_since(before.used_at).as_secs() > 3500);
        set(SystemTime::now() - TOUCHED / 2);
        let recent = blobs.stat(digest).unwrap().unwrap();
        blobs.touch(digest).unwrap();
        assert_eq!(blobs.stat(digest).unwrap().unwrap(), recent);
    }

    #[test]
    fn a_damaged_blob_is_moved_to_quarantine_once_and_can_be_stored_again() {
        let dir = tempfile::tempdir().unwrap();
        let blobs = blobs(dir.path());
        let digest = blobs.put(b"table").unwrap();
        fs::write(blobs.path(digest), b"tabel").unwrap();
        match blobs.get(digest) {
            Err(StoreError::Corrupt { expected, actual, moved_to }) => {
                assert_eq!((expected, actual), (digest, Digest::of(b"tabel")));
                assert_eq!(fs::read(moved_to).unwrap(), b"tabel");
            }
            other => panic!("{other:?}"),
        }
        assert!(blobs.get(digest).unwrap().is_none());
        fs::write(blobs.path(digest), b"").unwrap();
        blobs.put(b"table").unwrap();
        assert_eq!(blobs.get(digest).unwrap().unwrap(), b"table");
    }

    /// A FIFO without a writer makes a reader wait, and /dev/zero has no end.
    #[test]
    fn only_regular_files_are_opened() {
        type Make = fn(&Path);
        let kinds: [Make; 4] = [
            |path| {
                let elsewhere = path.with_file_name("elsewhere");
                fs::write(&elsewhere, b"table").unwrap();
                std::os::unix::fs::symlink(elsewhere, path).unwrap();
            },
            |path| fs::create_dir(path).unwrap(),
            |path| std::os::unix::fs::symlink("/dev/zero", path).unwrap(),
            |path| rustix::fs::mknodat(CWD, path, FileType::Fifo, Mode::RUSR, 0).unwrap(),
        ];
        for make in kinds {
            let dir = tempfile::tempdir().unwrap();
            let blobs = blobs(dir.path());
            let digest = Digest::of(b"table");
            let path = blobs.path(digest);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            make(&path);
            assert!(blobs.list().unwrap().is_empty());
            assert!(blobs.stat(digest).unwrap().is_none());
            blobs.touch(digest).unwrap();
            assert_eq!(blobs.get(digest).unwrap(), None);
            assert_eq!(fs::read_dir(dir.path().join("quarantine")).unwrap().count(), 1);
            make(&path);
            assert_eq!(blobs.put(b"table").unwrap(), digest);
            assert_eq!(blobs.get(digest).unwrap().unwrap(), b"table");
        }
    }

    #[test]
    fn temporary_files_are_removed_and_foreign_files_are_not() {
        let dir = tempfile::tempdir().unwrap();
        let folder = dir.path().join("blobs/ab");
        fs::create_dir_all(&folder).unwrap();
        for name in [".ltcforge.x.part", ".tmp-1-x"] {
            fs::write(folder.join(name), b"half").unwrap();
        }
        fs::write(folder.join("README"), b"a foreign file").unwrap();
        let shared = FolderBlobs::shared(&dir.path().join("blobs"), &dir.path().join("quarantine")).unwrap();
        assert_eq!(shared.files().unwrap().len(), 3);
        let blobs = blobs(dir.path());
        assert!(blobs.list().unwrap().is_empty());
        assert_eq!(blobs.files().unwrap().len(), 1);
    }
}
