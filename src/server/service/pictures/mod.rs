//! Previews and plots: of which table, whether the picture is there already, and who renders it.
//!
//! Invariant: nothing is rendered on a caller's thread or on the fitting pool, and no adapter is opened before the
//! first picture is rendered.

mod best;
mod cache;
mod desk;
mod studio;
#[cfg(test)]
mod tests;

use std::{
    sync::Arc,
    time::{Duration, Instant},
};

use serde::Serialize;
use serde_json::json;
use tokio::sync::oneshot;

pub(super) use best::Standings;
pub(super) use desk::Desk;

use super::{Service, ServiceError};
use crate::{
    files::digest::Digest,
    view::{plots::Plot, preview::Scene},
};

/// When to come back to a full queue: most pictures take less than a second.
const RETRY_FULL: Duration = Duration::from_secs(2);
/// And after one that took too long.
const RETRY_SLOW: Duration = Duration::from_secs(30);

/// What draws plots.
const CPU: &str = "cpu";

/// What is to be seen of a table.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Subject {
    /// What it does.
    Scene(Box<Scene>),
    /// The table as such.
    Plot(Plot),
}

/// A picture and what goes with it.
#[derive(Debug, Clone)]
pub struct PictureFile {
    /// The PNG file.
    pub png: Arc<Vec<u8>>,
    /// What rendered it: an adapter's name, or `cpu`.
    pub adapter: Arc<str>,
    /// Its name: the digest of subject, table, adapter and version of the program.
    pub tag: Digest,
}

/// What there is of a picture.
#[derive(Debug)]
pub enum Ordered {
    /// The caller has it, by this name; the adapter would be this one.
    Known {
        /// Its name.
        tag: Digest,
        /// What renders.
        adapter: Arc<str>,
    },
    /// It was there.
    Ready(PictureFile),
    /// It is being rendered.
    Waiting(PictureWait),
}

/// A picture to come. Dropped, it is not rendered, or not to its end.
#[derive(Debug)]
pub struct PictureWait {
    file: oneshot::Receiver<Result<PictureFile, PictureError>>,
    until: Instant,
    limit: Duration,
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
    /// Too many pictures are asked for at the same time.
    #[error("{limit} pictures are asked for already")]
    QueueFull {
        /// Most pictures that wait or are rendered.
        limit: usize,
        /// When to try again.
        retry_after: Duration,
    },
    /// It was not there in time.
    #[error("the picture was not there within {} s", .limit.as_secs_f64())]
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

impl Service {
    /// The picture of `subject` by a table, or by the best one stored. `is_known` says whether the caller has the picture
    /// of a name.
    ///
    /// # Errors
    /// See [`PictureError`].
    pub fn picture(
        &self,
        table: Option<Digest>,
        subject: Subject,
        is_known: impl Fn(Digest) -> bool,
    ) -> Result<Ordered, PictureError> {
        let core = &self.core;
        let subject = match subject {
            Subject::Scene(scene) => Subject::Scene(Box::new(scene.canonical())),
            plot @ Subject::Plot(_) => plot,
        };
        let table = match table {
            Some(table) if !core.store.blobs.contains(table) => return Err(PictureError::UnknownTable(table)),
            Some(table) => table,
            None => core.best_table()?.ok_or(PictureError::NoTable)?,
        };
        let key = name(&subject, table, None)?;
        if let Some(file) = core.desk.kept(key) {
            return Ok(if is_known(file.tag) {
                Ordered::Known { tag: file.tag, adapter: file.adapter }
            } else {
                Ordered::Ready(file)
            });
        }
        let adapter = match &subject {
            Subject::Scene(_) => core.desk.adapter(),
            Subject::Plot(_) => Some(CPU.into()),
        };
        if let Some(adapter) = adapter {
            let tag = name(&subject, table, Some(&adapter))?;
            if is_known(tag) {
                return Ok(Ordered::Known { tag, adapter });
            }
        }
        let (reply, file) = oneshot::channel();
        let limit = core.config.picture_limit;
        let until = Instant::now() + limit;
        core.desk.order(core, desk::Order { key, table, subject, until, limit, replies: vec![reply] })?;
        Ok(Ordered::Waiting(PictureWait { file, until, limit }))
    }
}

impl PictureWait {
    /// The picture, once it is there.
    ///
    /// # Errors
    /// See [`PictureError`].
    pub async fn file(self) -> Result<PictureFile, PictureError> {
        match tokio::time::timeout_at(self.until.into(), self.file).await {
            Ok(Ok(done)) => done,
            Ok(Err(_)) => Err(PictureError::Stopping),
            Err(_) => Err(too_slow(self.limit)),
        }
    }
}

fn too_slow(limit: Duration) -> PictureError {
    PictureError::TooSlow { limit, retry_after: RETRY_SLOW }
}

/// The digest of the canonical JSON of all that decides a picture's bytes. Without an adapter: of what is asked for.
fn name(subject: &Subject, table: Digest, adapter: Option<&str>) -> Result<Digest, PictureError> {
    let version = env!("CARGO_PKG_VERSION");
    let all = json!({ "subject": subject, "table": table, "adapter": adapter, "version": version });
    let text = serde_jcs::to_vec(&all).map_err(|error| PictureError::Failed(error.to_string()))?;
    Ok(Digest::of(&text))
}
