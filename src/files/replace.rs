//! Writes files completely or not at all.
//!
//! A file is written under a temporary name in its folder, flushed with fsync and renamed. After a crash, on a full
//! disk, and for concurrent readers, its path has the old file or the new file, never a part.

use std::{
    fs::{self, File},
    io::{self, Write as _},
    path::{Path, PathBuf},
    sync::Arc,
};

use tempfile::NamedTempFile;

/// The prefix of temporary files. A killed process leaves its temporary files; they may be deleted.
pub const TEMPORARY_PREFIX: &str = ".ltcforge.";

/// A file could not be written.
#[derive(Debug, thiserror::Error)]
#[error("{}: {source}", .path.display())]
pub struct PairError {
    /// The path of the file.
    pub path: PathBuf,
    /// The error of the system.
    pub source: io::Error,
}

/// Writes `bytes` to `path` and creates its folder if it is missing. A file that is replaced keeps its permissions.
///
/// # Errors
/// The folder cannot be created or the file cannot be written. No temporary file remains.
pub fn replace_file(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut staged = Staged::default();
    staged.write(path, |file| file.write_all(bytes))?;
    staged.place().map_err(|error| error.source)
}

/// Like [`replace_file`], in an existing folder and without fsync. After a power cut the file may be empty or cut off.
/// This is for caches, whose readers verify the bytes.
///
/// # Errors
/// The file cannot be written. No temporary file remains.
pub fn replace_cached_file(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut file = temporary_file(folder_of(path), None)?;
    file.write_all(bytes)?;
    file.persist(path)?;
    Ok(())
}

/// Writes two files that belong together, `first` before `second`. If `second` cannot be written, a `first` that did
/// not exist before is deleted again.
///
/// # Errors
/// The file that cannot be written, and the reason.
pub fn replace_pair(first: (&Path, &[u8]), second: (&Path, &[u8])) -> Result<(), PairError> {
    let was_there = first.0.symlink_metadata().is_ok();
    let mut staged = Staged::default();
    // The file that is staged last is moved first.
    for (path, bytes) in [second, first] {
        let written = staged.write(path, |file| file.write_all(bytes));
        written.map_err(|source| PairError { path: path.to_owned(), source })?;
    }
    staged.place().inspect_err(|_| {
        if !was_there {
            // Report the first error.
            let _ = fs::remove_file(first.0);
        }
    })
}

/// Files that were written next to their destinations and are not yet moved. Dropping the value deletes them, and the
/// folders that were created for them.
#[derive(Debug, Default)]
pub struct Staged {
    /// Temporary files, which are deleted when dropped, and their destinations.
    files: Vec<(Temporary, PathBuf)>,
    /// The created folders, in order.
    folders: Vec<PathBuf>,
}

/// Maximum number of folders that a [`Staged`] keeps open. Systems often allow a process 1,024 open files.
const MOST_OPEN: usize = 256;

/// A temporary file, deleted when dropped.
#[derive(Debug)]
struct Temporary {
    path: PathBuf,
    /// The open folder of the file. Through it, the file is deleted even if another folder has the path by then.
    folder: Option<Arc<File>>,
}

impl Drop for Temporary {
    fn drop(&mut self) {
        // The file is missing if it was moved to its destination.
        #[cfg(unix)]
        if let (Some(folder), Some(name)) = (&self.folder, self.path.file_name()) {
            let _ = rustix::fs::unlinkat(folder, name, rustix::fs::AtFlags::empty());
            return;
        }
        let _ = fs::remove_file(&self.path);
    }
}

impl Staged {
    /// Lets `write` fill a temporary file for `place`, in the same folder, which is created if it is missing. A file
    /// that was staged for this place before is dropped. The new file gets the permissions of the file that it
    /// replaces.
    ///
    /// # Errors
    /// The error of `write` or of the system. Then nothing is staged for this place.
    pub fn write<T, E: From<io::Error>>(
        &mut self,
        place: &Path,
        write: impl FnOnce(&mut File) -> Result<T, E>,
    ) -> Result<T, E> {
        self.files.retain(|(_, other)| other != place);
        if place.file_name().is_none() {
            return Err(io::Error::new(io::ErrorKind::InvalidInput, "the path names no file").into());
        }
        let folder = folder_of(place);
        self.make_folder(folder)?;
        let open = self.open_folder(folder);
        let (mut file, path) = temporary_file(folder, open.as_deref())?.keep().map_err(io::Error::from)?;
        let temporary = Temporary { path, folder: open };
        let written = write(&mut file)?;
        if let Ok(old) = place.symlink_metadata()
            && old.is_file()
        {
            file.set_permissions(old.permissions())?;
        }
        file.sync_all()?;
        self.files.push((temporary, place.to_owned()));
        Ok(written)
    }

    /// The path of the temporary file for `place`, if it is staged.
    #[must_use]
    pub fn path_of(&self, place: &Path) -> Option<&Path> {
        self.files.iter().find(|(_, other)| other == place).map(|(temporary, _)| &*temporary.path)
    }

    /// The destinations of all staged files.
    pub fn places(&self) -> impl Iterator<Item = &Path> {
        self.files.iter().map(|(_, place)| place.as_path())
    }

    /// Whether nothing is staged.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.files.is_empty()
    }

    /// Moves every file to its destination. Each destination has the old file or the new file at any time, never a
    /// part. A crash in between leaves new files in some places and old files in others. The file that was staged last
    /// is moved first.
    ///
    /// # Errors
    /// The first file that cannot be moved. Files moved before it stay; the others are dropped.
    pub fn place(mut self) -> Result<(), PairError> {
        while let Some((temporary, place)) = self.files.pop() {
            let placed = fs::rename(&temporary.path, &place);
            placed.and_then(|()| sync_folder(folder_of(&place))).map_err(|source| PairError { path: place, source })?;
        }
        Ok(())
    }

    /// Drops the files that were staged after the first `count`.
    pub fn truncate(&mut self, count: usize) {
        self.files.truncate(count);
    }

    /// An open handle of a folder. `None` if too many are open, or where the system cannot open folders.
    fn open_folder(&self, folder: &Path) -> Option<Arc<File>> {
        let open =
            |(temporary, place): &(Temporary, PathBuf)| temporary.folder.clone().filter(|_| folder_of(place) == folder);
        let shared = self.files.iter().find_map(open);
        if shared.is_some() || self.files.len() >= MOST_OPEN {
            return shared;
        }
        File::open(folder).ok().map(Arc::new)
    }

    /// Creates a folder and its parents, and remembers which of them were missing.
    fn make_folder(&mut self, folder: &Path) -> io::Result<()> {
        let mut missing: Vec<&Path> =
            folder.ancestors().take_while(|path| !path.as_os_str().is_empty() && !path.exists()).collect();
        missing.reverse();
        fs::create_dir_all(folder)?;
        self.folders.extend(missing.into_iter().map(Path::to_owned));
        Ok(())
    }
}

impl Drop for Staged {
    fn drop(&mut self) {
        self.files.clear();
        for folder in self.folders.iter().rev() {
            // A folder that is not empty stays.
            let _ = fs::remove_dir(folder);
        }
    }
}

/// Checks that a new file can be created in `folder`, or, if it is missing, in its nearest existing parent. Creates a
/// file and deletes it again.
///
/// # Errors
/// The reason why no file can be created there.
pub fn check_folder(folder: &Path) -> io::Result<()> {
    let here = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    match fs::metadata(here) {
        Ok(found) if found.is_dir() => temporary_file(here, None)?.close(),
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

/// The folder of `path`.
#[must_use]
pub fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

/// Makes the file names in `folder` durable. Only Unix can open a folder and needs this call.
///
/// # Errors
/// The folder cannot be opened, or the disk fails.
pub fn sync_folder(folder: &Path) -> io::Result<()> {
    if cfg!(unix) {
        File::open(folder)?.sync_all()?;
    }
    Ok(())
}

/// A new file in `folder`, whose handle may be `open`, with the usual permissions. The permissions of `tempfile` would
/// let only the owner read it.
#[cfg_attr(not(unix), expect(unused_variables, reason = "only Unix opens files in open folders"))]
fn temporary_file(folder: &Path, open: Option<&File>) -> io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(TEMPORARY_PREFIX).suffix(".part");
    builder.make_in(folder, |path| {
        #[cfg(unix)]
        if let (Some(open), Some(name)) = (open, path.file_name()) {
            use rustix::fs::{Mode, OFlags, openat};
            let flags = OFlags::WRONLY | OFlags::CREATE | OFlags::EXCL | OFlags::CLOEXEC;
            return Ok(openat(open, name, flags, Mode::from_raw_mode(0o666))?.into());
        }
        File::options().write(true).create_new(true).open(path)
    })
}

#[cfg(test)]
mod tests {
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

    #[cfg(unix)]
    #[test]
    fn any_name_that_the_system_allows_can_be_written() {
        use std::{ffi::OsStr, os::unix::ffi::OsStrExt as _};

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
        let failed: io::Result<()> = Staged::default().write(&path, |file| {
            file.write_all(b"ne")?;
            Err(io::ErrorKind::StorageFull.into())
        });
        assert!(failed.is_err());
        assert_eq!(fs::read(&path).expect("the file"), b"old");
        assert_eq!(count(folder.path()), 1);
    }

    #[cfg(unix)]
    #[test]
    fn a_new_file_has_usual_permissions_and_a_replaced_one_keeps_its_own() {
        use std::os::unix::fs::PermissionsExt as _;

        let folder = tempfile::tempdir().expect("a folder");
        let [usual, path] = ["usual", "table"].map(|name| folder.path().join(name));
        let mode = |path: &Path| fs::metadata(path).expect("a file").permissions().mode();
        fs::write(&usual, "").expect("a file");
        replace_file(&path, b"one").expect("a new file");
        assert_eq!(mode(&path), mode(&usual));
        fs::set_permissions(&path, fs::Permissions::from_mode(0o640)).expect("our file");
        replace_file(&path, b"two").expect("a replaced file");
        assert_eq!(mode(&path) & 0o777, 0o640);
        replace_cached_file(&usual, b"three").expect("a replaced file");
        assert_eq!(fs::read(&usual).expect("the file"), b"three");
        assert_eq!(count(folder.path()), 2, "no temporary file is left");
    }

    #[test]
    fn the_first_of_two_files_is_deleted_when_the_second_cannot_be_written() {
        let folder = tempfile::tempdir().expect("a folder");
        let (first, second) = (folder.path().join("first"), folder.path().join("second"));
        fs::create_dir(&second).expect("a folder in the way");
        let failed = replace_pair((&first, b"1"), (&second, b"2")).expect_err("no file");
        assert_eq!(failed.path, second);
        assert!(!first.exists());

        // The old file stays: it may belong to an older second file.
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

    fn write(staged: &mut Staged, place: &Path, bytes: &[u8]) {
        staged.write(place, |file| file.write_all(bytes)).expect("a file");
    }

    #[test]
    fn files_are_placed_together_or_none_is() {
        let folder = tempfile::tempdir().expect("a folder");
        let [old, new, twice] = ["old", "a/b/new", "a/twice"].map(|name| folder.path().join(name));
        fs::write(&old, "old").expect("a file");
        for is_placed in [false, true] {
            let mut staged = Staged::default();
            assert!(staged.is_empty());
            write(&mut staged, &old, b"1");
            write(&mut staged, &new, b"2");
            write(&mut staged, &twice, b"first");
            write(&mut staged, &twice, b"3");
            assert_eq!(fs::read(staged.path_of(&twice).expect("staged")).expect("a file"), b"3");
            assert_eq!(fs::read(&old).expect("the file"), b"old");
            assert!(!new.exists() && !twice.exists());
            let failed: io::Result<()> = staged.write(&old, |_| Err(io::ErrorKind::StorageFull.into()));
            assert!(failed.is_err() && staged.path_of(&old).is_none());
            write(&mut staged, &old, b"1");
            if !is_placed {
                drop(staged);
                assert_eq!(fs::read_dir(folder.path()).expect("the folder").count(), 1, "folders are deleted too");
                assert_eq!(fs::read(&old).expect("the file"), b"old");
                continue;
            }
            staged.place().expect("all placed");
            assert_eq!([&old, &new, &twice].map(|path| fs::read(path).expect("a file")), [b"1", b"2", b"3"]);
            assert_eq!(fs::read_dir(folder.path().join("a")).expect("the folder").count(), 2, "nothing else is left");
        }
    }

    #[cfg(unix)]
    #[test]
    fn a_folder_that_is_moved_keeps_no_temporary_file() {
        let folder = tempfile::tempdir().expect("a folder");
        let [assets, moved, other] = ["assets", "moved", "other"].map(|name| folder.path().join(name));
        for made in [&assets, &other] {
            fs::create_dir(made).expect("a folder");
        }
        let mut staged = Staged::default();
        for name in ["a", "b"] {
            write(&mut staged, &assets.join(name), b"x");
        }
        fs::rename(&assets, &moved).expect("a folder");
        std::os::unix::fs::symlink(&other, &assets).expect("a link");
        write(&mut staged, &assets.join("c"), b"x");
        assert_eq!((count(&moved), count(&other)), (3, 0), "a file is in another folder");
        staged.truncate(1);
        assert_eq!(count(&moved), 1);
        assert!(staged.place().is_err());
        assert_eq!((count(&moved), count(&other)), (0, 0), "a temporary file is left");
    }

    #[test]
    fn a_place_that_is_taken_is_named_and_nothing_is_left() {
        let folder = tempfile::tempdir().expect("a folder");
        let taken = folder.path().join("taken");
        fs::create_dir(&taken).expect("a folder in the way");
        let mut staged = Staged::default();
        write(&mut staged, &folder.path().join("other"), b"y");
        write(&mut staged, &taken, b"x");
        assert_eq!(staged.place().expect_err("a folder is there").path, taken);
        assert_eq!(fs::read_dir(folder.path()).expect("the folder").count(), 1);
    }
}
