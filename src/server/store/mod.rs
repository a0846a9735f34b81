//! The stored data: blobs, named by their digest, and small rows in a database.
//!
//! Invariant: `store` knows neither HTTP nor LTC. Blobs and recipes are opaque bytes here.
//!
//! ```text
//! DIR/lock                  locked by the process that has opened the folder
//! DIR/blobs/ab/ab12...      tables and BRDFs, named by their digest
//! DIR/db/                   sled: jobs, and the catalogue of tables
//! DIR/quarantine/           damaged files
//! ```
//!
//! Blobs are the primary data. Everything in `db` except the jobs can be computed again. A damaged `db` is moved to
//! quarantine.

mod blobs;
#[cfg(feature = "cluster")]
mod certificates;
mod error;
mod files;
mod folder;
mod memory;
mod migrations;
#[cfg(feature = "cluster")]
mod objects;
mod open;
#[cfg(feature = "cluster")]
mod postgres;
mod rows;
mod seal;
mod sled_rows;
#[cfg(test)]
mod tests;
#[cfg(feature = "cluster")]
mod threads;
mod tree;

pub use blobs::{BlobInfo, Blobs};
#[cfg(feature = "cluster")]
pub use error::ConnectError;
pub use error::{OpenError, StoreError};
pub use folder::FolderBlobs;
pub use memory::MemoryRows;
#[cfg(feature = "cluster")]
pub use objects::ObjectBlobs;
pub use open::{Store, open};
#[cfg(all(test, feature = "cluster"))]
pub(crate) use postgres::tests as test_database;
#[cfg(feature = "cluster")]
pub use postgres::{Database, PostgresRows};
#[cfg(feature = "cluster")]
pub(crate) use postgres::{apply, seal_result, unseal_result};
pub use rows::{Batch, Row, Rows};
pub use sled_rows::SledRows;
#[cfg(test)]
pub(crate) use tests::power::PowerRows;
pub use tree::Tree;

/// The message when the disk of the data folder is full.
const DISK_FULL: &str = "the disk of the data folder is full; free some space";
