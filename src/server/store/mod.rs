//! What is kept on disk: blobs by digest, small rows, the catalogue of tables, and the migrations of all that.
//!
//! Invariant: `store` knows no HTTP and nothing of LTC; a blob and a recipe are opaque bytes here.
//!
//! ```text
//! DIR/lock                  held by the process that has the folder
//! DIR/blobs/ab/ab12...      tables, named by their digest
//! DIR/db/                   sled: jobs, shards and their results until the table is there, the catalogue
//! DIR/quarantine/           what was found damaged
//! ```

mod blob;
mod catalogue;
mod error;
mod files;
#[cfg(test)]
pub(crate) mod memory;
mod migrations;
mod open;
mod rows;
mod sled_rows;

#[cfg(test)]
pub(crate) use files::copy_folder;

pub use blob::{BlobInfo, Blobs, FileBlobs};
pub use catalogue::{Catalogue, ManifestRow, TableRow};
pub use error::StoreError;
pub use open::{Store, StoreOpenError};
pub use rows::{Batch, Row, Rows, Tree};
pub use sled_rows::SledRows;
