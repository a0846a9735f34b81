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

/// The fewest hex digits behind [`PREFIX`] that are taken for those of a token, which has 64: a part of them tells too much too.
const FEWEST_DIGITS: usize = 16;

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
    type Err = Vec<String>;

    /// All faults, of which none shows a hash, or what was taken for one: it may be a token.
    fn from_str(text: &str) -> Result<Self, Vec<String>> {
        let words: Vec<&str> = text.split_whitespace().collect();
        let [name, scope, hash, standing @ ..] = words.as_slice() else {
            return Err(vec![format!(
                "a token is NAME SCOPE sha256:HASH, at least three words, and not {}",
                words.len()
            )]);
        };
        let hash = hash.strip_prefix("sha256:").and_then(|hash| hash.parse().ok());
        let hash: Result<Digest, String> =
            hash.ok_or_else(|| format!("the hash of «{}» is not sha256: and 64 hex digits", name.escape_debug()));
        let (standing, mut faults) = Standing::of(standing);
        match (Self::of(name, standing), scope.parse(), hash) {
            (Ok(by), Ok(scope), Ok(hash)) if faults.is_empty() => Ok(Self { by, scope, hash }),
            (by, scope, hash) => {
                faults.splice(0..0, by.err().into_iter().flatten().chain(scope.err()).chain(hash.err()));
                Err(faults)
            }
        }
    }
}

impl KeptToken {
    /// Whom a token names.
    fn of(name: &str, standing: Standing) -> Result<Arc<Submitter>, Vec<String>> {
        match (checked_name(name.to_owned()), standing.claim(name)) {
            (Ok(name), Ok(claim)) => Ok(Arc::new(Submitter { name, claim })),
            (name, claim) => Err(name.err().into_iter().chain(claim.err().into_iter().flatten()).collect()),
        }
    }

    /// A new token of these random bytes: its secret, and the token as it is kept.
    ///
    /// # Errors
    /// All faults, a line each, when a name is not one, or the share.
    pub fn new(
        name: &str,
        scope: Scope,
        standing: Standing,
        random: &[u8; TOKEN_BYTES],
    ) -> Result<(String, Self), String> {
        let by = Self::of(name, standing).map_err(|faults| faults.join("\n"))?;
        let secret = format!("{PREFIX}{}", to_hex(random));
        let hash = Digest::of(secret.as_bytes());
        Ok((secret, Self { by, scope, hash }))
    }
}

/// A text with `[...]` in place of the digits of tokens, whole or cut short: what goes into a log may have one by a slip.
pub(in crate::http) fn without_tokens(text: &str) -> String {
    let (mut shown, mut rest) = (String::with_capacity(text.len()), text);
    while let Some(at) = rest.find(PREFIX) {
        let (before, after) = rest.split_at(at + PREFIX.len());
        shown.push_str(before);
        rest = after.trim_start_matches(|c: char| c.is_ascii_hexdigit());
        match &after[..after.len() - rest.len()] {
            // Names of metrics begin so too.
            few if few.len() < FEWEST_DIGITS => shown.push_str(few),
            _ => shown.push_str("[...]"),
        }
    }
    shown + rest
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
                let mut faulty = |fault: &str| faults.push(without_tokens(&format!("{text_name}, line {at}: {fault}")));
                match line.parse::<KeptToken>() {
                    Ok(token) => {
                        let Submitter { name, claim } = &*token.by;
                        let share = *shares.entry(claim.team.clone()).or_insert(claim.share);
                        if share != claim.share {
                            let (team, other) = (&claim.team, claim.share);
                            faulty(&format!("the team «{team}» has a share of {share} above, and not of {other}"));
                        }
                        if !names.insert(name.clone()) {
                            faulty(&format!("a second token «{name}»"));
                        }
                        tokens.push(token);
                    }
                    Err(found) => found.iter().for_each(|fault| faulty(fault)),
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
        // Several of one line, in which the secret is the name.
        let line = format!(
            "{secret} root {secret} share=0 team=x/y colour=red priority=urgent\n{kept} team=farm share=2\n{kept}"
        );
        let faults = Tokens::of(&[("F", &line)]).expect_err("nine faults");
        for told in [
            "line 1: «ltcforge_[...]» is not the name",
            "line 1: scope «root»",
            "line 1: the hash of «ltcforge_[...]»",
            "line 1: share «0»",
            "line 1: «x/y» is not the name",
            "line 1: «colour=red»",
            "line 1: priority «urgent»",
            "line 3: the team «farm» has a share of 2 above, and not of 1",
            "line 3: a second token «farm»",
        ] {
            assert!(faults.contains(told), "{told}: {faults}");
        }
        assert_eq!(faults.lines().count(), 9, "{faults}");
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
