//! Blobs in an object store, with a bounded cache on disk.
//!
//! Invariant: nothing depends on conditional puts, which not every server supports. An object is named by the digest of
//! its bytes, written before a row makes it known, and verified each time it is read.

mod blobs;
mod cache;
mod connect;

pub(super) use blobs::IDENTITY;
pub use blobs::ObjectBlobs;
pub use connect::{Access, ObjectsOpenError};
