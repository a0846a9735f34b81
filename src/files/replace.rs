//! Files that are written completely or not at all.

use std::{
    ffi::OsString,
    fs::{self, File, OpenOptions},
    io::{self, Write as _},
    path::{Path, PathBuf},
    sync::atomic::{AtomicU64, Ordering},
};

/// Temporary files of other runs that are skipped before the search for a free name ends.
const MOST_NAMES: usize = 1000;

/// One of several files that belong together was not written.
#[derive(Debug, thiserror::Error)]
#[error("{}: {source}", .path.display())]
pub struct PairError {
    /// Which file.
    pub path: PathBuf,
    /// Why.
    pub source: io::Error,
}

/// Writes `bytes` to `path` and creates its folder if it is missing. After a crash, on a full disk, and for concurrent
/// readers, `path` has the old file or the new one, never a part.
///
/// # Errors
/// When the folder cannot be created or the file cannot be written; no temporary file is left then.
pub fn replace_file(path: &Path, bytes: &[u8]) -> io::Result<()> {
    replace_file_with(path, |file| file.write_all(bytes))
}

/// Like [`replace_file`], of what `write` puts into a temporary file. The old file stays when `write` fails.
///
/// # Errors
/// That of `write`, or the system's; no temporary file is left then.
pub fn replace_file_with<T, E: From<io::Error>>(
    path: &Path,
    write: impl FnOnce(&mut File) -> Result<T, E>,
) -> Result<T, E> {
    if path.file_name().is_none() {
        return Err(io::Error::new(io::ErrorKind::InvalidInput, "the path names no file").into());
    }
    let folder = folder_of(path);
    fs::create_dir_all(folder)?;
    let (mut file, temporary) = temporary_file(folder)?;
    let placed = write(&mut file).and_then(|written| {
        file.sync_all()?;
        fs::rename(&temporary, path)?;
        Ok(written)
    });
    if placed.is_err() {
        // The first error is the one to report.
        let _ = fs::remove_file(&temporary);
    }
    let written = placed?;
    File::open(folder)?.sync_all()?;
    Ok(written)
}

/// Writes two files that belong together, `first` before `second`. Where `second` cannot be written, a `first` that was
/// not there before is removed again.
///
/// # Errors
/// The file that cannot be written, and why.
pub fn replace_pair(first: (&Path, &[u8]), second: (&Path, &[u8])) -> Result<(), PairError> {
    let write = |(path, bytes): (&Path, &[u8])| {
        replace_file(path, bytes).map_err(|source| PairError { path: path.to_owned(), source })
    };
    let was_there = first.0.symlink_metadata().is_ok();
    write(first)?;
    write(second).inspect_err(|_| {
        if !was_there {
            // The first error is the one to report.
            let _ = fs::remove_file(first.0);
        }
    })
}

/// Whether a new file can be made in `folder`, or, while it is missing, in the folder that it would be made in. Finds out
/// by making one and removing it again.
///
/// # Errors
/// Why no file can be made there.
pub fn check_folder(folder: &Path) -> io::Result<()> {
    let here = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    match fs::metadata(here) {
        Ok(found) if found.is_dir() => {
            let (_, probe) = temporary_file(here)?;
            fs::remove_file(probe)
        }
        Ok(_) => Err(io::ErrorKind::NotADirectory.into()),
        Err(error) if error.kind() == io::ErrorKind::NotFound && here.symlink_metadata().is_err() => {
            match here.parent() {
                Some(parent) => check_folder(parent),
                None => Err(error),
            }
        }
        Err(error) => Err(error),
    }
}

/// The folder that `path` lies in.
#[must_use]
pub fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

/// A new file in `folder`, under a name of no other run, thread or file.
pub(super) fn temporary_file(folder: &Path) -> io::Result<(File, PathBuf)> {
    static COUNT: AtomicU64 = AtomicU64::new(0);
    for _ in 0..MOST_NAMES {
        let count = COUNT.fetch_add(1, Ordering::Relaxed);
        let path = folder.join(OsString::from(format!(".ltcforge.{}.{count}.part", std::process::id())));
        // A new file alone: a link of that name, laid by someone else, is not followed.
        match OpenOptions::new().write(true).create_new(true).open(&path) {
            Ok(file) => return Ok((file, path)),
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
            Err(error) => return Err(error),
        }
    }
    Err(io::Error::new(io::ErrorKind::AlreadyExists, "too many temporary files of runs that were cut off"))
}

#[cfg(test)]
mod tests {
    use std::{ffi::OsStr, os::unix::ffi::OsStrExt as _};

    use super::*;

    fn count(folder: &Path) -> usize {
        fs::read_dir(folder).expect("the folder").count()
    }

    #[test]
    fn a_file_is_replaced_and_its_folder_made() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a/b/table");
        replace_file(&path, b"one").expect("a new file");
        replace_file(&path, b"two").expect("a replaced file");
        assert_eq!(fs::read(&path).expect("the file"), b"two");
        assert_eq!(count(&folder.path().join("a/b")), 1, "nothing else is left");
    }

    #[test]
    fn a_failure_leaves_nothing_behind() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("table");
        fs::create_dir(&path).expect("a folder in the way");
        assert!(replace_file(&path, b"x").is_err());
        assert_eq!(count(folder.path()), 1);
    }

    #[test]
    fn any_name_that_the_system_allows_can_be_written() {
        let folder = tempfile::tempdir().expect("a folder");
        for name in [OsStr::from_bytes(b"\xff\xfe"), OsStr::new(&"x".repeat(255))] {
            replace_file(&folder.path().join(name), b"x").expect("a file");
        }
        assert_eq!(count(folder.path()), 2);
    }

    #[test]
    fn a_write_that_fails_half_way_keeps_the_old_file() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("table");
        replace_file(&path, b"old").expect("a file");
        let failed: io::Result<()> = replace_file_with(&path, |file| {
            file.write_all(b"ne")?;
            Err(io::ErrorKind::StorageFull.into())
        });
        assert!(failed.is_err());
        assert_eq!(fs::read(&path).expect("the file"), b"old");
        assert_eq!(count(folder.path()), 1);
    }

    #[test]
    fn the_first_of_two_files_goes_when_the_second_cannot_be_written() {
        let folder = tempfile::tempdir().expect("a folder");
        let (first, second) = (folder.path().join("first"), folder.path().join("second"));
        fs::create_dir(&second).expect("a folder in the way");
        let failed = replace_pair((&first, b"1"), (&second, b"2")).expect_err("no file");
        assert_eq!(failed.path, second);
        assert!(!first.exists());

        // What was there before stays: it may belong to an older second file.
        fs::write(&first, "old").expect("a file");
        assert!(replace_pair((&first, b"1"), (&second, b"2")).is_err());
        assert!(first.exists());
    }

    #[test]
    fn a_folder_is_checked_before_anything_is_written() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("file");
        fs::write(&file, "x").expect("a file");
        check_folder(folder.path()).expect("a folder");
        check_folder(&folder.path().join("a/b")).expect("folders that can be made");
        for wrong in [file.clone(), file.join("below"), "/proc".into(), "/proc/none/below".into()] {
            assert!(check_folder(&wrong).is_err(), "{}", wrong.display());
        }
        assert_eq!(count(folder.path()), 1, "nothing is left");
    }
}
