//! The errors of the store.

use std::{io, path::PathBuf};

use super::Tree;
use ltcforge_files::digest::Digest;

/// Why the store could not read or write.
#[derive(Debug, thiserror::Error)]
pub enum StoreError {
    /// The disk is full, or the quota is used up. Nothing was stored.
    #[error("the disk is full")]
    DiskFull,
    /// A blob's bytes do not have its digest; it was moved to quarantine.
    #[error("the blob {expected} is damaged (its bytes hash to {actual}); it was moved to {}", .moved_to.display())]
    Corrupt {
        /// The digest that was requested.
        expected: Digest,
        /// The digest of the bytes found.
        actual: Digest,
        /// Where the damaged file is now.
        moved_to: PathBuf,
    },
    /// A store elsewhere has other bytes under the name of a blob, or gave other ones.
    #[error("the object store gives other bytes for {0} than were stored")]
    OtherBytes(Digest),
    /// A row's value does not match the hash stored with it.
    #[error("a row of {} is damaged (key {key:02x?})", .tree.name())]
    DamagedRow {
        /// The tree.
        tree: Tree,
        /// The row's key.
        key: Vec<u8>,
    },
    /// A file could not be read or written.
    #[error("{}: {source}", .path.display())]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// The system's error.
        source: io::Error,
    },
    /// The database failed.
    #[error("database: {0}")]
    Database(String),
    /// The database or the store of blobs refuses the credentials.
    #[error("the storage refuses: {0}")]
    Refused(String),
    /// The database or the store of blobs does not answer, or not now.
    #[error("the storage cannot be reached: {0}")]
    Unavailable(String),
}

impl StoreError {
    /// The error of an operation on `path`, or [`Self::DiskFull`].
    pub(crate) fn of_io(path: impl Into<PathBuf>, source: io::Error) -> Self {
        if is_full(source.kind()) { Self::DiskFull } else { Self::Io { path: path.into(), source } }
    }

    /// The error of a database operation, or [`Self::DiskFull`].
    pub(super) fn of_sled(error: &sled::Error) -> Self {
        match error {
            sled::Error::Io(source) if is_full(source.kind()) => Self::DiskFull,
            sled::Error::Io(source) if is_passing(source) => {
                let code = source.raw_os_error().unwrap_or_default();
                Self::Io { path: "the database".into(), source: io::Error::from_raw_os_error(code) }
            }
            other => Self::Database(other.to_string()),
        }
    }
}

impl StoreError {
    /// Whether the process or the machine lacked something for a moment, such as a free descriptor, a connection or room on
    /// the disk: the same operation may succeed later.
    #[must_use]
    pub fn is_passing(&self) -> bool {
        match self {
            Self::Io { source, .. } => is_passing(source),
            Self::Unavailable(_) | Self::OtherBytes(_) | Self::DiskFull => true,
            _ => false,
        }
    }
}

fn is_passing(source: &io::Error) -> bool {
    use rustix::io::Errno;
    let passing = [Errno::MFILE, Errno::NFILE, Errno::NOMEM, Errno::AGAIN, Errno::INTR].map(Errno::raw_os_error);
    source.raw_os_error().is_some_and(|code| passing.contains(&code))
}

/// Whether this kind of error means that the disk is full.
pub(super) fn is_full(kind: io::ErrorKind) -> bool {
    matches!(kind, io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded | io::ErrorKind::FileTooLarge)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lack_of_descriptors_or_room_passes_and_a_refused_permission_does_not() {
        let of = |code| StoreError::of_io("x", io::Error::from_raw_os_error(code)).is_passing();
        assert!(of(rustix::io::Errno::MFILE.raw_os_error()));
        assert!(!of(rustix::io::Errno::ACCESS.raw_os_error()));
        let of_sled = |code| StoreError::of_sled(&sled::Error::Io(io::Error::from_raw_os_error(code)));
        assert!(of_sled(rustix::io::Errno::MFILE.raw_os_error()).is_passing());
        assert!(StoreError::DiskFull.is_passing());
    }

    #[test]
    fn a_full_disk_is_distinguished_from_other_errors() {
        for kind in [io::ErrorKind::StorageFull, io::ErrorKind::QuotaExceeded] {
            assert!(matches!(StoreError::of_io("x", kind.into()), StoreError::DiskFull));
            assert!(matches!(StoreError::of_sled(&sled::Error::Io(kind.into())), StoreError::DiskFull));
        }
        let denied = StoreError::of_io("x", io::ErrorKind::PermissionDenied.into());
        assert!(matches!(denied, StoreError::Io { .. }));
    }
}
