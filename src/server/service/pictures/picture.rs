//! What a picture shows, its file, and why there may be none.

use std::{sync::Arc, time::Duration};

use serde::Serialize;
use serde_json::json;

use crate::{
    files::digest::Digest,
    server::service::ServiceError,
    view::{plots::Plot, preview::Scene},
};

/// The adapter that plots name: they are always drawn on the CPU.
pub(super) const CPU: &str = "cpu";

/// When to try again after a picture that took too long.
const RETRY_SLOW: Duration = Duration::from_secs(30);

/// What a picture of a table shows.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Subject {
    /// A scene rendered with the table.
    Scene(Box<Scene>),
    /// The table's numbers or errors.
    Plot(Plot),
}

/// A rendered picture.
#[derive(Debug, Clone)]
pub struct PictureFile {
    /// The PNG file.
    pub png: Arc<Vec<u8>>,
    /// What rendered it: the name of an adapter, or `cpu`.
    pub adapter: Arc<str>,
    /// The digest of subject, table, adapter and program version.
    pub tag: Digest,
}

/// Why there is no picture.
#[derive(Debug, Clone, thiserror::Error)]
pub enum PictureError {
    /// There is no such table.
    #[error("no table with the digest {0} is stored")]
    UnknownTable(Digest),
    /// There is no table at all.
    #[error("no table is stored")]
    NoTable,
    /// Too many pictures are requested at the same time.
    #[error("{limit} pictures are waiting or being rendered already")]
    QueueFull {
        /// Most pictures that may wait or be rendered.
        limit: usize,
        /// When to try again.
        retry_after: Duration,
    },
    /// It was not ready in time.
    #[error("the picture was not ready within {} s", .limit.as_secs_f64())]
    TooSlow {
        /// How long it may take.
        limit: Duration,
        /// When to try again.
        retry_after: Duration,
    },
    /// The service is stopping.
    #[error("the service is stopping")]
    Stopping,
    /// The renderer failed.
    #[error("the picture could not be rendered: {0}")]
    Failed(String),
    /// The table could not be read.
    #[error(transparent)]
    Store(#[from] ServiceError),
}

impl PictureError {
    /// The error of a picture that took longer than `limit`.
    pub(super) fn too_slow(limit: Duration) -> Self {
        Self::TooSlow { limit, retry_after: RETRY_SLOW }
    }
}

/// The digest of the canonical JSON of everything that determines a picture's bytes; without an adapter, of what is
/// requested.
pub(super) fn tag(subject: &Subject, table: Digest, adapter: Option<&str>) -> Result<Digest, PictureError> {
    let version = env!("CARGO_PKG_VERSION");
    let all = json!({ "subject": subject, "table": table, "adapter": adapter, "version": version });
    let text = serde_jcs::to_vec(&all).map_err(|error| PictureError::Failed(error.to_string()))?;
    Ok(Digest::of(&text))
}
