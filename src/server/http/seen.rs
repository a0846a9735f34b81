//! Files that may change while the service runs.

use std::{
    fs,
    os::unix::fs::MetadataExt as _,
    path::{Path, PathBuf},
    sync::{Arc, Mutex, PoisonError},
    time::Duration,
};

use tokio::sync::watch;

/// How often files are looked at.
const LOOK: Duration = Duration::from_secs(1);

/// What differs once a file was written or replaced: inode, length, and the time of change. `None` of one that is not there.
type Stamp = Option<(u64, u64, i64, i64)>;

fn stamp(path: &Path) -> Stamp {
    let file = fs::metadata(path).ok()?;
    Some((file.ino(), file.len(), file.ctime(), file.ctime_nsec()))
}

/// Files, and how they were when they were last read.
#[derive(Debug, Default)]
pub(super) struct Seen {
    files: Vec<PathBuf>,
    stamps: Mutex<Vec<Stamp>>,
}

impl Seen {
    pub(super) fn new(files: Vec<PathBuf>) -> Self {
        Self { files, stamps: Mutex::default() }
    }

    /// Whether any differs from when this was last called, which is before they are read: a change meanwhile is seen with
    /// the next look.
    pub(super) fn have_changed(&self) -> bool {
        let now: Vec<Stamp> = self.files.iter().map(|file| stamp(file)).collect();
        let mut stamps = self.stamps.lock().unwrap_or_else(PoisonError::into_inner);
        let have_changed = *stamps != now;
        *stamps = now;
        have_changed
    }
}

/// What is made of files, and made again when they change.
pub(super) trait Renewed: Send + Sync + 'static {
    /// The files.
    fn seen(&self) -> &Seen;

    /// Reads them again, and says in the log how that went; what was read before stays where they have faults.
    fn renew(&self);
}

/// Looks at the files once a second until `stopping` becomes true.
pub(super) async fn watch(renewed: Arc<dyn Renewed>, mut stopping: watch::Receiver<bool>) {
    if renewed.seen().files.is_empty() {
        return;
    }
    let stopped = stopping.wait_for(|stopping| *stopping);
    tokio::pin!(stopped);
    while tokio::time::timeout(LOOK, &mut stopped).await.is_err() {
        let renewed = Arc::clone(&renewed);
        let look = move || {
            if renewed.seen().have_changed() {
                renewed.renew();
            }
        };
        // A look that fails is followed by another.
        let _ = tokio::task::spawn_blocking(look).await;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// As Kubernetes renews a secret that is mounted as a folder: another folder of equally long files, and a link that is replaced.
    #[test]
    fn a_file_behind_a_link_that_is_replaced_has_changed() {
        let dir = tempfile::tempdir().unwrap();
        let at = |name: &str| dir.path().join(name);
        for (folder, text) in [("1", "old"), ("2", "new")] {
            fs::create_dir(at(folder)).unwrap();
            fs::write(at(folder).join("tokens"), text).unwrap();
        }
        std::os::unix::fs::symlink("1", at("..data")).unwrap();
        std::os::unix::fs::symlink("..data/tokens", at("tokens")).unwrap();
        let seen = Seen::new(vec![at("tokens")]);
        assert!(seen.have_changed() && !seen.have_changed());
        std::os::unix::fs::symlink("2", at("..next")).unwrap();
        fs::rename(at("..next"), at("..data")).unwrap();
        assert!(seen.have_changed());
        assert_eq!(fs::read_to_string(at("tokens")).unwrap(), "new");
    }
}
