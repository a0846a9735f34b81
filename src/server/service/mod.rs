//! The use cases: submit, work, download, export, preview.
//!
//! Invariant: nothing is fitted or rendered on a caller's thread. Workers fit; a rayon pool assembles, measures and
//! exports; pictures are rendered on blocking threads.

mod brdfs;
mod catalogue;
mod config;
mod cursor;
mod errors;
mod evict;
mod exports;
mod files;
mod fitter;
mod forecast;
mod hub;
mod open;
mod pictures;
mod plans;
mod published;
mod render;
mod running;
mod state;
mod submit;
mod tables;
#[cfg(test)]
mod tests;
mod watch;
mod work;

pub use brdfs::{StoreBrdfError, StoredBrdf};
pub use catalogue::{FileRow, TableRow};
pub use config::Config;
#[cfg(feature = "cluster")]
pub use config::{DatabaseUrl, Shared};
pub use cursor::{CursorError, JobCursor, TableCursor};
pub use errors::{DeleteError, OpenError, ServiceError, SubmitError};
pub use exports::{ExportFailure, ExportedFile, MadeExport};
pub use files::FileKind;
pub use forecast::Expected;
pub use hub::JobSnapshot;
pub use pictures::{PictureCounts, PictureError, PictureFile, Subject};
pub use plans::{PlanError, Planned, SCENE_LIMIT_BYTES, SceneForm};
pub use published::published_table;
pub use state::{Metrics, Service};
pub use submit::{Foreseen, SubmitReply};
pub use tables::{ListedTable, Page};
