//! Tokens: 256 random bits each. The service stores their SHA-256 hashes, one line `NAME SCOPE sha256:HASH` per token.

use std::{
    collections::BTreeSet,
    fmt,
    path::PathBuf,
    str::FromStr,
    sync::{Arc, PoisonError, RwLock},
};

use super::watched::{self, Watched};
use ltcforge_files::{digest::Digest, hex::to_hex};

/// Random bytes of a token.
pub const TOKEN_BYTES: usize = 32;

/// The prefix of every token. Scanners for leaked secrets can recognise it.
const PREFIX: &str = "ltcforge_";

/// Minimum number of hex digits after [`PREFIX`] that mark a token. Names of metrics have the same prefix, but fewer
/// digits.
const FEWEST_DIGITS: usize = 16;

/// Maximum length of a name.
const LONGEST_NAME: usize = 64;

/// The calls that a token allows. Each scope includes the previous ones.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Scope {
    /// Read everything: jobs, tables, pictures, metrics.
    Read,
    /// Submit and cancel jobs, store tabulated BRDFs.
    Submit,
    /// Delete tables and BRDFs.
    Admin,
}

impl Scope {
    /// All scopes, least first.
    pub const ALL: [Self; 3] = [Self::Read, Self::Submit, Self::Admin];

    /// The name in the token file.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Read => "read",
            Self::Submit => "submit",
            Self::Admin => "admin",
        }
    }
}

/// A token as the service stores it.
#[derive(Clone, PartialEq, Eq)]
pub struct Token {
    pub(super) name: String,
    pub(super) scope: Scope,
    hash: Digest,
}

/// Omits the hash.
impl fmt::Debug for Token {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Token").field("name", &self.name).field("scope", &self.scope).finish_non_exhaustive()
    }
}

impl fmt::Display for Token {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {} {}", self.name, self.scope.name(), self.hash)
    }
}

impl FromStr for Token {
    type Err = Vec<String>;

    /// Parses a line, and returns all its errors. No error contains the third word, which may be a secret.
    fn from_str(line: &str) -> Result<Self, Vec<String>> {
        let words: Vec<&str> = line.split_whitespace().collect();
        let [name, scope, hash] = words[..] else {
            return Err(vec![format!("expected the three words NAME SCOPE sha256:HASH, got {} words", words.len())]);
        };
        let known = Scope::ALL.into_iter().find(|known| known.name() == scope);
        let known = known
            .ok_or_else(|| format!("scope «{}» is unknown; the scopes are read, submit, admin", scope.escape_debug()));
        let hash: Result<Digest, String> = hash
            .strip_prefix("sha256:")
            .and_then(|hash| hash.parse().ok())
            .ok_or_else(|| format!("the hash of «{}» is not sha256: and 64 hex digits", name.escape_debug()));
        match (checked_name(name), known, hash) {
            (Ok(name), Ok(scope), Ok(hash)) => Ok(Self { name, scope, hash }),
            (name, scope, hash) => Err([name.err(), scope.err(), hash.err()].into_iter().flatten().collect()),
        }
    }
}

fn checked_name(name: &str) -> Result<String, String> {
    let is_good = |c: char| c.is_ascii_alphanumeric() || "-_.@".contains(c);
    if (1..=LONGEST_NAME).contains(&name.len()) && name.chars().all(is_good) {
        return Ok(name.to_owned());
    }
    let shown: String = name.chars().take(LONGEST_NAME).collect();
    Err(format!("«{}» is not a valid name; use 1 to {LONGEST_NAME} letters, digits and -_.@", shown.escape_debug()))
}

impl Token {
    /// Makes a token from random bytes. Returns the secret for the client, and the token for the service.
    ///
    /// # Errors
    /// When `name` is not a valid name.
    pub fn new(name: &str, scope: Scope, random: &[u8; TOKEN_BYTES]) -> Result<(String, Self), String> {
        let secret = format!("{PREFIX}{}", to_hex(random));
        let hash = Digest::of(secret.as_bytes());
        Ok((secret, Self { name: checked_name(name)?, scope, hash }))
    }
}

/// Replaces the digits of tokens in a text by `[...]`, so that it can be logged. Incomplete tokens are replaced too.
pub(super) fn without_tokens(text: &str) -> String {
    let mut parts = text.split(PREFIX);
    let mut shown = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let rest = part.trim_start_matches(|c: char| c.is_ascii_hexdigit());
        let is_token = part.len() - rest.len() >= FEWEST_DIGITS;
        shown += PREFIX;
        shown += if is_token { "[...]" } else { part };
        shown += if is_token { rest } else { "" };
    }
    shown
}

/// The tokens of a service.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Tokens(Vec<Arc<Token>>);

impl Tokens {
    /// Parses texts with one token per line. Empty lines and `#` comments are allowed. Errors contain the text's name.
    ///
    /// # Errors
    /// All errors, one per line.
    pub fn of(texts: &[(&str, &str)]) -> Result<Self, String> {
        let (mut tokens, mut faults, mut names) = (Vec::new(), Vec::new(), BTreeSet::new());
        for (text_name, text) in texts {
            for (at, line) in (1..).zip(text.lines().map(str::trim)) {
                if line.is_empty() || line.starts_with('#') {
                    continue;
                }
                let found = match line.parse::<Token>() {
                    Ok(token) if names.insert(token.name.clone()) => {
                        tokens.push(Arc::new(token));
                        continue;
                    }
                    Ok(token) => vec![format!("a second token has the name «{}»", token.name)],
                    Err(found) => found,
                };
                let messages = found.iter().map(|fault| without_tokens(&format!("{text_name}, line {at}: {fault}")));
                faults.extend(messages);
            }
        }
        if faults.is_empty() { Ok(Self(tokens)) } else { Err(faults.join("\n")) }
    }

    /// Whether there are no tokens.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The token with this secret. The comparison need not take constant time, because nobody can choose the bits of a
    /// hash.
    pub(super) fn find(&self, secret: &[u8]) -> Option<&Arc<Token>> {
        let hash = Digest::of(secret);
        self.0.iter().find(|token| token.hash == hash)
    }

    /// Whether a token is still valid with the same scope.
    pub(super) fn contains(&self, token: &Token) -> bool {
        self.0.iter().any(|known| **known == *token)
    }
}

/// Tokens from a list and from a file. The file is read again when it changes.
#[derive(Debug, Default)]
pub struct TokenFile {
    listed: Option<String>,
    file: Option<PathBuf>,
    watched: Watched,
    current: RwLock<Arc<Tokens>>,
}

impl TokenFile {
    /// Reads the tokens in `listed` and in `file`. If either is given, there must be at least one token.
    ///
    /// # Errors
    /// A message with all errors, one per line.
    pub fn open(listed: Option<String>, file: Option<PathBuf>) -> Result<Self, String> {
        let watched = Watched::new(file.iter().cloned().collect());
        let tokens = Self { listed, file, watched, ..Self::default() };
        tokens.read()?;
        Ok(tokens)
    }

    /// The current tokens.
    #[must_use]
    pub fn current(&self) -> Arc<Tokens> {
        Arc::clone(&self.current.read().unwrap_or_else(PoisonError::into_inner))
    }

    /// Reads the file again if it changed. After an error the previous tokens stay valid.
    pub(super) fn look(&self) {
        if self.watched.changed() {
            match self.read() {
                Ok(()) => tracing::info!("the token file changed; using the new tokens"),
                Err(error) => tracing::error!("{error}; the previous tokens stay valid"),
            }
        }
    }

    fn read(&self) -> Result<(), String> {
        let (mut name, mut text) = (String::new(), String::new());
        if let Some(path) = &self.file {
            name = path.display().to_string();
            let read = watched::read(path).map_err(|error| error.to_string());
            let read = read.and_then(|bytes| String::from_utf8(bytes).map_err(|_| "not UTF-8".to_owned()));
            text = read.map_err(|error| format!("the token file {name} cannot be read: {error}"))?;
        }
        let listed = self.listed.as_deref().unwrap_or_default();
        let tokens = Tokens::of(&[("the token list", listed), (&name, &text)])
            .map_err(|faults| format!("the tokens have errors:\n{faults}"))?;
        if tokens.is_empty() && (self.file.is_some() || self.listed.is_some()) {
            return Err("there is no token; to revoke the last token, replace it with another token".to_owned());
        }
        *self.current.write().unwrap_or_else(PoisonError::into_inner) = Arc::new(tokens);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    fn new(name: &str, scope: Scope, seed: u8) -> (String, Token) {
        Token::new(name, scope, &[seed; TOKEN_BYTES]).expect("a name")
    }

    #[test]
    fn a_token_is_found_by_its_secret_alone() {
        let (secret, kept) = new("farm", Scope::Submit, 7);
        let (other, reader) = new("viewer", Scope::Read, 8);
        // `printf ltcforge_0707...07 | sha256sum`
        assert_eq!(secret, format!("ltcforge_{}", "07".repeat(32)));
        assert_eq!(kept.to_string().parse(), Ok(kept.clone()));
        let tokens = Tokens::of(&[("a", &kept.to_string()), ("b", &format!("# of a person\n\n  {reader}\n"))]);
        let tokens = tokens.expect("two tokens");
        let found = |secret: &str| tokens.find(secret.as_bytes()).map(|token| (token.name.as_str(), token.scope));
        assert_eq!(found(&secret), Some(("farm", Scope::Submit)));
        assert_eq!(found(&other), Some(("viewer", Scope::Read)));
        for wrong in ["", "farm", &secret[1..], &kept.hash.to_string(), &kept.hash.hex()] {
            assert_eq!(found(wrong), None, "{wrong}");
        }
        assert!(!format!("{tokens:?}").contains(&kept.hash.hex()), "{tokens:?}");
        assert!(tokens.contains(&kept) && !tokens.contains(&Token { scope: Scope::Admin, ..kept }));
    }

    #[test]
    fn all_errors_are_reported_without_a_secret() {
        let (secret, kept) = new("farm", Scope::Admin, 1);
        let file = format!(
            "{kept}\n# c\n{secret} root {secret}\nb read\nc/d read {}\n{kept}\nann submit {0} team=art share=2",
            kept.hash
        );
        let faults = Tokens::of(&[("F", &file)]).expect_err("errors");
        for message in [
            "F, line 3: «ltcforge_[...]» is not a valid name",
            "F, line 3: scope «root»",
            "F, line 3: the hash of «ltcforge_[...]»",
            "line 4: expected the three words NAME SCOPE sha256:HASH, got 2 words",
            "line 5: «c/d»",
            "line 6: a second token has the name «farm»",
            "line 7: expected the three words NAME SCOPE sha256:HASH, got 5 words",
        ] {
            assert!(faults.contains(message), "{message}: {faults}");
        }
        assert_eq!(faults.lines().count(), 7, "{faults}");
        assert!(!faults.contains(&secret) && !faults.contains(&kept.hash.hex()), "{faults}");
    }

    #[test]
    fn a_token_is_shown_nowhere_and_names_stay() {
        let (secret, _) = new("farm", Scope::Read, 1);
        let text =
            format!("/v1/jobs?token={secret}&again={secret}x&m=ltcforge_entries&cut={}&ltcforge_", &secret[..25]);
        let shown =
            "/v1/jobs?token=ltcforge_[...]&again=ltcforge_[...]x&m=ltcforge_entries&cut=ltcforge_[...]&ltcforge_";
        assert_eq!(without_tokens(&text), shown);
        assert_eq!(without_tokens("/v1/tables"), "/v1/tables");
    }

    #[test]
    fn a_changed_file_counts_unless_it_has_errors_or_no_token() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("tokens");
        let [a, b, c] = [1, 2, 3].map(|n| new(&format!("t{n}"), Scope::Read, n));
        assert!(TokenFile::open(None, Some(path.clone())).unwrap_err().contains("cannot be read"));
        // Every version has a different length, because two writes may have the same time.
        fs::write(&path, format!("{}\n", a.1)).unwrap();
        let tokens = TokenFile::open(Some(c.1.to_string()), Some(path.clone())).unwrap();
        let found = || {
            tokens.look();
            [&a, &b, &c].map(|(secret, _)| tokens.current().find(secret.as_bytes()).is_some())
        };
        assert_eq!(found(), [true, false, true]);
        fs::write(&path, format!("# b\n{}\n", b.1)).unwrap();
        assert_eq!(found(), [false, true, true], "the first token is revoked");
        let long = format!("# {}\n{}", "-".repeat(watched::LONGEST_FILE as usize), a.1);
        let twice = format!("{}\n{}\n", a.1, c.1);
        for wrong in ["nonsense", &long, &twice] {
            fs::write(&path, wrong).unwrap();
            assert_eq!(found(), [false, true, true], "{}", &wrong[..6]);
        }
        fs::remove_file(&path).unwrap();
        assert_eq!(found(), [false, true, true], "a missing file");
        fs::write(&path, "# none").unwrap();
        assert!(TokenFile::open(None, Some(path)).unwrap_err().contains("there is no token"));
    }
}
