//! A copy of a data folder, made while a service uses it.
//!
//! The journal of jobs is read first and written last: a table is stored before the journal says that its job is done, so that
//! the copy has every table that its journal knows. Blobs never change. The database is left out: a start makes it again.

use std::{fs, io, path::Path};

use serde::Serialize;

use super::{StoreError, StoreOpenError, files, open::lock};
use ltcforge_files::digest::Digest;

/// What a copy took along.
#[derive(Debug, Default, PartialEq, Eq, Serialize)]
pub struct Copied {
    /// Blobs that were copied.
    pub copied: usize,
    /// Blobs that the target had already.
    pub present: usize,
    /// Blobs whose bytes do not have the digest of their name. They are not copied.
    pub damaged: Vec<Digest>,
}

/// Copies the data folder `from` to `to`, which may have an earlier copy. Blobs that are there, with as many bytes, stay.
///
/// # Errors
/// When `from` has no journal of jobs, when a service uses `to`, or when a file cannot be read or written.
pub fn copy_store(from: &Path, to: &Path) -> Result<Copied, StoreOpenError> {
    let journal = from.join("jobs.log");
    files::refuse_irregular(&journal).map_err(StoreOpenError::Unusable)?;
    let mut jobs = fs::read(&journal).map_err(|source| StoreError::of_io(&journal, source))?;
    // A line that is being written is not acknowledged.
    jobs.truncate(jobs.iter().rposition(|byte| *byte == b'\n').map_or(0, |last| last + 1));
    files::make_folder(to)?;
    let _lock = lock(&to.join("lock"))?;
    let mut copied = Copied::default();
    for (digest, path) in blobs(&from.join("blobs"))? {
        let hex = digest.hex();
        let target = to.join("blobs").join(&hex[..2]).join(&hex);
        let length = |path: &Path| files::regular_length(path).ok();
        if length(&target).is_some_and(|bytes| length(&path) == Some(bytes)) {
            copied.present += 1;
            continue;
        }
        let bytes = match files::read_regular(&path) {
            Ok(bytes) => bytes,
            // A tabulated BRDF may be deleted meanwhile.
            Err(error) if error.kind() == io::ErrorKind::NotFound => continue,
            Err(error) if error.kind() == io::ErrorKind::InvalidData => Vec::new(),
            Err(source) => return Err(StoreError::of_io(path, source).into()),
        };
        if Digest::of(&bytes) == digest {
            target.parent().map_or(Ok(()), files::make_folder)?;
            files::write_durably(&target, &bytes)?;
            copied.copied += 1;
        } else {
            copied.damaged.push(digest);
        }
    }
    files::write_durably(&to.join("jobs.log"), &jobs)?;
    Ok(copied)
}

/// The files below `root` whose names are digests, in order.
fn blobs(root: &Path) -> Result<Vec<(Digest, std::path::PathBuf)>, StoreError> {
    let mut found = Vec::new();
    let list = |folder: &Path| -> io::Result<Vec<_>> { fs::read_dir(folder)?.map(|entry| Ok(entry?.path())).collect() };
    for folder in list(root).map_err(|source| StoreError::of_io(root, source))?.into_iter().filter(|path| path.is_dir())
    {
        for path in list(&folder).map_err(|source| StoreError::of_io(&folder, source))? {
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            if let Ok(digest) = name.parse::<Digest>() {
                found.push((digest, path));
            }
        }
    }
    found.sort();
    Ok(found)
}
