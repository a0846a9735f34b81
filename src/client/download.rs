//! The download of a table from a server.

use std::io::{self, Write};

use ureq::{Body, http::Response};

use super::{
    ClientError, Limits,
    answer::{self, CopyError, SizeLimit},
    limits::SizeOrigin,
};
use ltcforge_files::digest::{Digest, Hasher};

/// The answer to a request for a table. Its body is not read yet.
#[derive(Debug)]
pub struct Download {
    url: String,
    response: Response<Body>,
    digest: Digest,
    limits: Limits,
}

/// The reason that a table was not downloaded.
#[derive(Debug, thiserror::Error)]
pub enum DownloadError {
    /// The server's answer is not the table.
    #[error(transparent)]
    Client(#[from] ClientError),
    /// The table could not be written.
    #[error(transparent)]
    Write(#[from] io::Error),
    /// The user stopped the download.
    #[error("the download was stopped")]
    Stopped,
}

impl Download {
    pub(super) fn new(url: String, response: Response<Body>, digest: Digest, limits: Limits) -> Self {
        Self { url, response, digest, limits }
    }

    /// Writes the table to `sink` as it arrives, and checks its hash. Its length must be `stated_bytes`, which comes
    /// from the lock file, or else within the limit of the client. `should_stop` is called after each part.
    ///
    /// # Errors
    /// See [`DownloadError`]. The bytes that are in `sink` by then must not be used.
    pub fn write_to(
        self,
        stated_bytes: Option<u64>,
        should_stop: &dyn Fn() -> bool,
        sink: &mut dyn Write,
    ) -> Result<(), DownloadError> {
        let Self { url, response, digest: expected, limits } = self;
        let size = size_limit(stated_bytes, limits);
        let mut sink = HashingWriter::new(sink);
        answer::copy(&url, response, (size, limits.table_time, limits), should_stop, &mut sink)?;
        let actual = sink.digest();
        if actual == expected { Ok(()) } else { Err(ClientError::Mismatch { url, expected, actual }.into()) }
    }
}

impl From<CopyError> for DownloadError {
    fn from(error: CopyError) -> Self {
        match error {
            CopyError::Client(error) => Self::Client(error),
            CopyError::Write(error) => Self::Write(error),
            CopyError::Stopped => Self::Stopped,
        }
    }
}

/// The length of a table: the one that the lock file states, or else at most the limit for tables.
pub(super) fn size_limit(stated_bytes: Option<u64>, limits: Limits) -> SizeLimit {
    match stated_bytes {
        Some(bytes) => SizeLimit { bytes, origin: SizeOrigin::LockFile },
        None => SizeLimit { bytes: limits.table_bytes, origin: SizeOrigin::Tables },
    }
}

/// A writer that hashes all bytes that it passes on.
pub(super) struct HashingWriter<'a> {
    sink: &'a mut dyn Write,
    hasher: Hasher,
}

impl<'a> HashingWriter<'a> {
    /// A writer that passes bytes on to `sink`.
    pub(super) fn new(sink: &'a mut dyn Write) -> Self {
        Self { sink, hasher: Hasher::default() }
    }

    /// The digest of all bytes that were passed on.
    pub(super) fn digest(self) -> Digest {
        self.hasher.digest()
    }
}

impl Write for HashingWriter<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = self.sink.write(bytes)?;
        self.hasher.update(&bytes[..written]);
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.sink.flush()
    }
}
