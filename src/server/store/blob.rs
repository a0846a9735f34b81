//! Blobs, named by the digest of their bytes.

use std::{
    fs, io,
    path::{Path, PathBuf},
    time::Duration,
};

use jiff::Timestamp;

use super::{StoreError, files};
use ltcforge_files::digest::Digest;

/// One blob in a list.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BlobInfo {
    /// Its name.
    pub digest: Digest,
    /// When it was stored.
    pub stored_at: Timestamp,
}

/// A blob whose bytes have its digest.
#[derive(Debug)]
pub enum Checked {
    /// At most [`SHORT_BYTES`], or more where the storage cannot read parts of it.
    Bytes(Vec<u8>),
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

    /// A blob checked against its digest, as by [`Self::get`]. A long one may be read without being kept.
    ///
    /// # Errors
    /// As [`Self::get`].
    fn checked(&self, digest: Digest) -> Result<Option<Checked>, StoreError> {
        Ok(self.get(digest)?.map(Checked::Bytes))
    }

    /// Whether there is a blob of that name; its bytes are not read.
    ///
    /// # Errors
    /// When the storage does not tell.
    fn contains(&self, digest: Digest) -> Result<bool, StoreError>;

    /// Stores a blob that has become known again if it was removed meanwhile: another process may have taken it for an
    /// orphan.
    ///
    /// # Errors
    /// As [`Self::put`].
    fn keep(&self, digest: Digest, bytes: &[u8]) -> Result<(), StoreError> {
        let _ = (digest, bytes);
        Ok(())
    }

    /// Removes a blob, durably when this returns; a missing one is no error.
    ///
    /// # Errors
    /// When the storage fails.
    fn delete(&self, digest: Digest) -> Result<(), StoreError>;

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

/// Blobs as files `ROOT/ab/ab12...`.
#[derive(Debug)]
pub struct FileBlobs {
    root: PathBuf,
    quarantine: PathBuf,
}

impl FileBlobs {
    /// Opens the folder `root` and removes the temporary files of writes that a crash interrupted.
    ///
    /// # Errors
    /// When the folder cannot be created or listed.
    pub fn open(root: &Path, quarantine: &Path) -> Result<Self, StoreError> {
        files::make_folder(root)?;
        let blobs = Self { root: root.to_owned(), quarantine: quarantine.to_owned() };
        for file in blobs.files()? {
            if file.file_name().is_some_and(|name| files::is_temporary(&name.to_string_lossy())) {
                fs::remove_file(&file).map_err(|source| StoreError::of_io(&file, source))?;
            }
        }
        Ok(blobs)
    }

    fn path(&self, digest: Digest) -> PathBuf {
        let hex = digest.hex();
        self.root.join(&hex[..2]).join(hex)
    }

    fn files(&self) -> Result<Vec<PathBuf>, StoreError> {
        let list = |folder: &Path| -> io::Result<Vec<PathBuf>> {
            fs::read_dir(folder)?.map(|entry| entry.map(|entry| entry.path())).collect()
        };
        let mut files = Vec::new();
        for folder in list(&self.root).map_err(|source| StoreError::of_io(&self.root, source))? {
            if folder.is_dir() {
                files.extend(list(&folder).map_err(|source| StoreError::of_io(&folder, source))?);
            }
        }
        files.sort();
        Ok(files)
    }
}

/// The answer about the file of a blob; `None` where there is no regular file.
fn regular<T>(answer: io::Result<T>, path: PathBuf) -> Result<Option<T>, StoreError> {
    match answer {
        Ok(answer) => Ok(Some(answer)),
        Err(error) if matches!(error.kind(), io::ErrorKind::NotFound | io::ErrorKind::InvalidData) => Ok(None),
        Err(source) => Err(StoreError::of_io(path, source)),
    }
}

impl Blobs for FileBlobs {
    fn put(&self, bytes: &[u8]) -> Result<Digest, StoreError> {
        let digest = Digest::of(bytes);
        match self.get(digest) {
            Ok(Some(_)) => return Ok(digest),
            // A damaged one has just been moved to quarantine.
            Ok(None) | Err(StoreError::Corrupt { .. }) => {}
            Err(error) => return Err(error),
        }
        let path = self.path(digest);
        path.parent().map_or(Ok(()), files::make_folder)?;
        files::write_durably(&path, bytes)?;
        Ok(digest)
    }

    fn get(&self, digest: Digest) -> Result<Option<Vec<u8>>, StoreError> {
        let path = self.path(digest);
        let bytes = match files::read_regular(&path) {
            Ok(bytes) => bytes,
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
            Err(error) if error.kind() == io::ErrorKind::InvalidData => {
                let moved_to = files::move_to_quarantine(&path, &self.quarantine, &digest.hex())?;
                tracing::error!(%digest, moved_to = %moved_to.display(), "a blob that is no regular file was moved to quarantine");
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

    fn checked(&self, digest: Digest) -> Result<Option<Checked>, StoreError> {
        if let Some(length) = self.length(digest)?.filter(|length| *length > SHORT_BYTES) {
            let path = self.path(digest);
            if regular(files::open_regular(&path).and_then(Digest::of_stream), path)? == Some(digest) {
                return Ok(Some(Checked::Long(length)));
            }
        }
        Ok(self.get(digest)?.map(Checked::Bytes))
    }

    fn length(&self, digest: Digest) -> Result<Option<u64>, StoreError> {
        let path = self.path(digest);
        regular(files::regular_length(&path), path)
    }

    fn part(&self, digest: Digest, from: u64, length: usize) -> Result<Option<Vec<u8>>, StoreError> {
        let path = self.path(digest);
        regular(files::read_part(&path, from, length), path)
    }

    fn delete(&self, digest: Digest) -> Result<(), StoreError> {
        let path = self.path(digest);
        let removed = fs::remove_file(&path).and_then(|()| path.parent().map_or(Ok(()), files::sync_folder));
        regular(removed, path).map(drop)
    }

    fn contains(&self, digest: Digest) -> Result<bool, StoreError> {
        Ok(self.path(digest).symlink_metadata().is_ok_and(|metadata| metadata.is_file()))
    }

    fn list(&self) -> Result<Vec<BlobInfo>, StoreError> {
        let mut blobs = Vec::new();
        for file in self.files()? {
            let name = file.file_name().unwrap_or_default().to_string_lossy();
            let Ok(digest) = name.parse::<Digest>() else { continue };
            let metadata = file.symlink_metadata().map_err(|source| StoreError::of_io(&file, source))?;
            if !metadata.is_file() {
                continue;
            }
            let stored_at = metadata.modified().map_err(|source| StoreError::of_io(&file, source))?;
            let stored_at = Timestamp::try_from(stored_at).unwrap_or(Timestamp::UNIX_EPOCH);
            blobs.push(BlobInfo { digest, stored_at });
        }
        Ok(blobs)
    }
}

#[cfg(test)]
mod tests {
    use rustix::fs::{FileType, Mode};

    use super::*;

    fn blobs(dir: &Path) -> FileBlobs {
        FileBlobs::open(&dir.join("blobs"), &dir.join("quarantine")).unwrap()
    }

    #[test]
    fn a_blob_can_be_read_listed_and_put_again() {
        let dir = tempfile::tempdir().unwrap();
        let blobs = blobs(dir.path());
        let digest = blobs.put(b"table").unwrap();
        assert_eq!(digest, Digest::of(b"table"));
        assert_eq!(blobs.put(b"table").unwrap(), digest);
        assert_eq!(blobs.get(digest).unwrap().unwrap(), b"table");
        assert!(blobs.contains(digest).unwrap());
        assert_eq!(blobs.list().unwrap().iter().map(|blob| blob.digest).collect::<Vec<_>>(), [digest]);
        assert!(blobs.get(Digest::of(b"other")).unwrap().is_none());
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
        assert_eq!(blobs.put(b"table").unwrap(), digest);
        assert_eq!(blobs.get(digest).unwrap().unwrap(), b"table");
    }

    #[test]
    fn putting_over_a_damaged_blob_repairs_it() {
        let dir = tempfile::tempdir().unwrap();
        let blobs = blobs(dir.path());
        let digest = blobs.put(b"table").unwrap();
        fs::write(blobs.path(digest), b"").unwrap();
        blobs.put(b"table").unwrap();
        assert_eq!(blobs.get(digest).unwrap().unwrap(), b"table");
    }

    /// Each kind in the place of a blob. A FIFO without a writer would be waited for, and /dev/zero has no end.
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
            |path| rustix::fs::mknodat(rustix::fs::CWD, path, FileType::Fifo, Mode::RUSR, 0).unwrap(),
        ];
        for make in kinds {
            let dir = tempfile::tempdir().unwrap();
            let blobs = blobs(dir.path());
            let digest = Digest::of(b"table");
            let path = blobs.path(digest);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            make(&path);
            assert!(blobs.list().unwrap().is_empty());
            assert!(!blobs.contains(digest).unwrap());
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
        let blobs = blobs(dir.path());
        assert!(blobs.list().unwrap().is_empty());
        assert_eq!(fs::read_dir(folder).unwrap().count(), 1);
    }
}
