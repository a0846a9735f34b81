//! Files from servers and folders, checked as they arrive.

use std::io::{self, Read, Write};

use super::{ClientError, ServerTokens};
use ltcforge_files::digest::{Digest, Hasher};

/// Maximum size of a table whose size is unknown, unless the user sets another limit.
pub const TABLE_BYTES: u64 = 1 << 30;

/// A file to request from sources.
#[derive(Debug, Clone)]
pub struct Wanted {
    /// The digest of the file.
    pub digest: Digest,
    /// The size of the file, if the lock file states it.
    pub stated_bytes: Option<u64>,
    /// The path of the file on a server.
    pub path: String,
}

impl Wanted {
    /// The canonical file of a table.
    #[must_use]
    pub fn table(digest: Digest, stated_bytes: Option<u64>) -> Self {
        Self { digest, stated_bytes, path: format!("/v1/tables/{digest}") }
    }
}

/// The settings for access to sources.
#[derive(Clone, Copy)]
pub struct Access<'a> {
    /// Maximum size of a file if the lock file does not state its size.
    pub table_bytes: u64,
    /// Whether requests to servers are forbidden.
    pub offline: bool,
    /// The tokens for servers.
    pub tokens: &'a ServerTokens,
    /// Called repeatedly while a file arrives.
    pub should_stop: &'a dyn Fn() -> bool,
}

/// Why no source delivered a file.
#[derive(Debug, thiserror::Error)]
pub enum SourcesError {
    /// No source has the file. The errors are in the order of the sources.
    #[error("{}", list(.0))]
    NoneHasIt(Vec<ClientError>),
    /// The file could not be written.
    #[error(transparent)]
    Write(#[from] io::Error),
    /// The user stopped the download.
    #[error("the download was stopped")]
    Stopped,
}

impl From<ClientError> for SourcesError {
    fn from(error: ClientError) -> Self {
        Self::NoneHasIt(vec![error])
    }
}

fn list(errors: &[ClientError]) -> String {
    if errors.is_empty() {
        return "there is no source for the file".to_owned();
    }
    errors.iter().map(ToString::to_string).collect::<Vec<_>>().join("; ")
}

/// Copies the wanted file from a reader at `place` to `sink`, and checks its size and hash. `failed` turns a read error
/// into a `ClientError`.
///
/// # Errors
/// After an error, the bytes in `sink` must not be used.
pub(super) fn copy(
    (place, mut from): (&str, impl Read),
    Wanted { digest: expected, stated_bytes, .. }: &Wanted,
    access: &Access<'_>,
    failed: impl Fn(io::Error) -> ClientError,
    sink: &mut dyn Write,
) -> Result<(), SourcesError> {
    let url = place.to_owned();
    let limit_bytes = stated_bytes.unwrap_or(access.table_bytes);
    let (mut hasher, mut bytes, mut chunk) = (Hasher::default(), 0, vec![0; 1 << 16]);
    loop {
        if (access.should_stop)() {
            return Err(SourcesError::Stopped);
        }
        let read = match from.read(&mut chunk) {
            Ok(0) => break,
            Ok(read) => read,
            Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
            Err(error) => return Err(failed(error).into()),
        };
        bytes += read as u64;
        if bytes > limit_bytes {
            return Err(match stated_bytes {
                Some(stated_bytes) => ClientError::LongerThanStated { url, stated_bytes: *stated_bytes },
                None => ClientError::TooLong { url, limit_bytes },
            }
            .into());
        }
        hasher.update(&chunk[..read]);
        sink.write_all(&chunk[..read])?;
    }
    let actual = hasher.digest();
    match *stated_bytes {
        Some(stated_bytes) if bytes < stated_bytes => Err(ClientError::TooShort { url, bytes, stated_bytes }.into()),
        _ if actual != *expected => Err(ClientError::Mismatch { url, expected: *expected, actual }.into()),
        _ => Ok(()),
    }
}
