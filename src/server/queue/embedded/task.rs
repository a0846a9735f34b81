//! The states of a task, which fits a shard or assembles the table, and the transitions between them.

use jiff::Timestamp;
use serde::{Deserialize, Serialize};

use crate::queue::{SUSPECT_DEATHS, StaleLease};

/// The state of a task. `attempt` counts its leases and never decreases within one submission, so that a result can be
/// matched with its lease. `failures` counts the leases that ended in an error or an expiry, `deaths` those that ended with
/// the process. Both are limited.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(tag = "state", rename_all = "snake_case")]
pub(super) enum TaskState {
    /// No worker has it.
    Waiting {
        /// Leases so far.
        attempt: u32,
        /// How many of them failed.
        failures: u32,
        /// How many of them ended with the process.
        #[serde(default)]
        deaths: u32,
        /// The error of the last one that failed.
        last_error: Option<String>,
    },
    /// A worker has it.
    Leased {
        /// This lease's number.
        attempt: u32,
        /// Failures before it.
        failures: u32,
        /// Processes that ended before it while the task was leased.
        #[serde(default)]
        deaths: u32,
        /// The error of the last one that failed.
        last_error: Option<String>,
        /// The worker.
        worker: u32,
        /// When the lease expires unless the worker renews it.
        lease_until: Timestamp,
    },
    /// Its result is stored.
    Finished {
        /// Number of the lease that finished it.
        attempt: u32,
    },
}

impl TaskState {
    /// A task that has not been leased.
    pub(super) const fn new() -> Self {
        Self::Waiting { attempt: 0, failures: 0, deaths: 0, last_error: None }
    }

    /// Leases so far, the current one included.
    pub(super) fn attempt(&self) -> u32 {
        match self {
            Self::Waiting { attempt, .. } | Self::Leased { attempt, .. } | Self::Finished { attempt } => *attempt,
        }
    }

    /// Number of leases that failed, and the error of the last one.
    pub(super) fn failures(&self) -> (u32, Option<&str>) {
        match self {
            Self::Waiting { failures, last_error, .. } | Self::Leased { failures, last_error, .. } => {
                (*failures, last_error.as_deref())
            }
            Self::Finished { .. } => (0, None),
        }
    }

    /// The task under a new lease.
    pub(super) fn lease(&self, worker: u32, lease_until: Timestamp) -> Result<Self, StaleLease> {
        match self.clone() {
            Self::Waiting { attempt, failures, deaths, last_error } => {
                Ok(Self::Leased { attempt: attempt + 1, failures, deaths, last_error, worker, lease_until })
            }
            Self::Leased { .. } | Self::Finished { .. } => Err(StaleLease),
        }
    }

    /// The lease `attempt` with a later expiry.
    pub(super) fn extend(&mut self, of_attempt: u32, until: Timestamp) -> Result<(), StaleLease> {
        match self {
            Self::Leased { attempt, lease_until, .. } if *attempt == of_attempt => {
                *lease_until = until;
                Ok(())
            }
            _ => Err(StaleLease),
        }
    }

    /// The task after its lease `attempt` has delivered.
    pub(super) fn finish(&self, of_attempt: u32) -> Result<Self, StaleLease> {
        match self {
            Self::Leased { attempt, .. } if *attempt == of_attempt => Ok(Self::Finished { attempt: of_attempt }),
            _ => Err(StaleLease),
        }
    }

    /// The task after its lease `attempt` was given back unfinished, which is not a failure.
    pub(super) fn give_back(&self, of_attempt: u32) -> Result<Self, StaleLease> {
        match self.clone() {
            Self::Leased { attempt, failures, deaths, last_error, .. } if attempt == of_attempt => {
                Ok(Self::Waiting { attempt, failures, deaths, last_error })
            }
            _ => Err(StaleLease),
        }
    }

    /// The task after its lease `attempt` has failed.
    pub(super) fn fail(&self, of_attempt: u32, error: &str) -> Result<Self, StaleLease> {
        match self {
            Self::Leased { attempt, failures, deaths, .. } if *attempt == of_attempt => {
                let last_error = Some(error.to_owned());
                Ok(Self::Waiting { attempt: *attempt, failures: failures + 1, deaths: *deaths, last_error })
            }
            _ => Err(StaleLease),
        }
    }

    /// The task after the process that held its lease `attempt` has ended.
    pub(super) fn die(&self, of_attempt: u32) -> Result<Self, StaleLease> {
        match self.clone() {
            Self::Leased { attempt, failures, deaths, last_error, .. } if attempt == of_attempt => {
                Ok(Self::Waiting { attempt, failures, deaths: deaths + 1, last_error })
            }
            _ => Err(StaleLease),
        }
    }

    /// How many processes ended while it was leased.
    pub(super) fn deaths(&self) -> u32 {
        match self {
            Self::Waiting { deaths, .. } | Self::Leased { deaths, .. } => *deaths,
            Self::Finished { .. } => 0,
        }
    }

    /// Whether so many processes ended while it was leased that it may be what ends them.
    pub(super) fn is_suspect(&self) -> bool {
        self.deaths() >= SUSPECT_DEATHS
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_current_lease_changes_a_step() {
        let now = Timestamp::UNIX_EPOCH;
        let first = TaskState::new().lease(0, now).unwrap();
        assert_eq!(first.lease(1, now), Err(StaleLease), "a leased task is not leased again");
        let second = first.fail(1, "no luck").unwrap().lease(1, now).unwrap();
        assert_eq!((second.attempt(), second.failures()), (2, (1, Some("no luck"))));
        assert_eq!(second.finish(1), Err(StaleLease));
        assert_eq!(second.give_back(1), Err(StaleLease));
        assert_eq!(second.fail(1, "late"), Err(StaleLease));
        assert_eq!(second.clone().extend(1, now), Err(StaleLease));
        let third = second.give_back(2).unwrap().lease(0, now).unwrap();
        assert_eq!((third.attempt(), third.failures().0), (3, 1), "giving back is no failure");
        let finished = third.finish(3).unwrap();
        assert_eq!(finished.finish(3), Err(StaleLease));
        assert_eq!(finished.lease(0, now), Err(StaleLease));
    }

    #[test]
    fn deaths_of_the_process_are_counted_apart() {
        let now = Timestamp::UNIX_EPOCH;
        let mut task = TaskState::new().lease(0, now).unwrap().fail(1, "no luck").unwrap();
        for death in 1..=SUSPECT_DEATHS {
            assert!(!task.is_suspect());
            let leased = task.lease(0, now).unwrap();
            assert_eq!(leased.die(leased.attempt() - 1), Err(StaleLease));
            task = leased.die(leased.attempt()).unwrap();
            assert_eq!((task.deaths(), task.failures()), (death, (1, Some("no luck"))));
        }
        assert!(task.is_suspect() && task.lease(0, now).unwrap().is_suspect());
        let leased = task.lease(0, now).unwrap();
        assert_eq!(leased.fail(leased.attempt(), "again").unwrap().deaths(), SUSPECT_DEATHS);
        assert_eq!(leased.give_back(leased.attempt()).unwrap().deaths(), SUSPECT_DEATHS);
    }

    /// Rows of a service that did not count them.
    #[test]
    fn a_row_without_deaths_has_none() {
        let row = r#"{"state":"waiting","attempt":3,"failures":1,"last_error":"x"}"#;
        let task: TaskState = serde_json::from_str(row).unwrap();
        assert_eq!((task.deaths(), task.failures()), (0, (1, Some("x"))));
    }
}
