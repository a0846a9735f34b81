//! Downloading the pinned tables that are missing or differ.

use std::{
    fs::{self, File},
    io,
    path::{Path, PathBuf},
};

use super::{
    pin::{ExportPin, FilePin, KEPT, Pin, is_kept},
    source::{Access, Exported, Source, SourcesError, Wanted, from_first},
};
use ltcforge_files::{
    digest::Digest,
    replace::{PairError, Staged, folder_of},
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
    /// Its folder is one of version control, of an editor or of a tool. A link may lead there.
    #[error("{}: the folder is really {}; {reason}", .path.display(), .real.display())]
    Kept {
        /// The file.
        path: PathBuf,
        /// Its folder, without links.
        real: PathBuf,
        /// Why nothing is written there.
        reason: &'static str,
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

/// The path to which the file at `path` below `folder` is written, without links. A checkout may hold links, and none
/// may lead a write out of it, or to the files of version control, editors and tools.
///
/// # Errors
/// When a link leads to such a place, or a folder on the way cannot be read.
pub fn target(path: &Path, folder: &Path) -> Result<PathBuf, PullError> {
    let named = folder.join(path);
    let failed = |source| PullError::File { path: named.clone(), source };
    let root = fs::canonicalize(folder_of(&folder.join("lock"))).map_err(failed)?;
    let (mut here, mut missing) = (folder_of(&named), Vec::new());
    let mut real = loop {
        match fs::canonicalize(here) {
            Ok(real) => break real,
            // A folder that is missing is made later. A link that leads nowhere is not missing.
            Err(error) if error.kind() == io::ErrorKind::NotFound && here.symlink_metadata().is_err() => {
                let Some(name) = here.file_name() else { return Err(failed(error)) };
                missing.push(name);
                here = folder_of(here);
            }
            Err(error) => return Err(failed(error)),
        }
    };
    real.extend(missing.iter().rev());
    let Ok(below) = real.strip_prefix(&root) else { return Err(PullError::LeadsOut { path: named }) };
    let kept = |reason| Err(PullError::Kept { path: named.clone(), real: real.clone(), reason });
    if below.iter().any(is_kept) {
        return kept(KEPT);
    }
    // The folder of a repository may have any name.
    let is_repository = |folder: &Path| {
        folder.join("HEAD").is_file() && ["objects", "refs"].iter().all(|name| folder.join(name).is_dir())
    };
    if real.ancestors().take_while(|folder| folder.starts_with(&root)).any(is_repository) {
        return kept("this is a repository of Git, which keeps its own files there");
    }
    let name =
        named.file_name().ok_or_else(|| failed(io::Error::new(io::ErrorKind::InvalidInput, "it names no file")))?;
    Ok(real.join(name))
}

/// Moves files into place that were staged for paths of [`target`], if their folders still are what they were.
///
/// # Errors
/// When a folder became a link since. Nothing is moved then. When a file cannot be moved.
pub fn place(staged: Staged) -> Result<(), PullError> {
    for path in staged.places() {
        let real = fs::canonicalize(folder_of(path));
        if real.map_err(|source| PullError::File { path: path.to_owned(), source })? != folder_of(path) {
            return Err(PullError::LeadsOut { path: path.to_owned() });
        }
    }
    staged.place().map_err(|PairError { path, source }| PullError::File { path, source })
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

#[cfg(all(test, unix))]
mod tests {
    use std::{fs, os::unix::fs::symlink};

    use super::*;
    use crate::{Limits, ServerTokens};
    use ltcforge_files::replace::replace_file;

    const OFFLINE: Access<'static> =
        Access { limits: Limits::USUAL, offline: true, tokens: &ServerTokens::NONE, should_stop: &|| false };

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
        place(staged).expect("both placed");
        for path in ["in/new/a", "a"] {
            assert_eq!(fs::read(project.join(path)).expect("the table"), b"right");
        }
    }

    /// A project with the files of version control and of an editor, and links to them, as a checkout may bring them.
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
            assert!(matches!(refused, PullError::Kept { .. }), "{path}: {refused}");
            assert!(refused.to_string().contains(path) && refused.to_string().contains("really"), "{refused}");
        }
        assert!(matches!(target(Path::new("nowhere/config"), &project), Err(PullError::File { .. })));
        // A project may lie in a folder of any name, and its files in links within it.
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
        assert!(matches!(place(staged), Err(PullError::LeadsOut { .. })));
        assert!(!outside.join("assets/b").exists() && !project.join("a").exists());
    }
}
