//! The tokens of a file that may change while the service runs.

use std::{
    fs, io,
    path::PathBuf,
    sync::{Arc, PoisonError, RwLock},
};

use super::Tokens;
use crate::http::seen::{Renewed, Seen};

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
    seen: Seen,
}

impl WatchedTokens {
    /// The tokens in `listed` and those of `file`, as [`Tokens::of`] reads them. Where either is given, there must be one.
    ///
    /// # Errors
    /// See [`TokenFileError`].
    pub fn open(listed: Option<String>, file: Option<PathBuf>) -> Result<Self, TokenFileError> {
        let seen = Seen::new(file.iter().cloned().collect());
        seen.have_changed();
        let watched = Self { listed, file, seen, ..Self::default() };
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
                let unreadable = |source| TokenFileError::Unreadable { path: path.clone(), source };
                let file = fs::File::open(path).map_err(unreadable)?;
                let mut text = String::new();
                io::Read::read_to_string(&mut io::Read::take(file, LONGEST_FILE + 1), &mut text).map_err(unreadable)?;
                if text.len() as u64 > LONGEST_FILE {
                    return Err(TokenFileError::Faults(format!("it is longer than {LONGEST_FILE} bytes")));
                }
                text
            }
        };
        let name = self.file.as_ref().map(|path| path.display().to_string()).unwrap_or_default();
        let texts = [("the list of tokens", self.listed.as_deref().unwrap_or_default()), (&name, &text)];
        let tokens = Tokens::of(&texts).map_err(TokenFileError::Faults)?;
        if tokens.is_empty() && (self.file.is_some() || self.listed.is_some()) {
            return Err(TokenFileError::Faults(
                "there is no token; to revoke the last one, put another into its place".to_owned(),
            ));
        }
        *self.current.write().unwrap_or_else(PoisonError::into_inner) = Arc::new(tokens);
        Ok(())
    }
}

impl Renewed for WatchedTokens {
    fn seen(&self) -> &Seen {
        &self.seen
    }

    /// With faults, or without a token, those from before stay: a slip of an editor locks nobody out and opens no door.
    fn renew(&self) {
        match self.read() {
            Ok(()) => tracing::info!("the tokens were read again"),
            Err(error) => tracing::error!("{error}; the tokens from before stay"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{KeptToken, Scope, Standing, TOKEN_BYTES};
    use super::*;

    #[test]
    fn a_changed_file_counts_unless_it_has_faults_or_no_token() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("tokens");
        let [a, b, c] = [1, 2, 3]
            .map(|n| KeptToken::new(&format!("t{n}"), Scope::Read, Standing::default(), &[n; TOKEN_BYTES]).unwrap());
        assert!(matches!(WatchedTokens::open(None, Some(path.clone())), Err(TokenFileError::Unreadable { .. })));
        // Another length each time: the time of change may be the same within some milliseconds.
        fs::write(&path, format!("{}\n", a.1)).unwrap();
        let watched = WatchedTokens::open(Some(c.1.to_string()), Some(path.clone())).unwrap();
        let look = || {
            if watched.seen.have_changed() {
                watched.renew();
            }
        };
        let found = || [&a, &b, &c].map(|(secret, _)| watched.current().find(secret.as_bytes()).is_some());
        assert_eq!(found(), [true, false, true]);
        fs::write(&path, format!("# b\n{}\n", b.1)).unwrap();
        look();
        assert_eq!(found(), [false, true, true], "the first token is revoked");
        fs::write(&path, "nonsense").unwrap();
        look();
        fs::write(&path, format!("# {}\n{}", "-".repeat(LONGEST_FILE as usize), a.1)).unwrap();
        look();
        assert_eq!(found(), [false, true, true], "a file that is too long is not cut");
        fs::remove_file(&path).unwrap();
        look();
        assert_eq!(found(), [false, true, true], "those from before stay");
        fs::write(&path, format!("{}\n{}\n", a.1, c.1)).unwrap();
        look();
        assert_eq!(found(), [false, true, true], "a name twice");

        let path = dir.path().join("alone");
        fs::write(&path, format!("{}\n", a.1)).unwrap();
        let watched = WatchedTokens::open(None, Some(path.clone())).unwrap();
        fs::write(&path, "# none").unwrap();
        watched.renew();
        assert!(!watched.current().is_empty(), "an empty file opens no door");
        assert!(matches!(WatchedTokens::open(None, Some(path)), Err(TokenFileError::Faults(_))));
    }
}
