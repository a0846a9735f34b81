//! What the jobs of a token may have of the workers, in words of its line.

use std::{fmt, num::NonZeroU32};

use crate::queue::{Claim, Priority};

/// The longest name.
const LONGEST_NAME: usize = 64;

/// The greatest share of a team.
const GREATEST_SHARE: u32 = 100;

/// What a token says of its jobs beside its scope.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Standing {
    /// The team; without one, the token is a team of its own.
    pub team: Option<String>,
    /// The share of the team, from 1 to 100.
    pub share: Option<u32>,
    /// The priority of its jobs.
    pub priority: Option<Priority>,
}

impl Standing {
    /// The standing that words say, and the faults of those that say none.
    pub(super) fn of(words: &[&str]) -> (Self, Vec<String>) {
        let (mut standing, mut faults) = (Self::default(), Vec::new());
        for word in words {
            match word.split_once('=') {
                Some(("team", value)) if standing.team.is_none() => standing.team = Some(value.to_owned()),
                Some(("share", value)) if standing.share.is_none() => match value.parse() {
                    Ok(share) => standing.share = Some(share),
                    Err(_) => faults.push(wrong_share(value)),
                },
                Some(("priority", value)) if standing.priority.is_none() => {
                    standing.priority = Priority::ALL.into_iter().find(|priority| priority.name() == value);
                    if standing.priority.is_none() {
                        faults.push(format!("priority «{}» is not low, normal or high", value.escape_debug()));
                    }
                }
                _ => faults.push(format!(
                    "«{}» is not team=NAME, share=NUMBER or priority=NAME, each once",
                    word.escape_debug()
                )),
            }
        }
        (standing, faults)
    }

    /// Of a token of this name.
    ///
    /// # Errors
    /// All faults.
    pub(super) fn claim(self, name: &str) -> Result<Claim, Vec<String>> {
        let team = self.team.map_or_else(|| Ok(name.to_owned()), checked_name);
        let share = self.share.unwrap_or(1);
        let share =
            NonZeroU32::new(share).filter(|share| share.get() <= GREATEST_SHARE).ok_or_else(|| wrong_share(share));
        match (team, share) {
            (Ok(team), Ok(share)) => Ok(Claim { team, share, priority: self.priority.unwrap_or(Priority::Normal) }),
            (team, share) => Err(team.err().into_iter().chain(share.err()).collect()),
        }
    }
}

fn wrong_share(value: impl fmt::Display) -> String {
    format!("share «{}» is no whole number from 1 to {GREATEST_SHARE}", value.to_string().escape_debug())
}

/// The name of a token or of a team.
pub(super) fn checked_name(name: String) -> Result<String, String> {
    let is_good = |c: char| c.is_ascii_alphanumeric() || "-_.@".contains(c);
    if (1..=LONGEST_NAME).contains(&name.len()) && name.chars().all(is_good) {
        return Ok(name);
    }
    let shown: String = name.chars().take(LONGEST_NAME).collect();
    let form = format!("a name is 1 to {LONGEST_NAME} letters, digits and -_.@");
    Err(format!("«{}» is not the name of a token or a team: {form}", shown.escape_debug()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_say_team_share_and_priority() {
        let claim = |words: &str| {
            let (standing, mut faults) = Standing::of(&words.split_whitespace().collect::<Vec<_>>());
            let claim = standing.claim("farm").map_err(|more| faults.extend(more));
            if faults.is_empty() { Ok(claim.unwrap()) } else { Err(faults) }
        };
        assert_eq!(claim(""), Ok(Claim { team: "farm".to_owned(), ..Claim::default() }));
        let all = Claim { team: "art".to_owned(), share: NonZeroU32::new(100).unwrap(), priority: Priority::Low };
        assert_eq!(claim("priority=low team=art share=100"), Ok(all));
        for (words, told) in [
            ("share=0", "share «0» is no whole number from 1 to 100"),
            ("share=101", "share «101»"),
            ("share=1.5", "share «1.5»"),
            ("share=-1", "share «-1»"),
            ("priority=urgent", "priority «urgent» is not low, normal or high"),
            ("team=", "«» is not the name of a token or a team"),
            ("team=a/b", "«a/b»"),
            ("team=a team=b", "«team=b» is not team=NAME, share=NUMBER or priority=NAME, each once"),
            ("turn=3", "«turn=3»"),
            ("art", "«art»"),
        ] {
            let faults = claim(words).unwrap_err();
            assert!(faults.len() == 1 && faults[0].starts_with(told), "{words}: {faults:?}");
        }
        assert_eq!(claim("share=0 art priority=urgent team=a/b").unwrap_err().len(), 4);
    }
}
