//! The REST client, and the lock file by which a project pins its tables.
//!
//! Invariant: `client` fits nothing and opens no store, and uses a download only after checking its hash.

mod error;
mod events;
mod job;
mod lock_file;
mod pull;
mod rest;

pub use crate::files::replace::replace_file;
pub use error::ClientError;
pub use job::{JobDocument, JobProgress, JobStatus};
pub use lock_file::{LockFile, LockFileError, Pin, with_pin};
pub use pull::{PinState, PullError, check, pull};
pub use rest::Client;
