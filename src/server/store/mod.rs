//! What is stored on disk: blobs by digest, small rows, the catalogue of tables, and the migrations of the schema.
//!
//! Invariant: `store` knows neither HTTP nor LTC; blobs and recipes are opaque bytes here.
//!
//! ```text
//! DIR/lock                  locked by the process that has opened the folder
//! DIR/blobs/ab/ab12...      tables, named by their digest
//! DIR/db/                   sled: jobs, shards and their results until the table is stored, the catalogue
//! DIR/jobs.log              the journal of jobs, from which those that sled lost or reverted are restored
//! DIR/quarantine/           damaged files
//! ```

mod blob;
mod catalogue;
mod checks;
mod error;
mod files;
mod findings;
mod journal;
#[cfg(test)]
pub(crate) mod memory;
mod migrations;
mod numbered;
mod objects;
mod open;
mod postgres;
mod rehearsal;
#[cfg(test)]
mod reverted_test;
mod rows;
mod sled_rows;
mod tree;

#[cfg(test)]
pub(crate) use files::copy_folder;

pub use blob::{BlobInfo, Blobs, FileBlobs};
pub use catalogue::{Catalogue, ManifestRow, TableRow};
pub use checks::Checks;
pub use error::StoreError;
pub use findings::Findings;
pub use objects::{Access, ObjectBlobs, ObjectsOpenError};
pub use open::{Store, StoreOpenError};
pub(crate) use postgres::apply;
pub use postgres::{Database, DatabaseOpenError, PostgresRows};
#[cfg(test)]
pub(crate) use postgres::{test_database, throwaway};
pub use rehearsal::Rehearsal;
pub use rows::{Batch, Row, Rows, Staged};
pub use sled_rows::SledRows;
pub use tree::Tree;
