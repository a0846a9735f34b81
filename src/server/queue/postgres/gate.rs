//! How many leases of many tasks the database works on at once.

use tokio_postgres::{Client, Error, Row, Statement, error::SqlState, types::ToSql};

/// First half of the number of an advisory lock: «leas» in ASCII. The second half is the place, from 0.
pub(super) const GATE: i32 = 0x6c65_6173;

/// Leases of so many tasks wait for a place. Those of fewer serve few jobs.
pub(super) const MANY: i64 = 8;

/// Such leases at once, of all processes. Each looks for the jobs to serve, and passes over those that another is serving;
/// with many at once it would pass over most of them. Four keep a server busy while each waits for its disk.
pub(super) const PLACES: i32 = 4;

/// Asks for `statement` in a transaction of its own, when one of the places is free.
///
/// All is sent at once, so that no lock is held while the process does something else. If the connection breaks in between,
/// the server ends the transaction after five seconds. Who waits for two seconds goes on without a place: only speed
/// depends on it.
pub(super) async fn query(
    client: &Client,
    statement: &Statement,
    parameters: &[&(dyn ToSql + Sync)],
) -> Result<Vec<Row>, Error> {
    let enter = format!(
        "BEGIN; SET LOCAL lock_timeout = '2s'; SET LOCAL idle_in_transaction_session_timeout = '5s';
        SELECT pg_advisory_xact_lock({GATE}, floor(random() * {PLACES})::integer)"
    );
    let (entered, rows, left) = tokio::join!(
        biased;
        client.batch_execute(&enter),
        client.query(statement, parameters),
        client.batch_execute("COMMIT"),
    );
    match entered {
        Err(error) if error.code() == Some(&SqlState::LOCK_NOT_AVAILABLE) => client.query(statement, parameters).await,
        entered => {
            entered?;
            let rows = rows?;
            left?;
            Ok(rows)
        }
    }
}
