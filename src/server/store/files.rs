//! The store's files and folders, and its quarantine.

use std::{
    fs,
    io::{self, Read as _},
    os::unix::fs::OpenOptionsExt as _,
    path::{Path, PathBuf},
};

use rustix::fs::OFlags;

use super::StoreError;
use ltcforge_files::replace::sync_folder;

/// Creates `folder` and its parents durably.
///
/// # Errors
/// When the path is not a folder, or the folder cannot be created.
pub(super) fn make_folder(folder: &Path) -> Result<(), StoreError> {
    let make = || {
        if !folder.is_dir() {
            fs::create_dir_all(folder)?;
            folder.parent().filter(|parent| !parent.as_os_str().is_empty()).map_or(Ok(()), sync_folder)?;
        }
        Ok(())
    };
    make().map_err(|source| StoreError::of_io(folder, source))
}

/// Moves `path` into `quarantine` under a free name `<stem>-<n>`. Returns the new path.
///
/// # Errors
/// When the move fails.
pub(super) fn move_to_quarantine(path: &Path, quarantine: &Path, stem: &str) -> Result<PathBuf, StoreError> {
    make_folder(quarantine)?;
    let mut names = (1..=u32::MAX).map(|n| quarantine.join(format!("{stem}-{n}")));
    let free = names.find(|name| name.symlink_metadata().is_err());
    let target = free.ok_or_else(|| StoreError::of_io(quarantine, io::ErrorKind::AlreadyExists.into()))?;
    fs::rename(path, &target)
        .and_then(|()| sync_folder(quarantine))
        .and_then(|()| path.parent().map_or(Ok(()), sync_folder))
        .map_err(|source| StoreError::of_io(path, source))?;
    Ok(target)
}

/// The metadata of a regular file. For anything else, the error is [`io::ErrorKind::InvalidData`].
pub(super) fn regular_metadata(path: &Path) -> io::Result<fs::Metadata> {
    let metadata = path.symlink_metadata()?;
    if !metadata.is_file() {
        return Err(io::Error::new(io::ErrorKind::InvalidData, "not a regular file"));
    }
    Ok(metadata)
}

/// The bytes of a regular file. Nothing else is read, because a FIFO may block forever, and a device may be endless.
pub(super) fn read_regular(path: &Path) -> io::Result<Vec<u8>> {
    regular_metadata(path)?;
    // The flags protect against a program that replaces the file after the check.
    let flags = (OFlags::NOFOLLOW | OFlags::NONBLOCK).bits().cast_signed();
    let mut bytes = Vec::new();
    fs::File::options().read(true).custom_flags(flags).open(path)?.read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// Free bytes on the file system of `folder`.
pub(super) fn free_bytes(folder: &Path) -> io::Result<u64> {
    let disk = rustix::fs::statvfs(folder)?;
    Ok(disk.f_bavail.saturating_mul(disk.f_frsize))
}
