//! Downloading the pinned tables that are missing or differ.

use std::{
    fs, io,
    path::{Path, PathBuf},
};

use super::{Client, ClientError, Pin, replace_file};
use crate::files::digest::Digest;

/// The state of a pinned file on the disk.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PinState {
    /// It has the pinned bytes.
    Right,
    /// There is no file.
    Missing,
    /// It has other bytes.
    Different {
        /// Their digest.
        actual: Digest,
    },
}

/// Why a table was not pulled.
#[derive(Debug, thiserror::Error)]
pub enum PullError {
    /// It could not be downloaded.
    #[error(transparent)]
    Client(#[from] ClientError),
    /// It could not be read or written.
    #[error("{}: {source}", .path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// The system's error.
        source: io::Error,
    },
}

/// The state of the file of `pin` below `folder`. Writes nothing.
///
/// # Errors
/// When the file is there and cannot be read.
pub fn check(pin: &Pin, folder: &Path) -> Result<PinState, PullError> {
    let path = folder.join(&pin.path);
    match fs::read(&path) {
        Ok(bytes) => {
            let actual = Digest::of(&bytes);
            Ok(if actual == pin.digest { PinState::Right } else { PinState::Different { actual } })
        }
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(PinState::Missing),
        Err(source) => Err(PullError::File { path, source }),
    }
}

/// Downloads the table of `pin` to its path below `folder`, unless it is there. Returns the state before.
///
/// # Errors
/// When the pinned bytes cannot be downloaded or written; the old file then stays.
pub fn pull(pin: &Pin, folder: &Path, client: &Client) -> Result<PinState, PullError> {
    let before = check(pin, folder)?;
    if before != PinState::Right {
        let bytes = client.table(pin.digest)?;
        let path = folder.join(&pin.path);
        replace_file(&path, &bytes).map_err(|source| PullError::File { path, source })?;
    }
    Ok(before)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_state_of_a_pin_is_that_of_its_bytes() {
        let folder = tempfile::tempdir().expect("a folder");
        let pin = Pin { name: "a".into(), digest: Digest::of(b"right"), path: "sub/a".into(), server: None };
        let state = || check(&pin, folder.path()).expect("a readable file");
        assert_eq!(state(), PinState::Missing);
        replace_file(&folder.path().join("sub/a"), b"wrong").expect("a file");
        assert_eq!(state(), PinState::Different { actual: Digest::of(b"wrong") });
        replace_file(&folder.path().join("sub/a"), b"right").expect("a file");
        assert_eq!(state(), PinState::Right);
    }

    #[test]
    fn a_right_file_is_neither_downloaded_nor_touched() {
        let folder = tempfile::tempdir().expect("a folder");
        let pin = Pin { name: "a".into(), digest: Digest::of(b"right"), path: "a".into(), server: None };
        let path = folder.path().join("a");
        replace_file(&path, b"right").expect("a file");
        let modified = || fs::metadata(&path).and_then(|data| data.modified()).expect("a time");
        let before = modified();
        // Nothing answers on port 9, so a request would fail.
        let client = Client::new("http://127.0.0.1:9").expect("a URL");
        assert_eq!(pull(&pin, folder.path(), &client).expect("nothing to do"), PinState::Right);
        assert_eq!(modified(), before);
    }
}
