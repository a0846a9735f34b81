//! The tokens of a file that may change while the service runs.

use std::{
    fs, io,
    os::unix::fs::MetadataExt as _,
    path::{Path, PathBuf},
    sync::{Arc, PoisonError, RwLock},
    time::Duration,
};

use tokio::sync::watch;

use super::Tokens;

/// How often the file is looked at.
const LOOK: Duration = Duration::from_secs(1);

/// The longest file: some ten thousand tokens.
const LONGEST_FILE: u64 = 1 << 20;

/// Why the tokens of a service cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum TokenFileError {
    /// The file cannot be read.
    #[error("the file of tokens {} cannot be read: {source}", .path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// The system's error.
        source: io::Error,
    },
    /// Tokens have faults, a line each.
    #[error("the tokens have faults:\n{0}")]
    Faults(String),
}

/// Tokens given at the start and those of a file, as it was when it was last read.
#[derive(Debug, Default)]
pub struct WatchedTokens {
    listed: Option<String>,
    file: Option<PathBuf>,
    current: RwLock<Arc<Tokens>>,
    /// Of the file that was last read, whether it had faults or not.
    stamp: RwLock<Option<Stamp>>,
}

/// What differs once the file was written or replaced: inode, length, and the time of change.
type Stamp = (u64, u64, i64, i64);

fn stamp(path: &Path) -> Option<Stamp> {
    let file = fs::metadata(path).ok()?;
    Some((file.ino(), file.len(), file.ctime(), file.ctime_nsec()))
}

impl WatchedTokens {
    /// The tokens in `listed` and those of `file`, as [`Tokens::of`] reads them. Where either is given, there must be one.
    ///
    /// # Errors
    /// See [`TokenFileError`].
    pub fn open(listed: Option<String>, file: Option<PathBuf>) -> Result<Self, TokenFileError> {
        let watched = Self { listed, file, ..Self::default() };
        watched.read()?;
        Ok(watched)
    }

    /// The tokens now.
    #[must_use]
    pub fn current(&self) -> Arc<Tokens> {
        Arc::clone(&self.current.read().unwrap_or_else(PoisonError::into_inner))
    }

    fn read(&self) -> Result<(), TokenFileError> {
        let text = match &self.file {
            None => String::new(),
            Some(path) => {
                // Before the file is read: a change meanwhile is seen with the next look.
                *self.stamp.write().unwrap_or_else(PoisonError::into_inner) = stamp(path);
                let unreadable = |source| TokenFileError::Unreadable { path: path.clone(), source };
                let file = fs::File::open(path).map_err(unreadable)?;
                let mut text = String::new();
                io::Read::read_to_string(&mut io::Read::take(file, LONGEST_FILE), &mut text).map_err(unreadable)?;
                text
            }
        };
        let name = self.file.as_ref().map(|path| path.display().to_string()).unwrap_or_default();
        let texts = [("the list of tokens", self.listed.as_deref().unwrap_or_default()), (&name, &text)];
        let tokens = Tokens::of(&texts).map_err(TokenFileError::Faults)?;
        if tokens.is_empty() && (self.file.is_some() || self.listed.is_some()) {
            return Err(TokenFileError::Faults("there is no token".to_owned()));
        }
        *self.current.write().unwrap_or_else(PoisonError::into_inner) = Arc::new(tokens);
        Ok(())
    }

    /// Reads the file again if it has changed. With faults, or without a token, those from before stay: a slip of an editor
    /// locks nobody out and opens no door.
    fn look(&self) {
        let Some(path) = &self.file else { return };
        if *self.stamp.read().unwrap_or_else(PoisonError::into_inner) == stamp(path) {
            return;
        }
        match self.read() {
            Ok(()) => tracing::info!(path = %path.display(), "the tokens were read again"),
            Err(error) => tracing::error!("{error}; the tokens from before stay"),
        }
    }

    /// Looks at the file once a second until `stopping` becomes true.
    pub(in crate::http) async fn watch(self: Arc<Self>, mut stopping: watch::Receiver<bool>) {
        if self.file.is_none() {
            return;
        }
        let stopped = stopping.wait_for(|stopping| *stopping);
        tokio::pin!(stopped);
        while tokio::time::timeout(LOOK, &mut stopped).await.is_err() {
            let tokens = Arc::clone(&self);
            // A look that fails is followed by another.
            let _ = tokio::task::spawn_blocking(move || tokens.look()).await;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{KeptToken, Scope, TOKEN_BYTES};
    use super::*;

    #[test]
    fn a_changed_file_counts_unless_it_has_faults_or_no_token() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("tokens");
        let [a, b, c] = [1, 2, 3].map(|n| KeptToken::new(&format!("t{n}"), Scope::Read, &[n; TOKEN_BYTES]).unwrap());
        assert!(matches!(WatchedTokens::open(None, Some(path.clone())), Err(TokenFileError::Unreadable { .. })));
        // Another length each time: the time of change may be the same within some milliseconds.
        fs::write(&path, format!("{}\n", a.1)).unwrap();
        let watched = WatchedTokens::open(Some(c.1.to_string()), Some(path.clone())).unwrap();
        let found = || [&a, &b, &c].map(|(secret, _)| watched.current().find(secret.as_bytes()).is_some());
        assert_eq!(found(), [true, false, true]);
        fs::write(&path, format!("# b\n{}\n", b.1)).unwrap();
        watched.look();
        assert_eq!(found(), [false, true, true], "the first token is revoked");
        fs::write(&path, "nonsense").unwrap();
        watched.look();
        fs::remove_file(&path).unwrap();
        watched.look();
        assert_eq!(found(), [false, true, true], "those from before stay");
        fs::write(&path, format!("{}\n{}\n", a.1, c.1)).unwrap();
        watched.look();
        assert_eq!(found(), [false, true, true], "a name twice");

        let path = dir.path().join("alone");
        fs::write(&path, format!("{}\n", a.1)).unwrap();
        let watched = WatchedTokens::open(None, Some(path.clone())).unwrap();
        fs::write(&path, "# none").unwrap();
        watched.look();
        assert!(!watched.current().is_empty(), "an empty file opens no door");
        assert!(matches!(WatchedTokens::open(None, Some(path)), Err(TokenFileError::Faults(_))));
    }
}
