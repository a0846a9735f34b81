//! PostgreSQL: a pool of connections, the schema, and the catalogue's rows.
//!
//! Invariant: no error and no line of the log has a password; a database is named by host, port and name.

mod database;
mod failure;
mod migrations;
mod rows;
#[cfg(test)]
pub(crate) mod test_database;
#[cfg(test)]
pub(crate) mod throwaway;

pub use database::Database;
pub use failure::DatabaseOpenError;
pub use rows::PostgresRows;

pub(crate) use rows::apply;
