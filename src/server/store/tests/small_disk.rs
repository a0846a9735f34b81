//! A small disk for tests, which can be filled.

use std::{fs, fs::File, io::Write as _, path::PathBuf, process::Command};

/// A separate file system, unmounted when dropped.
pub(crate) struct SmallDisk(pub(crate) PathBuf);

impl SmallDisk {
    /// Mounts 16 MB at a new folder. Prints a message and returns `None` without the right to mount.
    pub(crate) fn mount(at: PathBuf) -> Option<Self> {
        fs::create_dir(&at).unwrap();
        let mounted = Command::new("mount").args(["-t", "tmpfs", "-o", "size=16m", "tmpfs"]).arg(&at).output();
        let is_mounted = mounted.is_ok_and(|mounted| mounted.status.success());
        if !is_mounted {
            eprintln!("SKIPPED: no right to mount a tmpfs");
        }
        is_mounted.then_some(Self(at))
    }

    pub(crate) fn fill(&self) {
        let mut file = File::create(self.0.join("filler")).unwrap();
        for block in [65_536, 4096, 1] {
            while file.write_all(&vec![0; block]).is_ok() {}
        }
    }

    pub(crate) fn make_room(&self) {
        fs::remove_file(self.0.join("filler")).unwrap();
    }
}

impl Drop for SmallDisk {
    fn drop(&mut self) {
        // The test deletes the folder with its temporary folder.
        let _ = Command::new("umount").arg("-l").arg(&self.0).status();
    }
}
