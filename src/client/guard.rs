//! A guard that allows one writer of a lock file at a time.

use std::{
    env,
    fs::{self, File, OpenOptions},
    io,
    path::Path,
};

use ltcforge_files::digest::Digest;

/// The exclusive right to change the lock files of a folder. It ends when the guard is dropped or the process ends.
#[derive(Debug)]
pub struct Guard {
    _file: File,
}

impl Guard {
    /// Waits until no other process has the right. If the guard has to wait, `on_wait` is called first.
    ///
    /// # Errors
    /// When the folder is missing, or the system cannot lock a file for it.
    pub fn of(folder: &Path, on_wait: impl FnOnce()) -> io::Result<Self> {
        let mut on_wait = Some(on_wait);
        let mut locked = |file: File| match file.try_lock() {
            Ok(()) => Ok(Self { _file: file }),
            Err(fs::TryLockError::WouldBlock) => {
                on_wait.take().into_iter().for_each(|on_wait| on_wait());
                while let Err(error) = file.lock() {
                    // A signal interrupted the wait.
                    if error.kind() != io::ErrorKind::Interrupted {
                        return Err(error);
                    }
                }
                Ok(Self { _file: file })
            }
            Err(fs::TryLockError::Error(error)) => Err(error),
        };
        // A lock on the folder itself leaves no file behind, but Windows cannot open folders, and NFS cannot lock them.
        if let Ok(guard) = File::open(folder).and_then(&mut locked) {
            return Ok(guard);
        }
        let name = Digest::of(fs::canonicalize(folder)?.as_os_str().as_encoded_bytes()).hex();
        let path = env::temp_dir().join(format!("ltcforge-{name}.lock"));
        OpenOptions::new().create(true).truncate(false).write(true).open(path).and_then(locked)
    }
}
