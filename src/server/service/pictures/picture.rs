//! Pictures: their subject, their file, and the errors in place of one.

use std::{io, sync::Arc, time::Duration};

use serde::Serialize;
use serde_json::json;

use crate::service::ServiceError;
use ltcforge_files::digest::Digest;
use ltcforge_view::{
    plots::{ErrorSlice, Plot},
    preview::Scene,
};

/// The adapter that plots name: they are always drawn on the CPU.
pub(super) const CPU: &str = "cpu";

/// When to try again after a picture that took too long.
const RETRY_SLOW: Duration = Duration::from_secs(30);

/// The cost of measuring a table at one configuration, in samples of the reference: a plot of 1600 takes as long as a
/// picture of some fifty million samples.
const CONFIGURATION_COST: f64 = 32_768.0;

/// Samples of the reference that each thread of a fast CPU renders in a second, and that a fast GPU does. A scene whose
/// samples do not fit into its time is refused at once. A scene below this limit may still turn out to be too slow.
const SAMPLES_PER_CPU_THREAD: f64 = 1e7;
const SAMPLES_PER_GPU: f64 = 6e8;

/// The content of a picture.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Subject {
    /// A scene, lit by a table or without one.
    Scene(Box<Scene>),
    /// A table's numbers or errors.
    Plot(Plot),
    /// The errors of a table, as numbers in JSON.
    Errors(ErrorSlice),
}

impl Subject {
    /// The media type of its file.
    pub(crate) fn media_type(&self) -> &'static str {
        match self {
            Self::Scene(_) | Self::Plot(_) => "image/png",
            Self::Errors(_) => "application/json",
        }
    }

    /// Whether a table is part of it.
    pub(crate) fn needs_table(&self) -> bool {
        match self {
            Self::Scene(scene) => scene.needs_table(),
            Self::Plot(_) | Self::Errors(_) => true,
        }
    }

    /// How much work it is, in samples of the reference.
    pub(super) fn cost(&self) -> f64 {
        match self {
            Self::Scene(scene) => scene.cost(),
            Self::Plot(plot) => f64::from(plot.configurations()) * CONFIGURATION_COST,
            Self::Errors(slice) => f64::from(Plot::Error(*slice).configurations()) * CONFIGURATION_COST,
        }
    }

    /// Refuses a scene of more samples than `adapter` may render within `time`. An unknown adapter counts as a GPU. A
    /// plot is always accepted, because it takes seconds at most.
    pub(super) fn check_cost(&self, adapter: Option<&str>, time: Duration) -> Result<(), PictureError> {
        // The adapter of lavapipe, which renders on the CPU too, is called llvmpipe.
        let is_cpu = adapter.is_some_and(|name| name == CPU || name.starts_with("llvmpipe"));
        let cpu = || SAMPLES_PER_CPU_THREAD * rayon::current_num_threads() as f64;
        let limit = time.as_secs_f64() * if is_cpu { cpu() } else { SAMPLES_PER_GPU };
        match self {
            Self::Scene(scene) if scene.cost() > limit => {
                Err(PictureError::TooExpensive { samples: scene.cost(), limit })
            }
            Self::Scene(_) | Self::Plot(_) | Self::Errors(_) => Ok(()),
        }
    }
}

/// A rendered picture.
#[derive(Debug, Clone)]
pub struct PictureFile {
    /// The PNG file, or the JSON.
    pub bytes: Arc<Vec<u8>>,
    /// The renderer: the name of an adapter, or `cpu`.
    pub adapter: Arc<str>,
    /// The digest of subject, table, adapter and program version.
    pub tag: Digest,
}

/// The reason that there is no picture.
#[derive(Debug, Clone, thiserror::Error)]
pub enum PictureError {
    /// There is no such table.
    #[error("no table with the digest {0} is stored")]
    UnknownTable(Digest),
    /// No table is stored.
    #[error("no table is stored")]
    NoTable,
    /// Too many pictures are requested at the same time.
    #[error(
        "{limit} pictures are waiting or being rendered already; `--picture-queue` of the service raises the limit"
    )]
    QueueFull {
        /// The most pictures that may wait or be rendered.
        limit: usize,
        /// When to try again.
        retry_after: Duration,
    },
    /// The scene does not go with the table's scattering model.
    #[error("{0}")]
    OtherBrdf(String),
    /// The scene has more samples than are accepted.
    #[error(
        "the picture takes {:.1} million samples, and this service accepts {:.1} million; fewer pixels or samples take \
        less, and `--picture-seconds` of the service raises the limit",
        .samples / 1e6,
        .limit / 1e6
    )]
    TooExpensive {
        /// Samples of the picture.
        samples: f64,
        /// The most samples that are accepted.
        limit: f64,
    },
    /// Rendering it took too long.
    #[error(
        "the picture was not rendered within {} s; `--picture-seconds` of the service raises the limit",
        .limit.as_secs_f64()
    )]
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

/// The error of a thread that did not start.
pub(super) fn no_thread(error: &io::Error) -> PictureError {
    ServiceError::Lacking(format!("the render thread did not start: {error}")).into()
}

/// The digest of the canonical JSON of everything that determines a picture's bytes; without an adapter, of what is
/// requested.
pub(super) fn tag(subject: &Subject, table: Option<Digest>, adapter: Option<&str>) -> Result<Digest, PictureError> {
    let version = env!("CARGO_PKG_VERSION");
    let all = json!({ "subject": subject, "table": table, "adapter": adapter, "version": version });
    let text = serde_jcs::to_vec(&all).map_err(|error| PictureError::Failed(error.to_string()))?;
    Ok(Digest::of(&text))
}
