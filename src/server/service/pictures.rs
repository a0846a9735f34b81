//! Pictures and plots: their subjects, their errors, and their cache. The module `render` renders them.

use std::{
    sync::{Arc, Mutex, MutexGuard, PoisonError},
    time::Duration,
};

use bytes::Bytes;
use quick_cache::{Weighter, sync::Cache};
use serde::Serialize;
use tokio::sync::Semaphore;

use super::ServiceError;
use ltcforge_files::digest::Digest;
use ltcforge_view::{
    plots::{ErrorSlice, Plot},
    preview::{Adapter, Preview, Scene, ShaderTable},
};

/// The adapter of pictures that are always drawn on the CPU.
pub(super) const CPU: &str = "cpu";
/// Maximum number of pictures that wait or are being rendered.
pub(super) const MOST_WAITING: usize = 9;
/// Maximum bytes of pictures in memory.
const KEPT_BYTES: u64 = 64 << 20;
/// Number of pictures that the cache expects. For many more, it would split its bytes into parts that are too small for
/// a large picture.
const KEPT: usize = 32;
/// Reference samples per second on a thread of a fast CPU, and on a fast GPU. A scene with too many samples for the
/// time limit is refused at once.
const SAMPLES_PER_CPU_THREAD: f64 = 1e7;
const SAMPLES_PER_GPU: f64 = 6e8;

/// The content of a picture.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Subject {
    /// A scene, rendered with or without a table.
    Scene(Box<Scene>),
    /// A plot of a table's numbers or errors.
    Plot(Plot),
    /// The errors of a table, as numbers in JSON.
    Errors(ErrorSlice),
}

impl Subject {
    /// The media type of the picture's file.
    pub(crate) fn media_type(&self) -> &'static str {
        match self {
            Self::Scene(_) | Self::Plot(_) => "image/png",
            Self::Errors(_) => "application/json",
        }
    }

    pub(crate) fn needs_table(&self) -> bool {
        match self {
            Self::Scene(scene) => scene.needs_table(),
            Self::Plot(_) | Self::Errors(_) => true,
        }
    }
}

/// A rendered picture.
#[derive(Debug, Clone)]
pub struct PictureFile {
    /// The PNG or JSON file.
    pub bytes: Bytes,
    /// The renderer: the name of an adapter, or `cpu`.
    pub adapter: Arc<str>,
    /// The digest of the bytes.
    pub digest: Digest,
}

/// Number of pictures since the start, by how they ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct PictureCounts {
    /// Rendered pictures.
    pub done: u64,
    /// Pictures for which the renderer or the storage failed.
    pub failed: u64,
    /// Pictures that were stopped, because the caller left, the time ran out or the service stopped.
    pub given_up: u64,
    /// Pictures that were refused, because too many waited or they had too many samples.
    pub refused: u64,
}

/// Why there is no picture.
#[derive(Debug, Clone, thiserror::Error)]
pub enum PictureError {
    /// The table is not stored.
    #[error("no table with the digest {0} is stored")]
    UnknownTable(Digest),
    /// The picture needs a table, and no table is stored.
    #[error("no table is stored")]
    NoTable,
    /// Too many pictures are waiting. The values are the limit, and when to try again.
    #[error("{0} pictures are already waiting or being rendered; try again later")]
    QueueFull(usize, Duration),
    /// The picture does not support this table, for example because of its scattering model.
    #[error("{0}")]
    OtherBrdf(String),
    /// The scene has too many samples. The values are its samples, and the limit.
    #[error(
        "the picture needs {:.1} million samples, and this service accepts {:.1} million; request fewer pixels or \
        samples, or raise `--picture-seconds` of the service",
        .0 / 1e6,
        .1 / 1e6
    )]
    TooExpensive(f64, f64),
    /// Rendering took too long. The values are the limit, and when to try again.
    #[error(
        "the picture was not rendered within {} s; `--picture-seconds` of the service raises the limit",
        .0.as_secs_f64()
    )]
    TooSlow(Duration, Duration),
    /// The renderer failed.
    #[error("the picture could not be rendered: {0}")]
    Failed(String),
    /// The table could not be read, or the service is stopping.
    #[error(transparent)]
    Store(#[from] ServiceError),
}

/// Counts the bytes of a picture's file.
#[derive(Debug, Clone)]
pub(super) struct PictureBytes;

impl Weighter<Digest, PictureFile> for PictureBytes {
    fn weight(&self, _: &Digest, file: &PictureFile) -> u64 {
        file.bytes.len() as u64
    }
}

/// The renderer, and the cached pictures.
#[derive(Debug)]
pub(super) struct Pictures {
    pub(super) limit: Duration,
    pub(super) cache: Cache<Digest, PictureFile, PictureBytes>,
    /// A permit for each picture that may wait or be rendered.
    pub(super) places: Arc<Semaphore>,
    /// A single permit, because one picture is rendered at a time.
    pub(super) turn: Arc<Semaphore>,
    renderer: Mutex<Renderer>,
    counts: Mutex<PictureCounts>,
}

/// The renderer. The rendering thread takes its parts out, and puts them back when it ends. A thread that hangs never
/// puts them back.
#[derive(Debug)]
pub(super) struct Renderer {
    pub(super) adapter: Adapter,
    pub(super) preview: Option<Preview>,
    /// The table that was used last.
    pub(super) table: Option<(Digest, Arc<ShaderTable>)>,
    /// The name of the adapter that rendered the last scene.
    pub(super) name: Option<Arc<str>>,
}

impl Pictures {
    pub(super) fn new(adapter: Adapter, limit: Duration) -> Self {
        let name = (adapter == Adapter::Cpu).then(|| CPU.into());
        Self {
            limit,
            cache: Cache::with_weighter(KEPT, KEPT_BYTES, PictureBytes),
            places: Arc::new(Semaphore::new(MOST_WAITING)),
            turn: Arc::new(Semaphore::new(1)),
            renderer: Mutex::new(Renderer { adapter, preview: None, table: None, name }),
            counts: Mutex::default(),
        }
    }

    /// Number of pictures, by how they ended.
    pub(super) fn counts(&self) -> PictureCounts {
        *self.counts.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub(super) fn renderer(&self) -> MutexGuard<'_, Renderer> {
        self.renderer.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub(super) fn count<T>(&self, outcome: &Result<T, PictureError>) {
        let mut counts = self.counts.lock().unwrap_or_else(PoisonError::into_inner);
        *match outcome {
            Ok(_) => &mut counts.done,
            Err(PictureError::TooSlow(..) | PictureError::Store(ServiceError::Stopping)) => &mut counts.given_up,
            Err(PictureError::QueueFull(..) | PictureError::TooExpensive(..)) => &mut counts.refused,
            Err(_) => &mut counts.failed,
        } += 1;
    }

    /// Refuses a scene with more samples than the adapter can render within the time limit. An unknown adapter counts
    /// as a GPU. Plots are never refused, because a plot takes a few seconds at most.
    pub(super) fn check_cost(&self, subject: &Subject) -> Result<(), PictureError> {
        let Subject::Scene(scene) = subject else { return Ok(()) };
        // Lavapipe also renders on the CPU. Its adapter is called llvmpipe.
        let is_cpu = self.renderer().name.as_ref().is_some_and(|name| **name == *CPU || name.starts_with("llvmpipe"));
        let cpu = SAMPLES_PER_CPU_THREAD * rayon::current_num_threads() as f64;
        let limit = self.limit.as_secs_f64() * if is_cpu { cpu } else { SAMPLES_PER_GPU };
        let samples = scene.cost();
        if samples > limit { Err(PictureError::TooExpensive(samples, limit)) } else { Ok(()) }
    }
}
