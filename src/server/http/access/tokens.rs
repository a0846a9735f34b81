//! Tokens: who may call the service, and for what. A token is 256 random bits; of it, only the SHA-256 hash is kept.

use std::{
    collections::{BTreeMap, BTreeSet},
    fmt,
    num::NonZeroU32,
    str::FromStr,
    sync::Arc,
};

use subtle::ConstantTimeEq as _;

use super::standing::{Standing, checked_name};
use crate::queue::{Priority, Submitter};
use ltcforge_files::{digest::Digest, hex::to_hex};

/// Random bytes of a token.
pub const TOKEN_BYTES: usize = 32;

/// Begins each token, so that a program that looks for leaked secrets recognises one.
const PREFIX: &str = "ltcforge_";

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

/// A token as it is kept: `NAME SCOPE sha256:HASH`, and where they are others than usual `team=NAME`, `share=NUMBER` and
/// `priority=NAME`.
#[derive(Clone, PartialEq, Eq)]
pub struct KeptToken {
    by: Arc<Submitter>,
    scope: Scope,
    hash: Digest,
}

/// Without the hash, which nobody needs to see.
impl fmt::Debug for KeptToken {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("KeptToken").field("by", &self.by).field("scope", &self.scope).finish_non_exhaustive()
    }
}

impl fmt::Display for KeptToken {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Submitter { name, claim } = &*self.by;
        write!(f, "{name} {} {}", self.scope.name(), self.hash)?;
        if claim.team != *name {
            write!(f, " team={}", claim.team)?;
        }
        if claim.share != NonZeroU32::MIN {
            write!(f, " share={}", claim.share)?;
        }
        match claim.priority {
            Priority::Normal => Ok(()),
            priority => write!(f, " priority={}", priority.name()),
        }
    }
}

impl FromStr for KeptToken {
    type Err = String;

    /// No error shows a hash, or what was taken for one: it may be a token.
    fn from_str(text: &str) -> Result<Self, String> {
        let words: Vec<&str> = text.split_whitespace().collect();
        let [name, scope, hash, standing @ ..] = words.as_slice() else {
            return Err(format!("a token is NAME SCOPE sha256:HASH, at least three words, and not {}", words.len()));
        };
        let hash = hash.strip_prefix("sha256:").and_then(|hash| hash.parse().ok());
        let hash =
            hash.ok_or_else(|| format!("the hash of «{}» is not sha256: and 64 hex digits", name.escape_debug()));
        let name = checked_name((*name).to_owned())?;
        let claim = Standing::of(standing)?.claim(&name)?;
        Ok(Self { by: Arc::new(Submitter { name, claim }), scope: scope.parse()?, hash: hash? })
    }
}

impl KeptToken {
    /// A new token of these random bytes: its secret, and the token as it is kept.
    ///
    /// # Errors
    /// When a name is not one, or the share.
    pub fn new(
        name: &str,
        scope: Scope,
        standing: Standing,
        random: &[u8; TOKEN_BYTES],
    ) -> Result<(String, Self), String> {
        let secret = format!("{PREFIX}{}", to_hex(random));
        let hash = Digest::of(secret.as_bytes());
        let name = checked_name(name.to_owned())?;
        let claim = standing.claim(&name)?;
        Ok((secret, Self { by: Arc::new(Submitter { name, claim }), scope, hash }))
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
        let (mut tokens, mut faults) = (Vec::<KeptToken>::new(), Vec::new());
        let (mut names, mut shares) = (BTreeSet::new(), BTreeMap::new());
        for (text_name, text) in texts {
            for (at, line) in (1..).zip(text.lines().map(str::trim)) {
                if line.is_empty() || line.starts_with('#') {
                    continue;
                }
                let read = line.parse::<KeptToken>().and_then(|token| {
                    let Submitter { name, claim } = &*token.by;
                    if names.contains(name) {
                        return Err(format!("a second token «{name}»"));
                    }
                    let share = *shares.entry(claim.team.clone()).or_insert(claim.share);
                    if share != claim.share {
                        return Err(format!(
                            "the team «{}» has a share of {share} above, and not of {}",
                            claim.team, claim.share
                        ));
                    }
                    names.insert(name.clone());
                    Ok(token)
                });
                match read {
                    Ok(token) => tokens.push(token),
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

    /// Whom the token with this secret names, and its scope. Each hash is compared, and all of it, so that the time tells nothing.
    pub(super) fn find(&self, secret: &[u8]) -> Option<(&Arc<Submitter>, Scope)> {
        let hash = Digest::of(secret);
        let compare = |token: &&KeptToken| bool::from(token.hash.as_bytes().ct_eq(hash.as_bytes()));
        let found: Vec<bool> = self.0.iter().map(|token| compare(&token)).collect();
        let at = found.iter().position(|found| *found)?;
        self.0.get(at).map(|token| (&token.by, token.scope))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn new(name: &str, scope: Scope, seed: u8) -> (String, KeptToken) {
        KeptToken::new(name, scope, Standing::default(), &[seed; TOKEN_BYTES]).expect("a name")
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
        let found = |secret: &str| tokens.find(secret.as_bytes()).map(|(by, scope)| (by.name.as_str(), scope));
        assert_eq!(found(&secret), Some(("farm", Scope::Submit)));
        assert_eq!(found(&other), Some(("viewer", Scope::Read)));
        for wrong in ["", "farm", &secret[1..], &kept.hash.to_string(), &kept.hash.hex()] {
            assert_eq!(found(wrong), None, "{wrong}");
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
    fn a_line_says_what_jobs_may_have_and_a_team_has_one_share() {
        let standing = Standing { team: Some("art".to_owned()), share: Some(3), priority: Some(Priority::High) };
        let (secret, kept) = KeptToken::new("ann", Scope::Submit, standing, &[1; TOKEN_BYTES]).expect("names");
        assert!(kept.to_string().ends_with(" team=art share=3 priority=high"), "{kept}");
        let tokens = Tokens::of(&[("F", &kept.to_string())]).expect("a token");
        let (by, _) = tokens.find(secret.as_bytes()).expect("it is known");
        assert_eq!((by.claim.team.as_str(), by.claim.share.get(), by.claim.priority), ("art", 3, Priority::High));
        let (_, other) = new("bob", Scope::Submit, 2);
        let faults = Tokens::of(&[("F", &format!("{kept}\n{other} team=art"))]).expect_err("two shares");
        assert_eq!(faults, "F, line 2: the team «art» has a share of 3 above, and not of 1");
    }

    #[test]
    fn scopes_are_ordered() {
        assert!(Scope::ALL.is_sorted());
        assert!(Scope::ALL.iter().all(|scope| scope.name().parse() == Ok(*scope)));
    }
}
