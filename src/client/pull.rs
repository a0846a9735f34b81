//! Downloads the pinned tables that are missing or changed.

use std::{
    fs, io,
    path::{Path, PathBuf},
};

use super::{
    Access, Source, SourcesError, Wanted, change_of_git,
    pin::{KEPT, is_kept},
    source::from_first,
};
use ltcforge_files::{
    bounded::open_regular,
    digest::Digest,
    replace::{PairError, Staged, folder_of},
};

/// The state of a pinned file on disk.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PinState {
    /// The file has the pinned bytes.
    Right,
    /// The file is missing.
    Missing,
    /// The file has other bytes.
    Different {
        /// The digest of these bytes.
        actual: Digest,
    },
}

/// Why a table was not pulled.
#[derive(Debug, thiserror::Error)]
pub enum PullError {
    /// No source delivered the table.
    #[error(transparent)]
    Sources(#[from] SourcesError),
    /// The file could not be read or written.
    #[error("{}: {source}", .path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// The system's error.
        source: io::Error,
    },
    /// The file has the pinned digest, but the lock file states another size.
    #[error("{}: the file has the pinned digest, but {bytes} bytes instead of {stated_bytes}", .path.display())]
    Size {
        /// The file.
        path: PathBuf,
        /// The length of the file.
        bytes: u64,
        /// The pinned length.
        stated_bytes: u64,
    },
    /// The file is missing or has other bytes than the pinned bytes.
    #[error("{}: {reason}", .path.display())]
    Drift {
        /// The file.
        path: PathBuf,
        /// The difference.
        reason: String,
    },
    /// A link leads to a folder where pinned files are not allowed.
    #[error("{}: the real folder is {}; {reason}", .path.display(), .real.display())]
    Place {
        /// The file.
        path: PathBuf,
        /// The folder of the file, with links resolved.
        real: PathBuf,
        /// Why nothing is written there.
        reason: &'static str,
    },
}

const LEADS_OUT: &str = "a link leads out of the lock file's folder";

/// Compares the file at `path` below `folder` with its pinned digest, and with its size if the lock file states it. The
/// function writes nothing, and reads the file in parts.
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

/// Like [`check`], with an error for a file that is missing or changed. The error explains changes that Git made.
///
/// # Errors
/// [`PullError::Drift`], and the errors of [`check`].
pub fn check_unchanged(path: &Path, digest: Digest, stated_bytes: Option<u64>, folder: &Path) -> Result<(), PullError> {
    let reason = match check(path, digest, stated_bytes, folder)? {
        PinState::Right => return Ok(()),
        PinState::Missing => "the file is missing".to_owned(),
        PinState::Different { actual } => {
            let cause = change_of_git(path, digest, folder).map(|cause| format!("; {cause}")).unwrap_or_default();
            format!("the file has digest {actual}, but {digest} is pinned{cause}")
        }
    };
    Err(PullError::Drift { path: folder.join(path), reason })
}

/// Checks that a file with the pinned digest has the stated size.
///
/// # Errors
/// When the sizes differ. Then the digest or the size in the lock file is wrong.
pub fn check_size(path: PathBuf, bytes: u64, stated_bytes: Option<u64>) -> Result<(), PullError> {
    match stated_bytes {
        Some(stated_bytes) if stated_bytes != bytes => Err(PullError::Size { path, bytes, stated_bytes }),
        _ => Ok(()),
    }
}

/// The digest of a regular file, and its length in bytes.
///
/// # Errors
/// When the file cannot be read, or is not a regular file.
pub fn digest_of_file(path: &Path) -> io::Result<(Digest, u64)> {
    let file = open_regular(path)?;
    let bytes = file.metadata()?.len();
    Ok((Digest::of_stream(file)?, bytes))
}

/// The path, without links, to which the file at `path` below `folder` is written. A checkout may contain links. They
/// must not lead a write out of the checkout, or to the files of version control, editors and tools.
///
/// # Errors
/// When a link leads out of the checkout or to such files, or a folder on the way cannot be read.
pub fn target(path: &Path, folder: &Path) -> Result<PathBuf, PullError> {
    let named = folder.join(path);
    let failed = |source| PullError::File { path: named.clone(), source };
    let root = fs::canonicalize(folder_of(&folder.join("lock"))).map_err(failed)?;
    let (mut here, mut missing) = (folder_of(&named), Vec::new());
    let mut real = loop {
        match fs::canonicalize(here) {
            Ok(real) => break real,
            // A missing folder is created later. A dangling link is not a missing folder.
            Err(error) if error.kind() == io::ErrorKind::NotFound && here.symlink_metadata().is_err() => {
                let Some(name) = here.file_name() else { return Err(failed(error)) };
                missing.push(name);
                here = folder_of(here);
            }
            Err(error) => return Err(failed(error)),
        }
    };
    real.extend(missing.iter().rev());
    let refused = |reason| Err(PullError::Place { path: named.clone(), real: real.clone(), reason });
    let Ok(below) = real.strip_prefix(&root) else { return refused(LEADS_OUT) };
    if below.iter().any(is_kept) {
        return refused(KEPT);
    }
    // The folder of a repository may have any name.
    let is_repository = |folder: &Path| {
        folder.join("HEAD").is_file() && ["objects", "refs"].iter().all(|name| folder.join(name).is_dir())
    };
    if real.ancestors().take_while(|folder| folder.starts_with(&root)).any(is_repository) {
        return refused("Git keeps the files of a repository in this folder");
    }
    let name = named
        .file_name()
        .ok_or_else(|| failed(io::Error::new(io::ErrorKind::InvalidInput, "the path names no file")))?;
    Ok(real.join(name))
}

/// Moves staged files to their paths from [`target`], if the folders have not changed since.
///
/// # Errors
/// When a folder has become a link (then no file is moved), or when a file cannot be moved.
pub fn place(staged: Staged) -> Result<(), PullError> {
    for path in staged.places() {
        let named = || path.to_owned();
        let real = fs::canonicalize(folder_of(path)).map_err(|source| PullError::File { path: named(), source })?;
        if real != folder_of(path) {
            return Err(PullError::Place { path: named(), real, reason: LEADS_OUT });
        }
    }
    staged.place().map_err(|PairError { path, source }| PullError::File { path, source })
}

/// Stages the wanted file for `path` below `folder`, from the first of `sources` that has it.
///
/// # Errors
/// When no source has the wanted bytes, or they cannot be written. Nothing is staged then.
pub fn stage(
    wanted: &Wanted,
    (folder, path): (&Path, &Path),
    sources: &[Source],
    access: &Access<'_>,
    staged: &mut Staged,
) -> Result<(), PullError> {
    let path = target(path, folder)?;
    let staged = from_first(sources, wanted, access, &mut |write| staged.write(&path, |file| write(file)));
    staged.map_err(|error| match error {
        SourcesError::Write(source) => PullError::File { path, source },
        error => PullError::Sources(error),
    })
}

#[cfg(all(test, unix))]
mod tests {
    use std::{fs, os::unix::fs::symlink};

    use super::*;
    use crate::{ServerTokens, TABLE_BYTES};
    use ltcforge_files::replace::replace_file;

    const OFFLINE: Access<'static> =
        Access { table_bytes: TABLE_BYTES, offline: true, tokens: &ServerTokens::NONE, should_stop: &|| false };

    #[test]
    fn the_state_of_a_pin_depends_on_its_bytes() {
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
        let (sources, wanted) = ([Source::Folder(tables)], Wanted::table(Digest::of(b"right"), None));
        let mut staged = Staged::default();
        for path in ["out/a", "out/new/a"] {
            let refused = stage(&wanted, (&project, Path::new(path)), &sources, &OFFLINE, &mut staged).expect_err(path);
            assert!(refused.to_string().ends_with(LEADS_OUT), "{refused}");
        }
        assert_eq!(fs::read_dir(&outside).expect("the folder").count(), 0);
        for path in ["in/new/a", "a"] {
            stage(&wanted, (&project, Path::new(path)), &sources, &OFFLINE, &mut staged).expect(path);
            assert!(!project.join(path).exists());
        }
        place(staged).expect("both placed");
        for path in ["in/new/a", "a"] {
            assert_eq!(fs::read(project.join(path)).expect("the table"), b"right");
        }
    }

    /// A project with the files of version control and of an editor, and links to them, as a checkout may contain them.
    #[test]
    fn no_link_leads_a_write_to_version_control_or_an_editor() {
        let folder = tempfile::tempdir().expect("a folder");
        let project = fs::canonicalize(folder.path()).expect("the folder").join("project");
        for made in [".git/hooks", ".vscode", "deep/.hg", "bare/objects", "bare/refs", "deep/er"] {
            fs::create_dir_all(project.join(made)).expect("a folder");
        }
        fs::write(project.join("bare/HEAD"), "ref: refs/heads/main").expect("a file");
        for (link, to) in [
            ("assets", ".git"),
            ("editor", ".vscode"),
            ("hooks", "assets/hooks"),
            ("twice", "once"),
            ("once", "./deep/../.git"),
            ("deep/er/up", "../../.git"),
            ("mercurial", "deep/.hg"),
            ("nowhere", ".git/none"),
            ("other", "bare"),
        ] {
            symlink(to, project.join(link)).expect("a link");
        }
        symlink(project.join(".git"), project.join("absolute")).expect("a link");
        for path in [
            "assets/config",
            "assets/new/config",
            "editor/tasks.json",
            "hooks/post-checkout",
            "twice/config",
            "deep/er/up/config",
            "mercurial/hgrc",
            "absolute/config",
            "other/config",
            "bare/hooks/x",
        ] {
            let refused = target(Path::new(path), &project).expect_err(path);
            assert!(matches!(refused, PullError::Place { .. }), "{path}: {refused}");
            assert!(refused.to_string().contains(path) && refused.to_string().contains("real folder"), "{refused}");
        }
        assert!(matches!(target(Path::new("nowhere/config"), &project), Err(PullError::File { .. })));
        // A project may be in a folder of any name, and its files may be behind links within it.
        let inside = project.join(".git/inside");
        fs::create_dir_all(inside.join("real")).expect("a folder");
        symlink("real", inside.join("link")).expect("a link");
        assert_eq!(target(Path::new("link/x"), &inside).expect("a path"), inside.join("real/x"));
    }

    #[test]
    fn a_folder_that_became_a_link_before_the_move_is_seen() {
        let folder = tempfile::tempdir().expect("a folder");
        let (project, outside) = (folder.path().join("project"), folder.path().join("outside"));
        for made in [&project.join("assets"), &outside] {
            fs::create_dir_all(made).expect("a folder");
        }
        let mut staged = Staged::default();
        for path in ["a", "assets/b"] {
            let path = target(Path::new(path), &project).expect("a path");
            staged.write(&path, |file| std::io::Write::write_all(file, b"x")).expect("a file");
        }
        fs::rename(project.join("assets"), outside.join("assets")).expect("a folder");
        symlink(outside.join("assets"), project.join("assets")).expect("a link");
        assert!(matches!(place(staged), Err(PullError::Place { reason: LEADS_OUT, .. })));
        assert!(!outside.join("assets/b").exists() && !project.join("a").exists());
    }
}
