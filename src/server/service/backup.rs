//! Copies of a data folder, and a data folder of a copy.

use std::path::Path;

use super::OpenError;
use crate::store::{Copied, copy_store};

/// Copies the data folder `from`, which a service may be using, to `to`. An earlier copy there is brought up to date.
///
/// # Errors
/// When `from` has no store, when a service uses `to`, or when a file cannot be read or written.
pub fn back_up(from: &Path, to: &Path) -> Result<Copied, OpenError> {
    if !has_store(from) {
        return Err(OpenError::NoStore(from.to_owned()));
    }
    copy_store(from, to).map_err(|error| OpenError::of(to, error))
}

/// Makes the data folder `to` of the copy `from`.
///
/// # Errors
/// As [`back_up`], and when `to` has jobs and tables.
pub fn restore(from: &Path, to: &Path) -> Result<Copied, OpenError> {
    if has_store(to) || to.join("db").exists() {
        return Err(OpenError::HasStore(to.to_owned()));
    }
    back_up(from, to)
}

fn has_store(folder: &Path) -> bool {
    folder.join("jobs.log").exists() && folder.join("blobs").is_dir()
}
