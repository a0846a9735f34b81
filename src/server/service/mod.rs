//! The use cases: submit, work, download, preview.
//!
//! Invariant: nothing is fitted on a caller's thread; fitting runs on the one rayon pool that the service owns.
//! Nothing is rendered there either.

mod api;
mod core;
mod downloads;
mod engine;
mod forecast;
mod open;
mod pictures;
mod speed;
mod submit;
#[cfg(test)]
mod tests;
mod watch;
mod work;

pub use self::core::Service;
use crate::files::manifest;
pub use crate::files::manifest::{manifest_json, table_report};
pub use crate::server::store::TableRow;
pub use api::{
    Config, Expected, JobNews, Metrics, OpenError, Page, PictureCounts, ServiceError, Submission, SubmitError,
};
pub use pictures::{Ordered, PictureError, PictureFile, PictureWait, Subject};
