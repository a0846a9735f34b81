//! Files that are put in their places together.

use std::{
    fs::{self, File},
    io,
    path::{Path, PathBuf},
};

use super::replace::{PairError, folder_of, temporary_file};

/// Files that were written beside their places, and stand in none of them yet. What is not placed is removed again, with the
/// folders that were made for it.
#[derive(Debug, Default)]
pub struct Staged {
    files: Vec<StagedFile>,
    /// In the order in which they were made.
    folders: Vec<PathBuf>,
}

#[derive(Debug)]
struct StagedFile {
    temporary: PathBuf,
    place: PathBuf,
}

impl Staged {
    /// Has `write` fill a temporary file for `place`, in that folder, which is made if it is missing. A file that was staged
    /// for this place before is dropped.
    ///
    /// # Errors
    /// That of `write`, or the system's; then nothing is staged for this place.
    pub fn write<T, E: From<io::Error>>(
        &mut self,
        place: &Path,
        write: impl FnOnce(&mut File) -> Result<T, E>,
    ) -> Result<T, E> {
        self.drop_file(place);
        if place.file_name().is_none() {
            return Err(io::Error::new(io::ErrorKind::InvalidInput, "the path names no file").into());
        }
        let folder = folder_of(place);
        self.make_folder(folder)?;
        let (mut file, temporary) = temporary_file(folder)?;
        // From here on it is removed when this is dropped.
        self.files.push(StagedFile { temporary, place: place.to_owned() });
        let written = write(&mut file).and_then(|written| Ok(file.sync_all().map(|()| written)?));
        if written.is_err() {
            self.drop_file(place);
        }
        written
    }

    /// Where the file for `place` is now, if it was staged.
    #[must_use]
    pub fn path_of(&self, place: &Path) -> Option<&Path> {
        self.files.iter().find(|file| file.place == place).map(|file| file.temporary.as_path())
    }

    /// Whether nothing is staged.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.files.is_empty()
    }

    /// Puts every file in its place. Each place has the old file or the new one at any time, never a part; a crash in between
    /// leaves new files in some places and old ones in others. The file that was staged last is placed first.
    ///
    /// # Errors
    /// The first file that cannot be placed; those placed before it stand, the others are dropped.
    pub fn place(mut self) -> Result<(), PairError> {
        // What is still listed is removed when this is dropped.
        while let Some(StagedFile { temporary, place }) = self.files.pop() {
            let placed = fs::rename(&temporary, &place).and_then(|()| File::open(folder_of(&place))?.sync_all());
            if let Err(source) = placed {
                // The first error is the one to report.
                let _ = fs::remove_file(&temporary);
                return Err(PairError { path: place, source });
            }
        }
        Ok(())
    }

    fn drop_file(&mut self, place: &Path) {
        self.files.retain(|file| {
            let is_other = file.place != place;
            if !is_other {
                // A file that cannot be removed is no reason to fail: its name tells that it may be deleted.
                let _ = fs::remove_file(&file.temporary);
            }
            is_other
        });
    }

    /// Makes a folder and those that it lies in, and remembers which were missing.
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
        for StagedFile { temporary, .. } in &self.files {
            // As in `drop_file`.
            let _ = fs::remove_file(temporary);
        }
        for folder in self.folders.iter().rev() {
            // A folder that has files stays.
            let _ = fs::remove_dir(folder);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::io::Write as _;

    use super::*;

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
                assert_eq!(fs::read_dir(folder.path()).expect("the folder").count(), 1, "folders go too");
                assert_eq!(fs::read(&old).expect("the file"), b"old");
                continue;
            }
            staged.place().expect("all placed");
            assert_eq!([&old, &new, &twice].map(|path| fs::read(path).expect("a file")), [b"1", b"2", b"3"]);
            assert_eq!(fs::read_dir(folder.path().join("a")).expect("the folder").count(), 2, "nothing else is left");
        }
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
