//! Output files: checked before the work, and replaced as a whole after it.

use std::{
    fs::{self, OpenOptions},
    io,
    path::{Path, PathBuf},
};

use serde_json::json;

use super::{CommandFailure, file_failure, shown, usage};
use ltcforge_files::{
    digest::Digest,
    replace::{check_folder, folder_of, replace_file},
};

/// A file that a command will write.
#[derive(Debug)]
pub(super) struct OutputFile {
    /// The path, as the user wrote it.
    path: PathBuf,
    destination: Destination,
}

#[derive(Debug)]
enum Destination {
    /// An existing or new file, which is replaced as a whole.
    File(PathBuf),
    /// A device or a pipe, to which bytes are written.
    Stream,
}

impl OutputFile {
    /// Checks that `path` can be written. Changes nothing.
    ///
    /// # Errors
    /// When `path` is a folder, its folder is missing, or the file or its folder cannot be written.
    pub(super) fn check(path: &Path) -> Result<Self, CommandFailure> {
        let refuse = |error: &dyn std::fmt::Display| file_failure(path, error);
        let destination = match fs::metadata(path) {
            Ok(found) if found.is_dir() => return Err(refuse(&"this is a folder; add a file name")),
            Ok(found) if found.is_file() => {
                // Opening the file checks the permission. If the path is a link, the target is replaced.
                OpenOptions::new().write(true).open(path).map_err(|error| refuse(&error))?;
                Destination::File(fs::canonicalize(path).map_err(|error| refuse(&error))?)
            }
            Ok(_) => Destination::Stream,
            Err(error) if error.kind() == io::ErrorKind::NotFound => Destination::File(path.to_owned()),
            Err(error) => return Err(refuse(&error)),
        };
        if let Destination::File(file) = &destination {
            let folder = folder_of(file);
            if file.file_name().is_none() {
                return Err(refuse(&"the path names no file"));
            }
            if !folder.is_dir() {
                return Err(refuse(&format!("there is no folder {}", folder.display())));
            }
            check_folder(folder).map_err(|error| refuse(&format!("cannot write to its folder: {error}")))?;
        }
        Ok(Self { path: path.to_owned(), destination })
    }

    /// Like [`Self::check`], for a command that writes PNG.
    ///
    /// # Errors
    /// See [`Self::check`]; and when the name ends like that of another format.
    pub(super) fn check_png(path: &Path) -> Result<Self, CommandFailure> {
        match path.extension().map(std::ffi::OsStr::to_ascii_lowercase) {
            Some(ending) if ending != "png" => {
                Err(usage(format!("{}: pictures are PNG files; end the name in .png", path.display())))
            }
            _ => Self::check(path),
        }
    }

    /// Writes the file. If writing fails, the old file stays unchanged.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub(super) fn write(&self, bytes: &[u8]) -> Result<(), CommandFailure> {
        let written = match &self.destination {
            Destination::File(file) => replace_file(file, bytes),
            Destination::Stream => fs::write(&self.path, bytes),
        };
        written.map_err(|error| file_failure(&self.path, &error))
    }
}

/// Writes the file `name` of `folder` as a whole, and returns its path.
///
/// # Errors
/// When the file cannot be written.
pub(super) fn write_in(folder: &Path, name: impl AsRef<Path>, bytes: &[u8]) -> Result<PathBuf, CommandFailure> {
    let path = folder.join(name);
    replace_file(&path, bytes).map_err(|error| file_failure(&path, &error))?;
    Ok(path)
}

/// The JSON entry of a written file.
pub(super) fn listed(path: &Path, bytes: &[u8]) -> serde_json::Value {
    json!({ "file": shown(path), "bytes": bytes.len(), "sha256": Digest::of(bytes).hex() })
}

/// Checks that files can be created in `folder`, which may be missing. Changes nothing.
///
/// # Errors
/// When files cannot be created there.
pub(super) fn check_output_folder(folder: &Path) -> Result<(), CommandFailure> {
    check_folder(folder).map_err(|error| file_failure(folder, &format!("cannot write to this folder: {error}")))
}

#[cfg(all(test, unix))]
mod tests {
    use std::os::unix::fs::symlink;

    use super::*;

    #[test]
    fn a_file_is_replaced_through_a_link_and_a_device_is_written_to() {
        let folder = tempfile::tempdir().expect("a folder");
        let (file, link) = (folder.path().join("file"), folder.path().join("link"));
        fs::write(&file, "old").expect("a file");
        symlink(&file, &link).expect("a link");
        OutputFile::check(&link).expect("a file").write(b"new").expect("the file");
        assert!(link.is_symlink());
        assert_eq!(fs::read(&file).expect("the file"), b"new");

        OutputFile::check(Path::new("/dev/null")).expect("a device").write(b"new").expect("the device");
        assert!(!fs::metadata("/dev/null").expect("the device").is_file());
    }

    #[test]
    fn an_output_that_cannot_be_written_is_reported_first() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = |name: &str| folder.path().join(name);
        fs::write(path("file"), "old").expect("a file");
        for (wrong, said) in [
            (folder.path().to_owned(), "this is a folder"),
            (path("none/p.png"), "there is no folder"),
            (path("file/p.png"), "Not a directory"),
            ("/proc/p.png".into(), "cannot write"),
            (PathBuf::new(), "names no file"),
        ] {
            let refused = OutputFile::check(&wrong).expect_err(said);
            assert!(refused.message.contains(said), "{}", refused.message);
        }
        OutputFile::check(&path("new")).expect("a new file");
        assert_eq!(fs::read(path("file")).expect("the file"), b"old");
        assert_eq!(fs::read_dir(folder.path()).expect("the folder").count(), 1);
    }
}
