//! The REST client, and the lock file that pins the tables of a project.
//!
//! Invariant: `client` fits nothing, opens no store, and uses a download only after checking its hash. Every response
//! is limited in bytes and time. `client` writes nothing outside the lock file's folder.

mod base;
mod download;
mod error;
mod git;
mod guard;
mod job;
mod lock_error;
mod lock_file;
mod lock_text;
mod pin;
mod pull;
mod rest;
mod server_tokens;
mod source;
#[cfg(test)]
mod tests;

pub use download::{Access, SourcesError, TABLE_BYTES, Wanted};
pub use error::{ClientError, without_passwords};
pub use git::{change_of_git, missing_attributes};
pub use guard::Guard;
pub use job::{JobDocument, JobProgress, JobStatus};
pub use lock_error::LockFileError;
pub use lock_file::{LockFile, read_text};
pub use lock_text::with_pins;
pub use pin::{ExportPin, FilePin, Pin, check_pins};
pub use pull::{PinState, PullError, check, check_size, check_unchanged, digest_of_file, place, stage, target};
pub use rest::Client;
pub use server_tokens::{ServerTokens, ServerTokensError};
pub use source::{Source, fetch};
