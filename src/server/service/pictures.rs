//! Pictures and plots: one is rendered at a time, on a blocking thread, within a time limit, and kept in a cache.

use std::{
    sync::{
        Arc, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
    time::{Duration, Instant},
};

use bytes::Bytes;
use quick_cache::{Weighter, sync::Cache};
use serde::Serialize;
use serde_json::json;
use tokio::sync::{OwnedSemaphorePermit, Semaphore};

use super::{FileKind, Service, ServiceError, state::State};
use ltcforge_files::digest::Digest;
use ltcforge_fit::Table;
use ltcforge_view::{
    picture::Picture,
    plots::{ErrorSlice, Plot, error_numbers_while},
    preview::{Adapter, Preview, PreviewError, Scene, ShaderTable, TexelFormat},
};

/// The adapter of pictures that are always drawn on the CPU.
const CPU: &str = "cpu";
/// Number of pictures that may wait or be rendered.
const MOST_WAITING: usize = 9;
/// When to try again if that many wait: most pictures take less than a second.
const RETRY_FULL: Duration = Duration::from_secs(2);
/// When to try again after a picture that took too long.
const RETRY_SLOW: Duration = Duration::from_secs(30);
/// How long past its limit a picture may be rendered before its driver counts as hung. The renderer itself gives up a
/// hanging GPU after half of this time.
const HUNG_AFTER: Duration = Duration::from_secs(20);
/// Bytes of pictures that are kept in memory.
const KEPT_BYTES: u64 = 64 << 20;
/// Number of pictures that the cache expects. With more it would split its bytes into parts too small for a large one.
const KEPT: usize = 32;
/// Samples of the reference that a thread of a fast CPU, and a fast GPU, render in a second. A scene whose samples do
/// not fit into the time limit is refused at once.
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
    /// The PNG file, or the JSON.
    pub bytes: Bytes,
    /// The renderer: the name of an adapter, or `cpu`.
    pub adapter: Arc<str>,
    /// The digest of the bytes.
    pub digest: Digest,
}

/// How many pictures ended in which way since the start.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct PictureCounts {
    /// Rendered.
    pub done: u64,
    /// The renderer or the storage failed.
    pub failed: u64,
    /// The caller left, or the time ran out.
    pub given_up: u64,
    /// Too many waited, or the picture had too many samples.
    pub refused: u64,
}

/// Why there is no picture.
#[derive(Debug, Clone, thiserror::Error)]
pub enum PictureError {
    /// There is no such table.
    #[error("no table with the digest {0} is stored")]
    UnknownTable(Digest),
    /// No table is stored.
    #[error("no table is stored")]
    NoTable,
    /// Too many pictures are requested at the same time: the limit, and when to try again.
    #[error("{0} pictures are waiting or being rendered already")]
    QueueFull(usize, Duration),
    /// The scene does not go with the table's scattering model.
    #[error("{0}")]
    OtherBrdf(String),
    /// The scene has more samples than are accepted: its samples, and the limit.
    #[error(
        "the picture takes {:.1} million samples, and this service accepts {:.1} million; fewer pixels or samples take \
        less, and `--picture-seconds` of the service raises the limit",
        .0 / 1e6,
        .1 / 1e6
    )]
    TooExpensive(f64, f64),
    /// Rendering took too long: the limit, and when to try again.
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

#[derive(Debug, Clone)]
struct PictureBytes;

impl Weighter<Digest, PictureFile> for PictureBytes {
    fn weight(&self, _: &Digest, file: &PictureFile) -> u64 {
        file.bytes.len() as u64
    }
}

/// The renderer and the pictures that are kept.
#[derive(Debug)]
pub(super) struct Pictures {
    limit: Duration,
    cache: Cache<Digest, PictureFile, PictureBytes>,
    /// A permit for each picture that may wait or be rendered.
    places: Arc<Semaphore>,
    /// One permit: one picture is rendered at a time.
    turn: Arc<Semaphore>,
    renderer: Mutex<Renderer>,
    counts: Mutex<PictureCounts>,
}

/// What the thread that renders takes, and puts back when it ends. The renderer of a hung thread is lost.
#[derive(Debug)]
struct Renderer {
    adapter: Adapter,
    preview: Option<Preview>,
    /// The table that was used last.
    table: Option<(Digest, Arc<ShaderTable>)>,
    /// The name of the adapter that rendered the last scene.
    name: Option<Arc<str>>,
}

/// Tells a render that its caller has left.
struct Caller(Arc<AtomicBool>);

impl Drop for Caller {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
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

    /// How many pictures ended in which way.
    pub(super) fn counts(&self) -> PictureCounts {
        *self.counts.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn renderer(&self) -> MutexGuard<'_, Renderer> {
        self.renderer.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn count<T>(&self, outcome: &Result<T, PictureError>) {
        let mut counts = self.counts.lock().unwrap_or_else(PoisonError::into_inner);
        *match outcome {
            Ok(_) => &mut counts.done,
            Err(PictureError::TooSlow(..) | PictureError::Store(ServiceError::Stopping)) => &mut counts.given_up,
            Err(PictureError::QueueFull(..) | PictureError::TooExpensive(..)) => &mut counts.refused,
            Err(_) => &mut counts.failed,
        } += 1;
    }

    /// Refuses a scene of more samples than the adapter can render within the time limit. An unknown adapter counts as
    /// a GPU. A plot takes seconds at most.
    fn check_cost(&self, subject: &Subject) -> Result<(), PictureError> {
        let Subject::Scene(scene) = subject else { return Ok(()) };
        // The adapter of lavapipe, which renders on the CPU too, is called llvmpipe.
        let is_cpu = self.renderer().name.as_ref().is_some_and(|name| **name == *CPU || name.starts_with("llvmpipe"));
        let cpu = SAMPLES_PER_CPU_THREAD * rayon::current_num_threads() as f64;
        let limit = self.limit.as_secs_f64() * if is_cpu { cpu } else { SAMPLES_PER_GPU };
        let samples = scene.cost();
        if samples > limit { Err(PictureError::TooExpensive(samples, limit)) } else { Ok(()) }
    }
}

impl Service {
    /// The picture of `subject` with a table. Where it needs a table and none is named, the newest one is used.
    ///
    /// # Errors
    /// See [`PictureError`].
    pub async fn picture(&self, table: Option<Digest>, subject: Subject) -> Result<PictureFile, PictureError> {
        let state = Arc::clone(&self.state);
        let subject = match subject {
            Subject::Scene(scene) => Subject::Scene(Box::new(scene.canonical())),
            of_table @ (Subject::Plot(_) | Subject::Errors(_)) => of_table,
        };
        let needs_table = subject.needs_table();
        let chosen = tokio::task::spawn_blocking(move || state.table_of_picture(table, needs_table));
        let table = chosen.await.map_err(|error| PictureError::Failed(error.to_string()))??;
        let key = key(&subject, table)?;
        let pictures = &self.state.pictures;
        if let Some(file) = pictures.cache.get(&key) {
            return Ok(file);
        }
        let place = pictures.check_cost(&subject).and_then(|()| {
            let full = PictureError::QueueFull(MOST_WAITING, RETRY_FULL);
            Arc::clone(&pictures.places).try_acquire_owned().map_err(|_| full)
        });
        let place = place.inspect_err(|error| pictures.count(&Err::<(), _>(error.clone())))?;
        let has_left = Arc::new(AtomicBool::new(false));
        let _caller = Caller(Arc::clone(&has_left));
        let request = Request { state: Arc::clone(&self.state), key, table, subject, has_left };
        // A task of its own ends the picture in good order if the caller leaves.
        let outcome = tokio::spawn(request.supervise(place)).await;
        outcome.unwrap_or_else(|error| Err(PictureError::Failed(error.to_string())))
    }
}

impl State {
    fn table_of_picture(&self, table: Option<Digest>, needs_table: bool) -> Result<Option<Digest>, PictureError> {
        match table {
            Some(table) if !self.files.contains(table).map_err(ServiceError::from)? => {
                Err(PictureError::UnknownTable(table))
            }
            None if needs_table => {
                let (rows, _) = self.files.catalogue.page(None, 1).map_err(ServiceError::from)?;
                rows.first().map(|row| Some(row.digest)).ok_or(PictureError::NoTable)
            }
            named_or_none => Ok(named_or_none),
        }
    }
}

/// A picture to render.
struct Request {
    state: Arc<State>,
    key: Digest,
    table: Option<Digest>,
    subject: Subject,
    has_left: Arc<AtomicBool>,
}

impl Request {
    /// Renders the picture when its turn comes, and gives up a renderer that hangs.
    async fn supervise(self, place: OwnedSemaphorePermit) -> Result<PictureFile, PictureError> {
        let state = Arc::clone(&self.state);
        let pictures = &state.pictures;
        let limit = pictures.limit;
        let turn = Arc::clone(&pictures.turn).acquire_owned().await.map_err(|_| ServiceError::Stopping)?;
        // An equal picture may have been rendered since this one was requested.
        if let Some(file) = pictures.cache.get(&self.key) {
            return Ok(file);
        }
        let key = self.key;
        let render = tokio::task::spawn_blocking(move || {
            let outcome = self.render(Instant::now() + limit);
            drop(place);
            outcome
        });
        let outcome = match tokio::time::timeout(limit + HUNG_AFTER, render).await {
            Ok(Ok(outcome)) => outcome,
            Ok(Err(_)) => Err(PictureError::Failed("the renderer panicked".to_owned())),
            Err(_) => {
                tracing::warn!("the renderer hung; it is abandoned and another one takes its place");
                let mut renderer = pictures.renderer();
                // A driver that hung is not used again, unless the configuration demands a GPU.
                if renderer.adapter == Adapter::Any {
                    renderer.adapter = Adapter::Cpu;
                }
                Err(PictureError::TooSlow(limit, RETRY_SLOW))
            }
        };
        drop(turn);
        pictures.count(&outcome);
        if let Ok(file) = &outcome {
            pictures.cache.insert(key, file.clone());
        }
        outcome
    }

    fn render(&self, deadline: Instant) -> Result<PictureFile, PictureError> {
        let is_stopped =
            || Instant::now() >= deadline || self.has_left.load(Ordering::Relaxed) || self.state.is_stopping();
        let png = |picture: Picture| picture.png().map_err(|error| PictureError::Failed(error.to_string()));
        let (bytes, adapter) = match &self.subject {
            _ if is_stopped() => return Err(self.stopped()),
            Subject::Scene(scene) => {
                let (picture, adapter) = self.scene(scene, &is_stopped)?;
                (png(picture)?, adapter)
            }
            Subject::Plot(plot) => {
                let (digest, table) = self.measurable_table(matches!(plot, Plot::Error(_)))?;
                let drawn = plot.draw_while(&|| !is_stopped(), &table, &digest.hex());
                (png(drawn.ok_or_else(|| self.stopped())?)?, CPU.into())
            }
            Subject::Errors(slice) => {
                let (_, table) = self.measurable_table(true)?;
                let numbers = error_numbers_while(&|| !is_stopped(), &table, *slice);
                (numbers.ok_or_else(|| self.stopped())?.into_bytes(), CPU.into())
            }
        };
        Ok(PictureFile { digest: Digest::of(&bytes), bytes: bytes.into(), adapter })
    }

    /// The error of a picture that was stopped before its end.
    fn stopped(&self) -> PictureError {
        if self.state.is_stopping() {
            return ServiceError::Stopping.into();
        }
        PictureError::TooSlow(self.state.pictures.limit, RETRY_SLOW)
    }

    /// The picture of a scene, and the adapter that rendered it.
    fn scene(&self, scene: &Scene, is_stopped: &dyn Fn() -> bool) -> Result<(Picture, Arc<str>), PictureError> {
        let pictures = &self.state.pictures;
        let (adapter, preview, last) = {
            let mut renderer = pictures.renderer();
            (renderer.adapter, renderer.preview.take(), renderer.table.take())
        };
        let mut preview = preview.unwrap_or_else(|| Preview::new(adapter));
        let table = match self.table {
            Some(digest) => match last.filter(|(of, _)| *of == digest) {
                Some((_, table)) => table,
                None => self.shader_table(digest)?,
            },
            None => Arc::new(ShaderTable::none()),
        };
        let rendered = preview.render(&table, scene, is_stopped);
        let mut renderer = pictures.renderer();
        renderer.preview = Some(preview);
        renderer.table = self.table.map(|digest| (digest, Arc::clone(&table)));
        let rendered = rendered.map_err(|error| match error {
            PreviewError::Stopped => self.stopped(),
            PreviewError::Table(_) | PreviewError::CpuOnly(_) | PreviewError::NoBrdfFile(_) => {
                PictureError::OtherBrdf(error.to_string())
            }
            other => PictureError::Failed(other.to_string()),
        })?;
        let name: Arc<str> = rendered.adapter.into();
        if !table.has_reference_on_cpu_only(scene) {
            renderer.name = Some(Arc::clone(&name));
        }
        Ok((rendered.picture, name))
    }

    fn shader_table(&self, digest: Digest) -> Result<Arc<ShaderTable>, PictureError> {
        let table = self.table(digest)?;
        if !table.layout().is_even(table.axes()) {
            let uneven =
                "the table's recipe gives nodes that are not evenly spaced, and the preview's shader searches for none";
            return Err(PictureError::OtherBrdf(uneven.to_owned()));
        }
        Ok(Arc::new(ShaderTable::new(&table, TexelFormat::F32).labelled(&digest.hex())))
    }

    /// The table of a plot. To be measured, it needs its BRDF.
    fn measurable_table(&self, is_measured: bool) -> Result<(Digest, Table), PictureError> {
        let digest = self.table.ok_or(PictureError::NoTable)?;
        let table = self.table(digest)?;
        if is_measured && !table.model().is_complete() {
            let missing = table.model().file().map(ToString::to_string).unwrap_or_default();
            return Err(PictureError::OtherBrdf(format!("the tabulated BRDF of the table, {missing}, is not stored")));
        }
        Ok((digest, table))
    }

    fn table(&self, digest: Digest) -> Result<Table, PictureError> {
        let file = self.state.files.read(FileKind::Table, digest)?.ok_or(PictureError::UnknownTable(digest))?;
        Ok(self.state.fitter.table(digest, &file)?.table)
    }
}

/// The digest of what determines a picture.
fn key(subject: &Subject, table: Option<Digest>) -> Result<Digest, PictureError> {
    let all = json!({ "subject": subject, "table": table });
    let text = serde_jcs::to_vec(&all).map_err(|error| PictureError::Failed(error.to_string()))?;
    Ok(Digest::of(&text))
}
