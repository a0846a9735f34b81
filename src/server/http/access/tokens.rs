//! Tokens: who may call the service, and for what. A token is 256 random bits; of it, only the SHA-256 hash is kept.

use std::{collections::BTreeSet, fmt, str::FromStr};

use subtle::ConstantTimeEq as _;

use ltcforge_files::{digest::Digest, hex::to_hex};

/// Random bytes of a token.
pub const TOKEN_BYTES: usize = 32;

/// Begins each token, so that a program that looks for leaked secrets recognises one.
const PREFIX: &str = "ltcforge_";

/// The longest name.
const LONGEST_NAME: usize = 64;

/// What a token allows. Each allows what those before it do.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Scope {
    /// To read everything: jobs, tables, pictures, metrics.
    Read,
    /// To submit and cancel jobs, and to store tabulated BRDFs.
    Submit,
    /// To delete what others may use.
    Admin,
}

impl Scope {
    /// All of them, least first.
    pub const ALL: [Self; 3] = [Self::Read, Self::Submit, Self::Admin];

    /// Its name.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Read => "read",
            Self::Submit => "submit",
            Self::Admin => "admin",
        }
    }
}

impl FromStr for Scope {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let known = Self::ALL.into_iter().find(|scope| scope.name() == text);
        known.ok_or_else(|| format!("scope «{}» is unknown; the scopes are read, submit, admin", text.escape_debug()))
    }
}

/// A token as it is kept: `NAME SCOPE sha256:HASH`.
#[derive(Clone, PartialEq, Eq)]
pub struct KeptToken {
    name: String,
    scope: Scope,
    hash: Digest,
}

/// Without the hash, which nobody needs to see.
impl fmt::Debug for KeptToken {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("KeptToken").field("name", &self.name).field("scope", &self.scope).finish_non_exhaustive()
    }
}

impl fmt::Display for KeptToken {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {} {}", self.name, self.scope.name(), self.hash)
    }
}

impl FromStr for KeptToken {
    type Err = String;

    /// No error shows a hash, or what was taken for one: it may be a token.
    fn from_str(text: &str) -> Result<Self, String> {
        let words: Vec<&str> = text.split_whitespace().collect();
        let &[name, scope, hash] = words.as_slice() else {
            return Err(format!("a token is NAME SCOPE sha256:HASH, three words, and not {}", words.len()));
        };
        let hash = hash.strip_prefix("sha256:").and_then(|hash| hash.parse().ok());
        let hash =
            hash.ok_or_else(|| format!("the hash of «{}» is not sha256: and 64 hex digits", name.escape_debug()));
        Ok(Self { name: checked_name(name)?, scope: scope.parse()?, hash: hash? })
    }
}

fn checked_name(name: &str) -> Result<String, String> {
    let is_good = |c: char| c.is_ascii_alphanumeric() || "-_.@".contains(c);
    if (1..=LONGEST_NAME).contains(&name.len()) && name.chars().all(is_good) {
        return Ok(name.to_owned());
    }
    let shown: String = name.chars().take(LONGEST_NAME).collect();
    let form = format!("a name is 1 to {LONGEST_NAME} letters, digits and -_.@");
    Err(format!("«{}» is not the name of a token: {form}", shown.escape_debug()))
}

impl KeptToken {
    /// A new token of these random bytes: its secret, and the token as it is kept.
    ///
    /// # Errors
    /// When the name is not one.
    pub fn new(name: &str, scope: Scope, random: &[u8; TOKEN_BYTES]) -> Result<(String, Self), String> {
        let secret = format!("{PREFIX}{}", to_hex(random));
        let hash = Digest::of(secret.as_bytes());
        Ok((secret, Self { name: checked_name(name)?, scope, hash }))
    }
}

/// The tokens of a service.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Tokens(Vec<KeptToken>);

impl Tokens {
    /// The tokens of texts, each with a name for its faults: a token a line; empty lines and those that begin with `#` say
    /// nothing.
    ///
    /// # Errors
    /// All faults, a line each.
    pub fn of(texts: &[(&str, &str)]) -> Result<Self, String> {
        let (mut tokens, mut faults, mut names) = (Vec::<KeptToken>::new(), Vec::new(), BTreeSet::new());
        for (text_name, text) in texts {
            for (at, line) in (1..).zip(text.lines().map(str::trim)) {
                if line.is_empty() || line.starts_with('#') {
                    continue;
                }
                match line.parse::<KeptToken>() {
                    Ok(token) if names.insert(token.name.clone()) => tokens.push(token),
                    Ok(token) => faults.push(format!("{text_name}, line {at}: a second token «{}»", token.name)),
                    Err(fault) => faults.push(format!("{text_name}, line {at}: {fault}")),
                }
            }
        }
        if faults.is_empty() { Ok(Self(tokens)) } else { Err(faults.join("\n")) }
    }

    /// Whether there is none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Name and scope of the token with this secret. Each hash is compared, and all of it, so that the time tells nothing.
    pub(super) fn find(&self, secret: &[u8]) -> Option<(&str, Scope)> {
        let hash = Digest::of(secret);
        let compare = |token: &&KeptToken| bool::from(token.hash.as_bytes().ct_eq(hash.as_bytes()));
        let found: Vec<bool> = self.0.iter().map(|token| compare(&token)).collect();
        let at = found.iter().position(|found| *found)?;
        self.0.get(at).map(|token| (token.name.as_str(), token.scope))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn new(name: &str, scope: Scope, seed: u8) -> (String, KeptToken) {
        KeptToken::new(name, scope, &[seed; TOKEN_BYTES]).expect("a name")
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
        assert_eq!(tokens.find(secret.as_bytes()), Some(("farm", Scope::Submit)));
        assert_eq!(tokens.find(other.as_bytes()), Some(("viewer", Scope::Read)));
        for wrong in ["", "farm", &secret[1..], &kept.hash.to_string(), &kept.hash.hex()] {
            assert_eq!(tokens.find(wrong.as_bytes()), None, "{wrong}");
        }
        assert!(!format!("{tokens:?}").contains(&kept.hash.hex()), "{tokens:?}");
    }

    #[test]
    fn all_faults_of_a_file_are_told_and_no_secret() {
        let (secret, kept) = new("farm", Scope::Admin, 1);
        let file = format!("{kept}\n# c\nviewer read {secret}\na root {}\nb read\nc/d read {0}\n{kept}", kept.hash);
        let faults = Tokens::of(&[("F", &file)]).expect_err("five faults");
        for told in [
            "F, line 3: the hash of «viewer»",
            "line 4: scope «root»",
            "line 5",
            "«c/d»",
            "line 7: a second token «farm»",
        ] {
            assert!(faults.contains(told), "{told}: {faults}");
        }
        assert_eq!(faults.lines().count(), 5, "{faults}");
        assert!(!faults.contains(&secret) && !faults.contains(&kept.hash.hex()), "{faults}");
    }

    #[test]
    fn scopes_are_ordered() {
        assert!(Scope::ALL.is_sorted());
        assert!(Scope::ALL.iter().all(|scope| scope.name().parse() == Ok(*scope)));
    }
}
