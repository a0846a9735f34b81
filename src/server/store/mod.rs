//! The data on disk: blobs by digest, small rows, the catalogue of tables, and the migrations of the schema.
//!
//! Invariant: `store` knows neither HTTP nor LTC; blobs and recipes are opaque bytes here.
//!
//! ```text
//! DIR/lock                  locked by the process that has opened the folder
//! DIR/blobs/ab/ab12...      tables, named by their digest
//! DIR/jobs.log              the journal of jobs and pins
//! DIR/db/                   sled: shards and their results until the table is stored, the catalogue of the tables
//! DIR/quarantine/           damaged files
//! ```
//!
//! Tables and the journal are the truth. Without its database, a store makes the catalogue again from the tables, and
//! fits again the shards of unfinished jobs.

mod backup;
mod blob;
mod catalogue;
mod certificates;
mod damage;
mod dry_run;
mod error;
mod file_blobs;
mod files;
mod journal;
mod local_rows;
mod migrations;
mod objects;
mod open;
mod pair;
mod postgres;
mod rows;
mod sled_rows;
#[cfg(test)]
mod tests;
mod tree;
mod verified;

#[cfg(test)]
pub(crate) use files::copy_folder;

pub use backup::{Copied, copy_store};
pub use blob::{BlobInfo, Blobs, Checked, SHORT_BYTES};
pub use catalogue::{Catalogue, ManifestRow, TableRow, age_key};
pub use damage::Damage;
pub use dry_run::DryRun;
pub use error::StoreError;
pub use file_blobs::FileBlobs;
pub use objects::{Access, ObjectBlobs, ObjectsOpenError};
pub use open::{ReopenCheck, Store, StoreOpenError};
pub use pair::{PairError, pair};
pub(crate) use postgres::apply;
#[cfg(test)]
pub(crate) use postgres::tests::{self as test_database, throwaway};
pub use postgres::{
    Database, DatabaseOpenError, DatabaseTimeouts, PostgresRows, REPLICA_CONNECTIONS, WORKER_CONNECTIONS,
};
pub use rows::{Batch, Condition, Row, Rows, Staged};
pub use sled_rows::SledRows;
#[cfg(test)]
pub(crate) use tests::memory;
pub use tree::Tree;
