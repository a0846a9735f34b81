//! A server without room for another connection: told once, and waited for.

use std::{
    sync::{Mutex, PoisonError},
    time::Duration,
};

use tokio::time::Instant;

/// From a refusal to the next try, at least: each costs the server a process.
const PAUSE: Duration = Duration::from_secs(2);

/// Refusals that are closer together are told once.
const TOLD_ONCE: Duration = Duration::from_secs(60);

/// When the server last refused a connection because it had as many as it may have.
#[derive(Debug, Default)]
pub(super) struct Room(Mutex<Option<Instant>>);

impl Room {
    /// Records that the server refused a connection, and tells what helps. `database` is its name, `most` the connections of the
    /// pool.
    pub(super) fn refused(&self, database: &str, most: usize, reason: &str) {
        let before = self.0.lock().unwrap_or_else(PoisonError::into_inner).replace(Instant::now());
        if before.is_none_or(|before| TOLD_ONCE <= before.elapsed()) {
            tracing::warn!("{}", told(database, most, reason));
        }
    }

    /// Whether there was no room a moment ago.
    pub(super) fn was_lacking(&self) -> bool {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).is_some_and(|last| last.elapsed() < PAUSE)
    }

    /// Returns once the server may be asked for a connection again, or once `is_needless`.
    pub(super) async fn wait(&self, is_needless: impl Fn() -> bool) {
        while self.was_lacking() && !is_needless() {
            tokio::time::sleep(PAUSE / 100).await;
        }
    }
}

/// What is lacking, and what helps.
fn told(database: &str, most: usize, reason: &str) -> String {
    let limit = if reason.contains("for role") {
        "the role's CONNECTION LIMIT"
    } else if reason.contains("for database") {
        "the database's CONNECTION LIMIT"
    } else {
        "PostgreSQL's max_connections"
    };
    format!(
        "{database} has no room for another connection: {reason}; this process waits and goes on. Raise {limit}, run fewer \
         processes, or give them a smaller --database-connections: here it is {most}, beside one that listens"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_limit_that_was_met_is_named() {
        for (reason, limit) in [
            ("sorry, too many clients already", "PostgreSQL's max_connections"),
            ("remaining connection slots are reserved for non-replication superuser connections", "max_connections"),
            ("too many connections for role \"farm\"", "the role's CONNECTION LIMIT"),
            ("too many connections for database \"ltc\"", "the database's CONNECTION LIMIT"),
        ] {
            let told = told("the database ltc on h:5432", 3, reason);
            assert!(told.contains(&format!("{reason}; this process waits")) && told.contains(limit), "{told}");
            assert!(told.ends_with("here it is 3, beside one that listens"), "{told}");
        }
    }

    #[test]
    fn a_server_without_room_is_asked_again_after_a_pause_or_not_at_all() {
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
        runtime.unwrap().block_on(async {
            let room = Room::default();
            assert!(!room.was_lacking());
            room.refused("the database", 1, "too many clients");
            room.wait(|| true).await;
            assert!(room.was_lacking(), "a connection came back");
            room.wait(|| false).await;
            assert!(!room.was_lacking());
        });
    }
}
