//! Downloading the pinned tables that are missing or differ.

use std::{
    fs::{self, File},
    io,
    path::{Path, PathBuf},
};

use super::{
    pin::{ExportPin, FilePin, Pin},
    source::{Access, Exported, Source, SourcesError, Wanted, from_first},
};
use ltcforge_files::{
    digest::Digest,
    replace::{Staged, folder_of},
};

/// The state of a pinned file on the disk.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PinState {
    /// It has the pinned bytes.
    Right,
    /// The file is missing.
    Missing,
    /// It has other bytes.
    Different {
        /// Their digest.
        actual: Digest,
    },
}

/// The reason that a table was not pulled.
#[derive(Debug, thiserror::Error)]
pub enum PullError {
    /// No source delivered it.
    #[error(transparent)]
    Sources(#[from] SourcesError),
    /// It could not be read or written.
    #[error("{}: {source}", .path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// The system's error.
        source: io::Error,
    },
    /// It has the pinned digest, but the lock file states another size.
    #[error("{}: a file of the pinned digest has {bytes} bytes, the lock file states {stated_bytes}", .path.display())]
    Size {
        /// The file.
        path: PathBuf,
        /// Its length.
        bytes: u64,
        /// The pinned length.
        stated_bytes: u64,
    },
    /// Its folder is a link that leads out of the lock file's folder.
    #[error("{}: the folder is a link that leads out of the lock file's folder", .path.display())]
    LeadsOut {
        /// The file.
        path: PathBuf,
    },
}

/// The state of the file at `path` below `folder`, which should have this digest, and this size if one is stated. It
/// writes nothing, and reads the file part by part.
///
/// # Errors
/// When the file cannot be read or is not a regular file, or has the pinned digest but not the stated size.
pub fn check(path: &Path, digest: Digest, stated_bytes: Option<u64>, folder: &Path) -> Result<PinState, PullError> {
    let path = folder.join(path);
    match digest_of_file(&path) {
        Ok((actual, bytes)) if actual == digest => check_size(path, bytes, stated_bytes).map(|()| PinState::Right),
        Ok((actual, _)) => Ok(PinState::Different { actual }),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(PinState::Missing),
        Err(source) => Err(PullError::File { path, source }),
    }
}

/// Checks that a file of the pinned digest has the size that is stated.
///
/// # Errors
/// When it has another size. Then one of the two is wrong in the lock file.
pub fn check_size(path: PathBuf, bytes: u64, stated_bytes: Option<u64>) -> Result<(), PullError> {
    match stated_bytes {
        Some(stated_bytes) if stated_bytes != bytes => Err(PullError::Size { path, bytes, stated_bytes }),
        _ => Ok(()),
    }
}

/// The digest of a file, and its length in bytes.
fn digest_of_file(path: &Path) -> io::Result<(Digest, u64)> {
    // Pipes and devices may have no end, and opening a pipe may block.
    let metadata = path.metadata()?;
    if !metadata.is_file() {
        return Err(io::Error::new(io::ErrorKind::InvalidInput, "this is not a regular file"));
    }
    Ok((Digest::of_stream(File::open(path)?)?, metadata.len()))
}

/// The path to which the file at `path` below `folder` is written. A checkout may hold links, and none may lead a write
/// out of it.
///
/// # Errors
/// When a link leads out, or a folder on the way cannot be read.
pub fn target(path: &Path, folder: &Path) -> Result<PathBuf, PullError> {
    let target = folder.join(path);
    let failed = |source| PullError::File { path: target.clone(), source };
    let root = fs::canonicalize(folder_of(&folder.join("lock"))).map_err(failed)?;
    let mut here = folder_of(&target);
    loop {
        match fs::canonicalize(here) {
            Ok(real) if real.starts_with(&root) => return Ok(target),
            Ok(_) => return Err(PullError::LeadsOut { path: target }),
            Err(error) if error.kind() == io::ErrorKind::NotFound && here != Path::new(".") => here = folder_of(here),
            Err(error) => return Err(failed(error)),
        }
    }
}

/// Stages the table of `pin` for its path below `folder`, from the first of `sources` that has it, unless the file is
/// there. Returns the state before.
///
/// # Errors
/// When no source has the pinned bytes, or they cannot be written. Nothing is staged then.
pub fn pull(
    pin: &Pin,
    (folder, sources): (&Path, &[Source]),
    access: &Access<'_>,
    staged: &mut Staged,
) -> Result<PinState, PullError> {
    let before = check(&pin.path, pin.digest, pin.bytes, folder)?;
    if before != PinState::Right {
        let wanted = Wanted { digest: pin.digest, stated_bytes: pin.bytes, of: None };
        stage(&wanted, target(&pin.path, folder)?, sources, access, staged)?;
    }
    Ok(before)
}

/// Stages the wanted file for `path`, once it has arrived whole and with the right hash.
fn stage(
    wanted: &Wanted<'_>,
    path: PathBuf,
    sources: &[Source],
    access: &Access<'_>,
    staged: &mut Staged,
) -> Result<(), PullError> {
    let staged = from_first(sources, wanted, access, &mut |write| staged.write(&path, |file| write(file)));
    staged.map_err(|error| match error {
        SourcesError::Write(source) => PullError::File { path, source },
        error => PullError::Sources(error),
    })
}

/// Stages `files` of an export of `table` for their paths below `folder`, each from the first of `sources` that is a
/// service and has it.
///
/// # Errors
/// When no service has the pinned bytes of a file, or they cannot be written. Files before it are staged by then.
pub fn pull_export(
    table: Digest,
    pin: &ExportPin,
    files: &[&FilePin],
    (folder, sources): (&Path, &[Source]),
    access: &Access<'_>,
    staged: &mut Staged,
) -> Result<(), PullError> {
    let servers: Vec<Source> = sources.iter().filter(|source| matches!(source, Source::Server(_))).cloned().collect();
    let nobody = || SourcesError::NoneHasIt(vec![]);
    let export = pin.name().ok_or_else(nobody)?;
    for file in files {
        let path = pin.path_of(file).ok_or_else(nobody)?;
        let of = Exported { table, export: &export, path: &path };
        let wanted = Wanted { digest: file.digest, stated_bytes: Some(file.bytes), of: Some(of) };
        stage(&wanted, target(&file.path, folder)?, &servers, access, staged)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::{fs, os::unix::fs::symlink};

    use super::*;
    use crate::Limits;
    use ltcforge_files::replace::replace_file;

    const OFFLINE: Access<'static> = Access { limits: Limits::USUAL, offline: true, should_stop: &|| false };

    fn right(path: &str) -> Pin {
        Pin {
            name: "a".into(),
            digest: Digest::of(b"right"),
            path: path.into(),
            bytes: None,
            recipe: None,
            sources: vec![],
            exports: vec![],
        }
    }

    #[test]
    fn the_state_of_a_pin_is_that_of_its_bytes() {
        let folder = tempfile::tempdir().expect("a folder");
        let digest = Digest::of(b"right");
        let state = || check(Path::new("sub/a"), digest, Some(5), folder.path()).expect("a readable file");
        assert_eq!(state(), PinState::Missing);
        replace_file(&folder.path().join("sub/a"), b"wrong").expect("a file");
        assert_eq!(state(), PinState::Different { actual: Digest::of(b"wrong") });
        replace_file(&folder.path().join("sub/a"), b"right").expect("a file");
        assert_eq!(state(), PinState::Right);
        for stated in [4, 6] {
            let refused = check(Path::new("sub/a"), digest, Some(stated), folder.path()).expect_err("another size");
            assert!(matches!(refused, PullError::Size { bytes: 5, stated_bytes, .. } if stated_bytes == stated));
        }
        assert!(check(Path::new("/dev/zero"), digest, None, folder.path()).is_err());
    }

    #[test]
    fn a_right_file_is_neither_brought_in_nor_touched() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a");
        replace_file(&path, b"right").expect("a file");
        let modified = || fs::metadata(&path).and_then(|data| data.modified()).expect("a time");
        let before = modified();
        // There is no source, so a request would fail.
        let mut staged = Staged::default();
        let pulled = pull(&right("a"), (folder.path(), &[]), &OFFLINE, &mut staged).expect("nothing to do");
        assert_eq!((pulled, staged.is_empty(), modified()), (PinState::Right, true, before));
    }

    #[test]
    fn no_link_leads_a_write_out_of_the_project() {
        let folder = tempfile::tempdir().expect("a folder");
        let (project, outside) = (folder.path().join("project"), folder.path().join("outside"));
        let tables = folder.path().join("tables");
        for made in [&project.join("inside"), &outside, &tables] {
            fs::create_dir_all(made).expect("a folder");
        }
        fs::write(tables.join(format!("{}.safetensors", Digest::of(b"right").hex())), "right").expect("a table");
        symlink(&outside, project.join("out")).expect("a link");
        symlink("inside", project.join("in")).expect("a link");
        let sources = [Source::Folder(tables)];
        let mut staged = Staged::default();
        for path in ["out/a", "out/new/a"] {
            let refused = pull(&right(path), (&project, &sources), &OFFLINE, &mut staged).expect_err(path);
            assert!(matches!(refused, PullError::LeadsOut { .. }), "{refused}");
        }
        assert_eq!(fs::read_dir(&outside).expect("the folder").count(), 0);
        for path in ["in/new/a", "a"] {
            let pulled = pull(&right(path), (&project, &sources), &OFFLINE, &mut staged).expect(path);
            assert!(pulled == PinState::Missing && !project.join(path).exists());
        }
        staged.place().expect("both placed");
        for path in ["in/new/a", "a"] {
            assert_eq!(fs::read(project.join(path)).expect("the table"), b"right");
        }
    }
}
