//! The body of an answer, read within limits.

use std::{
    io::{self, Read as _, Write},
    time::{Duration, Instant},
};

use flate2::read::MultiGzDecoder;
use ureq::{Body, http::Response};

use super::{
    ClientError,
    limits::{Limits, Pace, SizeOrigin},
};

/// The codings that a download may come in, as `Accept-Encoding` has them.
pub(super) const CODINGS: &str = "zstd, gzip";

/// The largest window of a zstd frame, 8 MiB, which a server must not exceed [RFC 9659, section 3].
const WINDOW_LOG: u32 = 23;

/// How much of an answer is read, and where that limit comes from.
#[derive(Debug, Clone, Copy)]
pub(super) struct SizeLimit {
    pub(super) bytes: u64,
    /// The origin of the limit.
    pub(super) origin: SizeOrigin,
}

impl SizeLimit {
    /// Checks that a file of `total` bytes from `url` has the size that the lock file states, if the limit comes from
    /// it.
    ///
    /// # Errors
    /// When the file is shorter. Longer files were cut off before.
    pub(super) fn check(&self, url: &str, total: u64) -> Result<(), ClientError> {
        let is_right = total == self.bytes || self.origin != SizeOrigin::LockFile;
        let too_short = || ClientError::TooShort { url: url.to_owned(), bytes: total, stated_bytes: self.bytes };
        is_right.then_some(()).ok_or_else(too_short)
    }
}

/// The reason that a body was not written to its end.
#[derive(Debug, thiserror::Error)]
pub(super) enum CopyError {
    #[error(transparent)]
    Client(#[from] ClientError),
    /// It could not be written.
    #[error(transparent)]
    Write(io::Error),
    #[error("it was stopped")]
    Stopped,
}

/// Writes the body of an answer to `sink`, part by part, as it arrives.
///
/// # Errors
/// When the body is longer than `size`, slower than `limits` or takes longer than `time`; when `sink` fails; when
/// `should_stop`, which is called after each part, returns true.
pub(super) fn copy(
    url: &str,
    response: Response<Body>,
    (size, time, limits): (SizeLimit, Duration, Limits),
    should_stop: &dyn Fn() -> bool,
    sink: &mut dyn Write,
) -> Result<(), CopyError> {
    let too_long = || ClientError::TooLong { url: url.to_owned(), limit_bytes: size.bytes, origin: size.origin };
    // The client asks for zstd itself, so ureq leaves it.
    let coding = response.headers().get("content-encoding").and_then(|name| name.to_str().ok()).unwrap_or_default();
    // One that ureq undoes it also takes out of the head. It knows gzip in this spelling alone.
    let is_gzip = ["gzip", "x-gzip"].iter().any(|name| coding.eq_ignore_ascii_case(name));
    let is_zstd = coding.eq_ignore_ascii_case("zstd");
    let body = response.into_body();
    if !is_gzip && !is_zstd && body.content_length().is_some_and(|length| length > size.bytes) {
        return Err(too_long().into());
    }
    let start = Instant::now();
    let mut pace = Pace::new(limits, time);
    let plain = body.into_reader();
    let mut reader: Box<dyn io::Read> = if is_gzip {
        Box::new(MultiGzDecoder::new(plain))
    } else if is_zstd {
        Box::new(unzstd(plain).map_err(|error| ClientError::transport(url, &ureq::Error::from(error)))?)
    } else {
        Box::new(plain)
    };
    let mut chunk = vec![0; 1 << 16];
    let mut total = 0;
    loop {
        if should_stop() {
            return Err(CopyError::Stopped);
        }
        let read = match reader.read(&mut chunk) {
            Ok(0) => return Ok(size.check(url, total)?),
            Ok(read) => read,
            Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
            Err(error) => return Err(ClientError::transport(url, &ureq::Error::from(error)).into()),
        };
        total += read as u64;
        if total > size.bytes {
            return Err(too_long().into());
        }
        let in_time = pace.read(read as u64, start.elapsed());
        in_time.map_err(|reason| ClientError::Unavailable { url: url.to_owned(), reason })?;
        sink.write_all(&chunk[..read]).map_err(CopyError::Write)?;
    }
}

/// The bytes that zstd made `packed` of. A frame that wants more memory than [`WINDOW_LOG`] allows is an error.
fn unzstd<R: io::Read>(packed: R) -> io::Result<impl io::Read> {
    let mut decoder = zstd::Decoder::new(packed)?;
    decoder.window_log_max(WINDOW_LOG)?;
    Ok(decoder)
}

/// The body of an answer that is a document.
///
/// # Errors
/// See [`copy`].
pub(super) fn document(url: &str, response: Response<Body>, limits: Limits) -> Result<Vec<u8>, ClientError> {
    let size = SizeLimit { bytes: limits.document_bytes, origin: SizeOrigin::Documents };
    let mut bytes = Vec::new();
    match copy(url, response, (size, limits.document_time, limits), &|| false, &mut bytes) {
        Ok(()) => Ok(bytes),
        Err(CopyError::Client(error)) => Err(error),
        // Writing to memory does not fail, and this is never stopped.
        Err(error) => Err(ClientError::Unexpected { url: url.to_owned(), reason: error.to_string() }),
    }
}
