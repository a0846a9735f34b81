//! How many connections a process has, and what each sets for itself.

use std::{num::NonZeroUsize, time::Duration};

/// Settings of every connection: each statement is to use indexes, whatever the statistics and the arguments; it is planned once
/// for a connection, and compiling it is not worth while. The last ends a statement whose connection was given up.
const SETTINGS: &str = "SET jit = off; SET enable_seqscan = off; SET enable_bitmapscan = off; SET enable_hashjoin = off; \
    SET enable_mergejoin = off; SET plan_cache_mode = force_generic_plan; SET client_connection_check_interval = 5000";

/// Connections of a replica, at most, unless it is told otherwise: its callers share them.
pub const REPLICA_CONNECTIONS: NonZeroUsize = NonZeroUsize::new(16).unwrap();

/// Connections of a worker, at most, unless it is told otherwise. Whatever its threads, one of them leases and one stores
/// results; the third is for what comes between, such as the renewal of leases.
pub const WORKER_CONNECTIONS: NonZeroUsize = NonZeroUsize::new(3).unwrap();

/// How long the server lets this process's statements and transactions take; `None` for any time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct DatabaseTimeouts {
    /// A statement, `statement_timeout`.
    pub statement: Option<Duration>,
    /// A transaction that waits for this process, `idle_in_transaction_session_timeout`.
    pub idle_in_transaction: Option<Duration>,
}

impl Default for DatabaseTimeouts {
    /// More than an operation may take here, 20 s: the server ends what this process does not end any more.
    fn default() -> Self {
        Self { statement: Some(Duration::from_secs(30)), idle_in_transaction: Some(Duration::from_secs(60)) }
    }
}

impl DatabaseTimeouts {
    /// None, for commands that look at all there is.
    pub const NONE: Self = Self { statement: None, idle_in_transaction: None };

    /// The statements that make the settings of a connection.
    pub(super) fn statements(self) -> String {
        let milliseconds = |time: Option<Duration>| time.map_or(0, |time| time.as_millis().clamp(1, i32::MAX as u128));
        format!(
            "{SETTINGS}; SET statement_timeout = {}; SET idle_in_transaction_session_timeout = {}",
            milliseconds(self.statement),
            milliseconds(self.idle_in_transaction)
        )
    }
}

#[cfg(test)]
mod tests {
    use super::{
        super::{Database, tests::throwaway},
        *,
    };
    use crate::store::StoreError;

    /// A pooler that hands out connections by the transaction has to make these settings itself.
    #[test]
    fn the_document_on_poolers_has_the_settings_of_connections() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/scale.md");
        let document = std::fs::read_to_string(path).unwrap();
        let query = format!("connect_query='{}'", DatabaseTimeouts::default().statements());
        assert!(document.contains(&query), "{query}");
    }

    #[test]
    fn the_server_ends_statements_and_transactions_that_take_too_long() {
        let Some(url) = throwaway::empty_database() else { return };
        let short = Some(Duration::from_millis(50));
        let slow = Database::open_with(
            &url,
            WORKER_CONNECTIONS,
            DatabaseTimeouts { statement: short, ..DatabaseTimeouts::NONE },
        )
        .unwrap();
        let slept = slow.block_on(async {
            let client = slow.client().await?;
            client.batch_execute("SELECT pg_sleep(60)").await.map_err(StoreError::from)
        });
        let Err(StoreError::Unavailable(reason)) = slept else { panic!("{slept:?}") };
        assert!(reason.contains("statement timeout"), "{reason}");
        let idle = DatabaseTimeouts { idle_in_transaction: short, ..DatabaseTimeouts::NONE };
        let idle = Database::open_with(&url, WORKER_CONNECTIONS, idle).unwrap();
        let waited = idle.block_on(async {
            let mut client = idle.client().await?;
            let transaction = client.transaction().await?;
            tokio::time::sleep(Duration::from_millis(500)).await;
            transaction.batch_execute("SELECT 1").await.map_err(StoreError::from)
        });
        assert!(matches!(waited, Err(StoreError::Unavailable(_))), "{waited:?}");
        // Both go on.
        for database in [slow, idle] {
            database.run(async |client| Ok(client.batch_execute("SELECT 1").await?)).unwrap();
        }
    }
}
