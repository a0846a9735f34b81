//! Names of jobs in documents of the service and its clients.

use std::{fmt, str::FromStr};

use serde::{Deserialize, Serialize};

use super::{
    digest::Digest,
    hex::{from_hex, to_hex},
};

/// A job's id: the first 128 bits of its recipe's digest in hex. Submitting a recipe twice therefore gives the same
/// job.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct JobId([u8; 16]);

/// The text is not a job id.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("«{0}» is not a job id; a job id is 32 hex digits")]
pub struct ParseJobIdError(pub String);

impl JobId {
    /// The id of the job for the recipe with this digest.
    #[must_use]
    pub fn of_recipe(digest: &Digest) -> Self {
        let mut id = [0; 16];
        id.copy_from_slice(&digest.as_bytes()[..16]);
        Self(id)
    }

    /// The id from 16 bytes; `None` for another number of bytes.
    #[must_use]
    pub fn from_slice(bytes: &[u8]) -> Option<Self> {
        bytes.try_into().ok().map(Self)
    }

    /// The 16 bytes, as a key.
    #[must_use]
    pub fn as_bytes(&self) -> &[u8; 16] {
        &self.0
    }
}

/// Maximum number of ids that a sentence lists.
const LISTED: usize = 20;

/// The first ids as a list in a sentence, and the number of other ids.
#[must_use]
pub fn listed(ids: &[String]) -> String {
    let more = ids.len().saturating_sub(LISTED);
    let some = ids[..ids.len() - more].join(", ");
    if more > 0 { format!("{some} and {more} more") } else { some }
}

impl fmt::Display for JobId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&to_hex(&self.0))
    }
}

impl FromStr for JobId {
    type Err = ParseJobIdError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let bytes = from_hex(&text.to_ascii_lowercase());
        bytes.and_then(|bytes| Self::from_slice(&bytes)).ok_or_else(|| ParseJobIdError(text.to_owned()))
    }
}

impl Serialize for JobId {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

impl<'de> Deserialize<'de> for JobId {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        String::deserialize(deserializer)?.parse().map_err(serde::de::Error::custom)
    }
}
/// A job's state without data, to filter lists.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum StateName {
    /// The job waits for a worker.
    Queued,
    /// A worker has started a part of the job.
    Running,
    /// The table is stored.
    Done,
    /// The job ended with an error.
    Failed,
    /// The job was cancelled.
    Cancelled,
}

impl StateName {
    /// All states.
    pub const ALL: [Self; 5] = [Self::Queued, Self::Running, Self::Done, Self::Failed, Self::Cancelled];

    /// The name in the API, in metrics and in the database.
    #[must_use]
    pub fn text(self) -> &'static str {
        ["queued", "running", "done", "failed", "cancelled"][self as usize]
    }

    /// Whether a job in this state changes only if it is submitted again.
    #[must_use]
    pub fn is_final(self) -> bool {
        matches!(self, Self::Done | Self::Failed | Self::Cancelled)
    }
}
