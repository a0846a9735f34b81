//! Small files that may change while the service runs: tokens, certificate and key.

use std::{
    fs, io,
    os::unix::fs::MetadataExt as _,
    path::{Path, PathBuf},
    sync::{Mutex, PoisonError},
};

use ltcforge_files::bounded::read_file;

/// Maximum length of a file in bytes, about ten thousand tokens.
pub(super) const LONGEST_FILE: u64 = 1 << 20;

/// Inode, length and change time of a file. They differ after a write or a replacement. `None` for a missing file.
type Stamp = Option<(u64, u64, i64, i64)>;

fn stamp(path: &Path) -> Stamp {
    let file = fs::metadata(path).ok()?;
    Some((file.ino(), file.len(), file.ctime(), file.ctime_nsec()))
}

/// Files and their stamps at the last check.
#[derive(Debug, Default)]
pub(super) struct Watched {
    files: Vec<PathBuf>,
    stamps: Mutex<Vec<Stamp>>,
}

impl Watched {
    /// Records the stamps. Call this before reading the files, so that the next check finds changes made meanwhile.
    pub(super) fn new(files: Vec<PathBuf>) -> Self {
        let watched = Self { files, stamps: Mutex::default() };
        watched.changed();
        watched
    }

    /// Whether a file has changed since the last call.
    pub(super) fn changed(&self) -> bool {
        let now: Vec<Stamp> = self.files.iter().map(|file| stamp(file)).collect();
        let mut stamps = self.stamps.lock().unwrap_or_else(PoisonError::into_inner);
        std::mem::replace(&mut *stamps, now.clone()) != now
    }
}

/// Reads a regular file of at most [`LONGEST_FILE`] bytes. It never waits for a FIFO or reads a device.
pub(super) fn read(path: &Path) -> io::Result<Vec<u8>> {
    read_file(path, LONGEST_FILE)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rustix::fs::{CWD, Mode, mkfifoat};

    #[test]
    fn only_short_regular_files_are_read() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        mkfifoat(CWD, path("fifo"), Mode::RWXU).unwrap();
        std::os::unix::fs::symlink("/dev/zero", path("zero")).unwrap();
        fs::write(path("long"), vec![0; LONGEST_FILE as usize + 1]).unwrap();
        fs::write(path("most"), vec![0; LONGEST_FILE as usize]).unwrap();
        for name in ["fifo", "zero", "long", "missing", "."] {
            assert!(read(&path(name)).is_err(), "{name}");
        }
        assert_eq!(read(&path("most")).unwrap().len() as u64, LONGEST_FILE);
    }
}
