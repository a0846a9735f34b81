//! PostgreSQL: a pool of connections, the schema, and rows.
//!
//! Invariant: errors and log lines contain no password. They identify a database by its name, host and port.

mod database;
mod failure;
mod migrations;
mod rows;
#[cfg(test)]
pub(crate) mod tests;

pub use database::Database;
pub use rows::PostgresRows;
pub(crate) use rows::{apply, seal_result, unseal_result};
