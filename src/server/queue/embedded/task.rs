//! A task, which fits a shard or assembles the table, and its states.

use std::time::Duration;

use serde::{Deserialize, Serialize};

use crate::queue::SUSPECT_DEATHS;

/// A task and the outcome of its leases. Failures and deaths are limited.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Task {
    /// Leases so far, the current one included.
    pub(super) attempt: u32,
    /// How many of them ended in an error or an expiry.
    #[serde(default)]
    pub(super) failures: u32,
    /// How many of them ended with the process.
    #[serde(default)]
    pub(super) deaths: u32,
    #[serde(flatten)]
    pub(super) state: TaskState,
}

/// The state of a task.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(tag = "state", rename_all = "snake_case")]
pub(super) enum TaskState {
    /// No worker has it.
    #[default]
    Waiting,
    /// A worker has it.
    Leased {
        /// When the lease expires unless the worker renews it, by the steady clock.
        #[serde(skip)]
        until: Duration,
        /// Its name.
        #[serde(skip)]
        name: u64,
    },
    /// Its result is stored.
    Finished,
}

impl Task {
    /// Whether so many processes ended while it was leased that it may be the cause.
    pub(super) fn is_suspect(&self) -> bool {
        self.deaths >= SUSPECT_DEATHS
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_of_earlier_versions_are_read() {
        let leased = r#"{"state":"leased","attempt":3,"failures":1,"deaths":2,"last_error":"x","worker":1,
            "lease_until":"2024-01-01T00:00:00Z"}"#;
        let state = TaskState::Leased { until: Duration::ZERO, name: 0 };
        assert_eq!(serde_json::from_str::<Task>(leased).unwrap(), Task { attempt: 3, failures: 1, deaths: 2, state });
        let finished = serde_json::from_str::<Task>(r#"{"state":"finished","attempt":2}"#).unwrap();
        assert_eq!(finished, Task { attempt: 2, state: TaskState::Finished, ..Task::default() });
        // Deaths were not always counted.
        let waiting = serde_json::from_str::<Task>(r#"{"state":"waiting","attempt":3,"failures":1,"last_error":"x"}"#);
        assert_eq!(waiting.unwrap(), Task { attempt: 3, failures: 1, ..Task::default() });
        assert_eq!(serde_json::from_str::<Task>(&serde_json::to_string(&finished).unwrap()).unwrap(), finished);
    }
}
