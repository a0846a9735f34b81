//! PostgreSQL: a pool of connections, the schema, and the catalogue's rows.
//!
//! Invariant: no error and no log line has a password; they name a database by host, port and name.

mod database;
mod failure;
mod migrations;
mod room;
mod rows;
mod settings;
#[cfg(test)]
pub(crate) mod tests;

pub use database::Database;
pub use failure::DatabaseOpenError;
pub use rows::PostgresRows;
pub use settings::{DatabaseTimeouts, REPLICA_CONNECTIONS, WORKER_CONNECTIONS};

pub(crate) use rows::apply;
