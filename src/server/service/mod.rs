//! The use cases: submit, work, download, export, preview.
//!
//! Invariant: nothing is fitted or rendered on a caller's thread. Tables are fitted by threads of the
//! service, and assembled, measured and exported on a rayon pool; pictures are rendered on a thread of their own.

mod api;
mod backend;
mod backlog;
mod backup;
mod brdfs;
mod check;
mod check_shared;
mod cluster;
mod compressed;
mod cursor;
mod downloads;
mod exports;
mod find_brdf;
mod forecast;
mod light_textures;
mod migrate;
mod open;
mod pictures;
mod pins;
mod plans;
mod published;
mod reconcile;
mod removal;
mod retention;
mod scheduler;
mod scrub;
mod speed;
mod state;
mod stored_files;
mod submit;
mod sweep;
mod tables;
#[cfg(test)]
mod tests;
mod uses;
mod watch;
mod work;

pub use crate::store::{
    Checked, Copied, DatabaseTimeouts, REPLICA_CONNECTIONS, SHORT_BYTES, TableRow, WORKER_CONNECTIONS,
};
pub use api::{
    Backlog, Config, Expected, Foreseen, JobSnapshot, Metrics, OpenError, Page, PictureCounts, PictureLimits,
    ServiceError, SubmitError, SubmitReply,
};
pub use backup::{back_up, restore};
pub use brdfs::{DeleteBrdfError, StoreBrdfError, StoredBrdf};
pub use check::{CheckReport, check};
pub use check_shared::{Disagreements, SharedReport, check_shared};
pub use cluster::{DatabaseUrl, Shared};
pub use compressed::Zstd;
pub use cursor::{CursorError, JobCursor, TableCursor};
pub use exports::{ExportFailure, ExportedFile, MadeExport};
pub use light_textures::{
    DeleteLightTextureError, LIGHT_TEXTURE_PIXELS, LightTextureRequest, StoreLightTextureError, StoredLightTexture,
};
pub use migrate::{Migrated, migrate};
pub use pictures::{PendingPicture, PictureError, PictureFile, PictureReply, Subject};
pub use pins::{LockedTable, ParsePinNameError, PinError, PinName, PinnedLock, TablePin};
pub use plans::{PlanError, Planned, SCENE_LIMIT_BYTES, SceneForm};
pub use published::published_table;
pub use reconcile::Reconciled;
pub use removal::DeleteTableError;
pub use retention::{Going, GoingReason, Kept, KeptReason};
pub use state::Service;
pub use stored_files::FileRow;
pub use sweep::{Removal, Swept, sweep, sweep_folder};
pub use tables::FileKind;
pub use uses::{RemovalReason, RemovedTable};
