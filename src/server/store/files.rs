//! The store's files and folders, and its quarantine.

use std::{
    fs,
    io::{self, Read as _, Seek as _},
    os::unix::fs::OpenOptionsExt as _,
    path::{Path, PathBuf},
};

use rustix::fs::OFlags;

use super::StoreError;
use ltcforge_files::digest::{Digest, Hasher};
pub(super) use ltcforge_files::replace::sync_folder;
use ltcforge_files::replace::{TEMPORARY_PREFIX, replace_file};

/// Writes `bytes` to `path` so that a power cut leaves all of them or none.
///
/// # Errors
/// When the disk is full or a system call fails; no temporary file is left then.
pub(super) fn write_durably(path: &Path, bytes: &[u8]) -> Result<(), StoreError> {
    replace_file(path, bytes).map_err(|source| StoreError::of_io(path, source))
}

/// Whether a file has the name of one that was being written when the process ended. Older versions began it otherwise.
pub(super) fn is_temporary(name: &str) -> bool {
    name.starts_with(TEMPORARY_PREFIX) || name.starts_with(".tmp-")
}

/// Creates `folder` and its parents, with durable names.
///
/// # Errors
/// When it is not a folder or cannot be created.
pub(super) fn make_folder(folder: &Path) -> Result<(), StoreError> {
    let made = (|| {
        if !folder.is_dir() {
            fs::create_dir_all(folder)?;
            folder.parent().filter(|parent| !parent.as_os_str().is_empty()).map_or(Ok(()), sync_folder)?;
        }
        Ok(())
    })();
    made.map_err(|source| StoreError::of_io(folder, source))
}

/// Moves `path` into `quarantine` under a free name `<stem>-<n>`. Returns where it is now.
///
/// # Errors
/// When it cannot be moved.
pub(super) fn move_to_quarantine(path: &Path, quarantine: &Path, stem: &str) -> Result<PathBuf, StoreError> {
    let target = free_name(quarantine, stem)?;
    fs::rename(path, &target)
        .and_then(|()| sync_folder(quarantine))
        .and_then(|()| path.parent().map_or(Ok(()), sync_folder))
        .map_err(|source| StoreError::of_io(path, source))?;
    Ok(target)
}

/// Copies the file or folder `from` into `quarantine` under a free name `<stem>-<n>`. Returns where the copy is.
///
/// # Errors
/// When it cannot be copied; no part of a copy is left then.
pub(super) fn copy_to_quarantine(from: &Path, quarantine: &Path, stem: &str) -> Result<PathBuf, StoreError> {
    let target = free_name(quarantine, stem)?;
    let copied = if from.is_dir() { copy_folder(from, &target) } else { fs::copy(from, &target).map(drop) };
    copied.and_then(|()| sync_folder(quarantine)).map_err(|source| {
        // The first error is reported.
        let _ = if target.is_dir() { fs::remove_dir_all(&target) } else { fs::remove_file(&target) };
        StoreError::of_io(from, source)
    })?;
    Ok(target)
}

/// Writes `bytes`, which are about to be lost, into `quarantine` under a free name `<stem>-<n>`. Returns where they are.
///
/// # Errors
/// When they cannot be written.
pub(super) fn keep_in_quarantine(bytes: &[u8], quarantine: &Path, stem: &str) -> Result<PathBuf, StoreError> {
    let target = free_name(quarantine, stem)?;
    write_durably(&target, bytes)?;
    Ok(target)
}

fn free_name(quarantine: &Path, stem: &str) -> Result<PathBuf, StoreError> {
    make_folder(quarantine)?;
    let mut names = (1..=u32::MAX).map(|n| quarantine.join(format!("{stem}-{n}")));
    let free = names.find(|name| !name.exists());
    free.ok_or_else(|| StoreError::of_io(quarantine, io::ErrorKind::AlreadyExists.into()))
}

/// The bytes of a regular file. Anything else is not opened and is [`io::ErrorKind::InvalidData`]: reading a FIFO may
/// wait for ever, and a device or what a link leads to may have no end.
pub(super) fn read_regular(path: &Path) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    open_regular(path)?.read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// At most `length` bytes of a regular file, from the byte `from` on.
pub(super) fn read_part(path: &Path, from: u64, length: usize) -> io::Result<Vec<u8>> {
    let mut file = open_regular(path)?;
    file.seek(io::SeekFrom::Start(from))?;
    let mut bytes = Vec::with_capacity(length);
    file.take(length as u64).read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// Refuses what stands in the place of a file and is none, or leads to none: opening a FIFO may wait for ever.
pub(super) fn refuse_irregular(path: &Path) -> io::Result<()> {
    match fs::metadata(path) {
        Ok(found) if !found.is_file() => Err(io::Error::other(format!("{} is not a regular file", path.display()))),
        _ => Ok(()),
    }
}

/// The length of a regular file.
pub(super) fn regular_length(path: &Path) -> io::Result<u64> {
    regular_metadata(path).map(|metadata| metadata.len())
}

/// What the system tells of a regular file.
pub(super) fn regular_metadata(path: &Path) -> io::Result<fs::Metadata> {
    let metadata = path.symlink_metadata()?;
    if !metadata.is_file() {
        return Err(io::Error::new(io::ErrorKind::InvalidData, "it is not a regular file"));
    }
    Ok(metadata)
}

/// The digest of a file as the disk has it, and not the system's copy in memory, where it can be told so; `None` if
/// `go_on`, which gets the bytes of each part, says no.
pub(super) fn digest_from_disk(mut file: fs::File, go_on: &mut dyn FnMut(usize) -> bool) -> io::Result<Option<Digest>> {
    // Advice, which a file system may ignore.
    #[cfg(target_os = "linux")]
    let _ = rustix::fs::fadvise(&file, 0, None, rustix::fs::Advice::DontNeed);
    let (mut hasher, mut part) = (Hasher::default(), vec![0; 1 << 18]);
    loop {
        match file.read(&mut part) {
            Ok(0) => return Ok(Some(hasher.digest())),
            Ok(read) => {
                hasher.update(&part[..read]);
                if !go_on(read) {
                    return Ok(None);
                }
            }
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
}

/// A regular file, opened to be read.
pub(super) fn open_regular(path: &Path) -> io::Result<fs::File> {
    regular_length(path)?;
    // It may have been replaced since.
    let flags = (OFlags::NOFOLLOW | OFlags::NONBLOCK).bits().cast_signed();
    fs::File::options().read(true).custom_flags(flags).open(path)
}

/// Copies a folder with its contents, without what is neither a folder nor a regular file.
pub(crate) fn copy_folder(from: &Path, to: &Path) -> io::Result<()> {
    copy_folder_by(from, to, &|from, to| fs::copy(from, to).map(drop))
}

/// As [`copy_folder`]; `copy` copies a file.
pub(super) fn copy_folder_by(from: &Path, to: &Path, copy: &dyn Fn(&Path, &Path) -> io::Result<()>) -> io::Result<()> {
    fs::create_dir_all(to)?;
    for entry in fs::read_dir(from)? {
        let entry = entry?;
        let (path, target) = (entry.path(), to.join(entry.file_name()));
        match entry.file_type()? {
            kind if kind.is_dir() => copy_folder_by(&path, &target, copy)?,
            kind if kind.is_file() => copy(&path, &target)?,
            _ => {}
        }
    }
    Ok(())
}

/// Bytes that may still be written below `folder`.
pub(super) fn free_bytes(folder: &Path) -> io::Result<u64> {
    let disk = rustix::fs::statvfs(folder)?;
    Ok(disk.f_bavail.saturating_mul(disk.f_frsize))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn writes_replace_and_leave_no_temporary_file() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("file");
        write_durably(&path, b"one").unwrap();
        write_durably(&path, b"two").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"two");
        assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 1);
    }

    #[test]
    fn a_failed_write_leaves_nothing_behind() {
        let dir = tempfile::tempdir().unwrap();
        // A folder of that name makes the rename fail.
        let path = dir.path().join("taken");
        fs::create_dir(&path).unwrap();
        assert!(matches!(write_durably(&path, b"x"), Err(StoreError::Io { .. })));
        assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 1);
    }

    #[test]
    fn moving_to_quarantine_never_overwrites() {
        let dir = tempfile::tempdir().unwrap();
        let quarantine = dir.path().join("quarantine");
        for n in 1..=2 {
            let path = dir.path().join("bad");
            fs::write(&path, format!("{n}")).unwrap();
            let target = move_to_quarantine(&path, &quarantine, "bad").unwrap();
            assert_eq!(target, quarantine.join(format!("bad-{n}")));
        }
        assert_eq!(fs::read(quarantine.join("bad-1")).unwrap(), b"1");
    }
}
