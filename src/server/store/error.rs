//! The errors of the store.

use std::{io, path::PathBuf};

use rustix::io::Errno;

use super::Tree;
use ltcforge_files::digest::Digest;

/// Why a data folder could not be opened.
#[derive(Debug, thiserror::Error)]
pub enum OpenError {
    /// Another process uses the folder.
    #[error("in use by another process")]
    Locked,
    /// The folder cannot be created, read or written.
    #[error(transparent)]
    Unusable(io::Error),
    /// The disk is full.
    #[error("the disk is full")]
    Full,
    /// The files of the database are damaged, or an unreleased version wrote them.
    #[error("{0}")]
    Damaged(String),
    /// A later version of the program wrote the database.
    #[error("the database has schema {found}, but this program knows schemas up to {known}; use a newer ltcforge")]
    FromTheFuture {
        /// The schema of the database.
        found: u32,
        /// The newest schema that this program knows.
        known: u32,
    },
}

impl From<StoreError> for OpenError {
    fn from(error: StoreError) -> Self {
        match error {
            StoreError::Io { source, .. } => Self::Unusable(source),
            StoreError::DiskFull => Self::Full,
            other => Self::Unusable(io::Error::other(other)),
        }
    }
}

impl From<sled::Error> for OpenError {
    fn from(error: sled::Error) -> Self {
        match error {
            sled::Error::Io(source) => source.into(),
            other => Self::Damaged(other.to_string()),
        }
    }
}

impl From<io::Error> for OpenError {
    fn from(source: io::Error) -> Self {
        match source.kind() {
            kind if is_full(kind) => Self::Full,
            // Truncated files cause these two kinds. Other I/O errors do not mean damage.
            io::ErrorKind::UnexpectedEof | io::ErrorKind::InvalidData => Self::Damaged(source.to_string()),
            _ => Self::Unusable(source),
        }
    }
}

/// Why the database or the object store of a cluster could not be opened. The message contains place, reason and
/// remedy.
#[cfg(feature = "cluster")]
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct ConnectError(pub(super) String);

/// Why a read or write of the store failed.
#[derive(Debug, thiserror::Error)]
pub enum StoreError {
    /// The disk or the quota is full. Nothing was stored.
    #[error("the disk is full")]
    DiskFull,
    /// The bytes of a blob do not match its digest. The blob was moved to quarantine.
    #[error("the blob {expected} is damaged (its bytes hash to {actual}); it was moved to {}", .moved_to.display())]
    Corrupt {
        /// The digest that was requested.
        expected: Digest,
        /// The digest of the bytes found.
        actual: Digest,
        /// Where the damaged file is now.
        moved_to: PathBuf,
    },
    /// The object store returns damaged bytes.
    #[error("the object store returns damaged bytes for {0}")]
    OtherBytes(Digest),
    /// The value of a row does not match its hash.
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
    /// The database or the object store refuses the credentials.
    #[error("the storage refuses the request: {0}")]
    Refused(String),
    /// The database or the object store cannot be reached.
    #[error("the storage cannot be reached: {0}")]
    Unavailable(String),
}

impl StoreError {
    /// The error of an operation on `path`, or [`Self::DiskFull`].
    pub(crate) fn of_io(path: impl Into<PathBuf>, source: io::Error) -> Self {
        if is_full(source.kind()) { Self::DiskFull } else { Self::Io { path: path.into(), source } }
    }

    /// Whether the error is temporary, such as a lack of file descriptors, connections or disk space. If it is, the
    /// operation may succeed later.
    #[must_use]
    pub fn is_passing(&self) -> bool {
        const PASSING: [Errno; 5] = [Errno::MFILE, Errno::NFILE, Errno::NOMEM, Errno::AGAIN, Errno::INTR];
        match self {
            Self::Io { source, .. } => PASSING.iter().any(|code| source.raw_os_error() == Some(code.raw_os_error())),
            Self::Unavailable(_) | Self::OtherBytes(_) | Self::DiskFull => true,
            _ => false,
        }
    }
}

/// Whether this kind of error means that the disk is full.
pub(super) fn is_full(kind: io::ErrorKind) -> bool {
    matches!(kind, io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded | io::ErrorKind::FileTooLarge)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_full_disk_and_a_lack_of_descriptors_pass_and_a_refused_permission_does_not() {
        let of = |code: Errno| StoreError::of_io("x", io::Error::from_raw_os_error(code.raw_os_error()));
        assert!(of(Errno::MFILE).is_passing());
        assert!(!of(Errno::ACCESS).is_passing());
        for full in [Errno::NOSPC, Errno::DQUOT] {
            assert!(matches!(of(full), StoreError::DiskFull));
            assert!(of(full).is_passing());
        }
    }
}
