//! Blobs as files of a folder.

use std::{
    fs, io,
    path::{Path, PathBuf},
    sync::Arc,
};

use jiff::Timestamp;

use super::{
    BlobInfo, Blobs, Checked, SHORT_BYTES, StoreError, files,
    verified::{Stamp, Verified},
};
use ltcforge_files::digest::Digest;

/// Blobs as files `ROOT/ab/ab12...`.
#[derive(Debug)]
pub struct FileBlobs {
    root: PathBuf,
    quarantine: PathBuf,
    verified: Verified,
}

impl FileBlobs {
    /// Opens the folder `root` and removes the temporary files of writes that a crash interrupted.
    ///
    /// # Errors
    /// When the folder cannot be created or listed.
    pub fn open(root: &Path, quarantine: &Path) -> Result<Self, StoreError> {
        files::make_folder(root)?;
        let blobs = Self { root: root.to_owned(), quarantine: quarantine.to_owned(), verified: Verified::default() };
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
        self.verified.forget(digest);
        let moved_to = files::move_to_quarantine(&path, &self.quarantine, &digest.hex())?;
        tracing::error!(%digest, %actual, moved_to = %moved_to.display(), "a damaged blob was moved to quarantine");
        Err(StoreError::Corrupt { expected: digest, actual, moved_to })
    }

    fn checked(&self, digest: Digest) -> Result<Option<Checked>, StoreError> {
        let path = self.path(digest);
        // What is no regular file is moved to quarantine below.
        let Some(stamp) = regular(files::regular_metadata(&path), path.clone())?.map(|file| Stamp::of(&file)) else {
            return Ok(self.get(digest)?.map(|bytes| Checked::Bytes(Arc::new(bytes))));
        };
        if let Some(known) = self.verified.get(digest, &stamp) {
            return Ok(Some(known));
        }
        let is_known = self.verified.is_known(digest, &stamp);
        if stamp.length > SHORT_BYTES {
            if regular(files::open_regular(&path).and_then(Digest::of_stream), path)? == Some(digest) {
                self.verified.remember(digest, stamp);
                return Ok(Some(Checked::Long(stamp.length)));
            }
        } else if is_known && let Some(bytes) = regular(files::read_regular(&path), path.clone())? {
            // The bytes are those that were hashed if the file did not change while they were read.
            let bytes = Arc::new(bytes);
            if files::regular_metadata(&path).is_ok_and(|file| Stamp::of(&file) == stamp) {
                self.verified.keep(digest, &bytes);
                return Ok(Some(Checked::Bytes(bytes)));
            }
        }
        let Some(bytes) = self.get(digest)?.map(Arc::new) else { return Ok(None) };
        self.verified.remember(digest, stamp);
        self.verified.keep(digest, &bytes);
        Ok(Some(Checked::Bytes(bytes)))
    }

    fn known(&self, digest: Digest) -> Option<Checked> {
        let file = files::regular_metadata(&self.path(digest)).ok()?;
        self.verified.get(digest, &Stamp::of(&file))
    }

    fn remembers(&self) -> bool {
        true
    }

    fn recheck(&self, digest: Digest, go_on: &mut dyn FnMut(usize) -> bool) -> Result<(), StoreError> {
        let path = self.path(digest);
        let read = files::open_regular(&path).and_then(|file| files::digest_from_disk(file, go_on));
        match regular(read, path)? {
            Some(Some(actual)) if actual != digest => self.get(digest).map(drop),
            _ => Ok(()),
        }
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
        self.verified.forget(digest);
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
            blobs.push(BlobInfo { digest, stored_at, bytes: metadata.len() });
        }
        Ok(blobs)
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

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

    /// Same length and time of modification: the time of change tells. Right after a write, no stamp counts.
    #[test]
    fn a_blob_is_hashed_again_once_its_file_changed() {
        let dir = tempfile::tempdir().unwrap();
        let blobs = blobs(dir.path());
        let long = vec![7; SHORT_BYTES as usize + 1];
        let digests = [&b"table"[..], &long].map(|bytes| blobs.put(bytes).unwrap());
        for digest in digests {
            blobs.checked(digest).unwrap().unwrap();
            assert!(blobs.known(digest).is_none(), "a change within the same tick would not be seen");
        }
        std::thread::sleep(Duration::from_secs(5));
        for digest in digests {
            blobs.checked(digest).unwrap().unwrap();
            let length = match blobs.known(digest).expect("it was hashed") {
                Checked::Bytes(bytes) => bytes.len() as u64,
                Checked::Long(length) => length,
            };
            assert_eq!(Some(length), blobs.length(digest).unwrap());
            let path = blobs.path(digest);
            let modified = fs::metadata(&path).unwrap().modified().unwrap();
            let mut bad = fs::read(&path).unwrap();
            bad[1] ^= 1;
            fs::write(&path, &bad).unwrap();
            fs::File::options().write(true).open(&path).unwrap().set_modified(modified).unwrap();
            assert!(blobs.known(digest).is_none());
            assert!(matches!(blobs.checked(digest), Err(StoreError::Corrupt { .. })));
            assert!(blobs.known(digest).is_none() && blobs.checked(digest).unwrap().is_none());
        }
    }

    /// As if the disk had turned a bit under a file that nobody wrote.
    #[test]
    fn a_recheck_finds_what_the_stamp_does_not_tell() {
        let dir = tempfile::tempdir().unwrap();
        let blobs = blobs(dir.path());
        let digest = blobs.put(b"table").unwrap();
        blobs.recheck(digest, &mut |_| true).unwrap();
        fs::write(blobs.path(digest), b"tabel").unwrap();
        std::thread::sleep(Duration::from_secs(5));
        let stamp = Stamp::of(&fs::metadata(blobs.path(digest)).unwrap());
        blobs.verified.remember(digest, stamp);
        blobs.verified.keep(digest, &Arc::new(b"table".to_vec()));
        assert!(blobs.known(digest).is_some());
        blobs.recheck(digest, &mut |_| false).expect("it was told to stop");
        assert!(matches!(blobs.recheck(digest, &mut |_| true), Err(StoreError::Corrupt { .. })));
        assert!(blobs.known(digest).is_none() && !blobs.contains(digest).unwrap());
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
