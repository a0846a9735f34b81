//! Downloading the pinned tables that are missing or differ.

use std::{
    fs::File,
    io,
    path::{Path, PathBuf},
};

use super::{Client, ClientError, DownloadError, Pin};
use crate::files::{digest::Digest, replace::replace_file_with};

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
    /// The user stopped it.
    #[error("the download was stopped")]
    Stopped,
}

/// The state of the file of `pin` below `folder`. Writes nothing, and keeps no more than a part of the file in memory.
///
/// # Errors
/// When something is there that cannot be read or is no regular file.
pub fn check(pin: &Pin, folder: &Path) -> Result<PinState, PullError> {
    let path = folder.join(&pin.path);
    match digest_of_file(&path) {
        Ok(actual) => Ok(if actual == pin.digest { PinState::Right } else { PinState::Different { actual } }),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(PinState::Missing),
        Err(source) => Err(PullError::File { path, source }),
    }
}

fn digest_of_file(path: &Path) -> io::Result<Digest> {
    // Others, such as pipes and devices, may have no end; opening a pipe may even wait.
    if !path.metadata()?.is_file() {
        return Err(io::Error::new(io::ErrorKind::InvalidInput, "this is no regular file"));
    }
    Digest::of_stream(File::open(path)?)
}

/// Downloads the table of `pin` to its path below `folder`, unless it is there. Returns the state before.
/// `should_stop` is asked again and again during the download.
///
/// # Errors
/// When the pinned bytes cannot be downloaded or written; the old file then stays, and nothing else is left.
pub fn pull(pin: &Pin, folder: &Path, client: &Client, should_stop: &dyn Fn() -> bool) -> Result<PinState, PullError> {
    let before = check(pin, folder)?;
    if before != PinState::Right {
        let path = folder.join(&pin.path);
        let download = client.table(pin.digest)?;
        let replaced = replace_file_with(&path, |file| download.write_to(pin.bytes, should_stop, file));
        replaced.map_err(|error| match error {
            DownloadError::Client(error) => PullError::Client(error),
            DownloadError::Write(source) => PullError::File { path, source },
            DownloadError::Stopped => PullError::Stopped,
        })?;
    }
    Ok(before)
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;
    use crate::files::replace::replace_file;

    #[test]
    fn the_state_of_a_pin_is_that_of_its_bytes() {
        let folder = tempfile::tempdir().expect("a folder");
        let pin =
            Pin { name: "a".into(), digest: Digest::of(b"right"), path: "sub/a".into(), bytes: None, server: None };
        let state = || check(&pin, folder.path()).expect("a readable file");
        assert_eq!(state(), PinState::Missing);
        replace_file(&folder.path().join("sub/a"), b"wrong").expect("a file");
        assert_eq!(state(), PinState::Different { actual: Digest::of(b"wrong") });
        replace_file(&folder.path().join("sub/a"), b"right").expect("a file");
        assert_eq!(state(), PinState::Right);
        let endless = Pin { path: "/dev/zero".into(), ..pin.clone() };
        assert!(check(&endless, folder.path()).is_err());
    }

    #[test]
    fn a_right_file_is_neither_downloaded_nor_touched() {
        let folder = tempfile::tempdir().expect("a folder");
        let pin = Pin { name: "a".into(), digest: Digest::of(b"right"), path: "a".into(), bytes: None, server: None };
        let path = folder.path().join("a");
        replace_file(&path, b"right").expect("a file");
        let modified = || fs::metadata(&path).and_then(|data| data.modified()).expect("a time");
        let before = modified();
        // Nothing answers on port 9, so a request would fail.
        let client = Client::new("http://127.0.0.1:9").expect("a URL");
        assert_eq!(pull(&pin, folder.path(), &client, &|| false).expect("nothing to do"), PinState::Right);
        assert_eq!(modified(), before);
    }
}
