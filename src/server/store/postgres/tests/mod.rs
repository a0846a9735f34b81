//! Databases for tests.

use std::sync::Arc;

use super::Database;
use crate::store::{Batch, Rows as _, StoreError, Tree};

pub(crate) mod throwaway;

/// An empty database with the current schema. Prints a message and returns `None` if PostgreSQL is not installed.
pub(crate) fn database() -> Option<Arc<Database>> {
    Some(Database::open(&throwaway::empty_database()?).unwrap())
}

#[test]
fn rows_are_found_by_key_by_prefix_and_in_order() {
    let Some(database) = database() else { return };
    let rows = super::PostgresRows::new(database);
    crate::store::tests::rows_behave(&rows);
    assert!(rows.fault().is_none());
}

#[test]
fn a_role_that_cannot_write_is_not_ready() {
    let Some(url) = throwaway::empty_database() else { return };
    let owner = Database::open(&url).unwrap();
    owner.run(async |client| Ok(client.batch_execute("CREATE ROLE reader LOGIN; GRANT USAGE ON SCHEMA ltcforge TO reader; GRANT SELECT ON ALL TABLES IN SCHEMA ltcforge TO reader").await?)).unwrap();
    let reader = Database::open(&url.replace("postgres@", "reader@")).unwrap();
    let rows = super::PostgresRows::new(reader);
    assert!(rows.fault().is_some());
    let mut batch = Batch::default();
    batch.put(Tree::Tables, "a", "b");
    assert!(matches!(rows.commit(&batch), Err(StoreError::Refused(_))));
}

#[test]
fn an_operation_goes_on_after_the_server_was_started_again() {
    let Some(server) = throwaway::Server::start("") else { return };
    let rows = super::PostgresRows::new(Database::open(&server.empty_database()).unwrap());
    let mut batch = Batch::default();
    batch.put(Tree::Tables, "a", "b");
    rows.commit(&batch).unwrap();
    server.stop();
    std::thread::scope(|scope| {
        // On a busy machine, starting the server takes longer than the retries of an operation.
        let reading = scope.spawn(|| {
            loop {
                match rows.get(Tree::Tables, b"a") {
                    Err(error) if error.is_passing() => {}
                    done => return done,
                }
            }
        });
        server.start_again();
        assert_eq!(reading.join().unwrap().unwrap().unwrap(), b"b");
    });
}

#[test]
fn urls_are_refused_without_their_secrets() {
    for url in ["", "postgres://", "http://x/y", "postgres://u:hunter2@x@h/n", "postgres://u:hun/ter2@h/n"] {
        let error = Database::open(url).unwrap_err().to_string();
        assert!(error.contains("is invalid") && !error.contains("ter2"), "{error}");
    }
    let error = Database::open("postgres://u:hunter2@localhost:1/n").unwrap_err().to_string();
    assert!(error.contains("cannot be reached") && !error.contains("hunter2"), "{error}");
}
