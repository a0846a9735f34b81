//! What a job may have of the workers: it is fitted for a team.

use std::num::NonZeroU32;

use serde::{Deserialize, Serialize};

/// The team that a job is fitted for.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Claim {
    /// The team's name; empty for jobs without one, which share as one team does.
    pub team: String,
    /// The team's part of the workers, beside those of the other teams with unfinished jobs.
    pub share: NonZeroU32,
    /// Whether the job goes before those of all teams.
    pub priority: Priority,
}

/// Jobs of a higher priority are served first. One of a lower priority is served while no worker finds a task of a higher
/// one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Priority {
    /// What may wait, as a nightly build.
    Low,
    /// The usual.
    Normal,
    /// What somebody waits for.
    High,
}

impl Priority {
    /// All of them, lowest first.
    pub const ALL: [Self; 3] = [Self::Low, Self::Normal, Self::High];

    /// Its name.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Low => "low",
            Self::Normal => "normal",
            Self::High => "high",
        }
    }
}

impl Default for Claim {
    fn default() -> Self {
        Self { team: String::new(), share: NonZeroU32::MIN, priority: Priority::Normal }
    }
}

impl Claim {
    /// Whether it says no more than that there is a job.
    #[must_use]
    pub fn is_default(&self) -> bool {
        *self == Self::default()
    }
}

/// By how much a lease moves the turn of a team with a share of 1. The team whose turn is lowest is served next of those
/// that have equally much.
pub(super) const TURN: u64 = 1 << 20;

/// Who submits a job.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct Submitter {
    /// The name of his token.
    pub name: String,
    /// What his jobs may have of the workers.
    pub claim: Claim,
}
