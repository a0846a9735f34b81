//! Files that are written completely or not at all.

use std::{
    fs::{self, File, OpenOptions},
    io::{self, Write as _},
    path::{Path, PathBuf},
};

/// Writes `bytes` to `path` and creates its folder if it is missing. After a crash, on a full disk, and for concurrent
/// readers, `path` has the old file or the new one, never a part.
///
/// # Errors
/// When the folder cannot be created or the file cannot be written; no temporary file is left then.
pub fn replace_file(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let Some(name) = path.file_name() else {
        return Err(io::Error::new(io::ErrorKind::InvalidInput, "the path names no file"));
    };
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    fs::create_dir_all(folder)?;
    let temporary: PathBuf = folder.join(format!(".{}.{}.part", name.to_string_lossy(), std::process::id()));
    let placed = write_through(&temporary, bytes).and_then(|()| fs::rename(&temporary, path));
    if placed.is_err() {
        // The file may not exist; the first error is the one to report.
        let _ = fs::remove_file(&temporary);
    }
    placed?;
    File::open(folder)?.sync_all()
}

fn write_through(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut file = OpenOptions::new().write(true).create(true).truncate(true).open(path)?;
    file.write_all(bytes)?;
    file.sync_all()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_replaced_and_its_folder_made() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a/b/table");
        replace_file(&path, b"one").expect("a new file");
        replace_file(&path, b"two").expect("a replaced file");
        assert_eq!(fs::read(&path).expect("the file"), b"two");
        assert_eq!(fs::read_dir(folder.path().join("a/b")).expect("the folder").count(), 1, "nothing else is left");
    }

    #[test]
    fn a_failure_leaves_nothing_behind() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("table");
        fs::create_dir(&path).expect("a folder in the way");
        assert!(replace_file(&path, b"x").is_err());
        assert_eq!(fs::read_dir(folder.path()).expect("the folder").count(), 1);
    }
}
