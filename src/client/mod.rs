//! The REST client, and the lock file by which a project pins its tables.
//!
//! Invariant: `client` fits nothing and opens no store, and uses a download only after checking its hash. It reads no
//! answer beyond a limit of bytes and time.

mod answer;
mod download;
mod error;
mod events;
mod job;
mod limits;
mod lock_file;
mod pull;
mod rest;
#[cfg(test)]
mod tests;

pub use download::{Download, DownloadError};
pub use error::ClientError;
pub use job::{JobDocument, JobProgress, JobStatus};
pub use limits::Limits;
pub use lock_file::{LockFile, LockFileError, Pin, read_text, with_pin};
pub use pull::{PinState, PullError, check, pull};
pub use rest::Client;
