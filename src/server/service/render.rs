//! Renders pictures, one at a time, on a blocking thread, within a time limit.

use std::{
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    time::{Duration, Instant},
};

use bytes::Bytes;
use serde_json::json;
use tokio::sync::OwnedSemaphorePermit;

use super::{
    FileKind, PictureError, PictureFile, Service, ServiceError, Subject,
    pictures::{CPU, MOST_WAITING},
    state::State,
};
use ltcforge_files::{
    container::{AnyFile, LutFile, decode_any},
    digest::Digest,
};
use ltcforge_fit::Table;
use ltcforge_view::{
    picture::Picture,
    plots::{Plot, draw_lut, error_numbers_while},
    preview::{Adapter, Preview, PreviewError, Scene, ShaderTable, TexelFormat},
};

/// When to try again if too many pictures wait. Most pictures take less than a second.
const RETRY_FULL: Duration = Duration::from_secs(2);
/// When to try again after a picture that took too long.
const RETRY_SLOW: Duration = Duration::from_secs(30);
/// How long rendering may exceed its time limit before the driver counts as hung.
const HUNG_AFTER: Duration = Duration::from_secs(20);

/// A guard that the caller holds. Dropping it stops the rendering.
struct Caller(Arc<AtomicBool>);

impl Drop for Caller {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

impl Service {
    /// The picture of `subject` with `table`. If the subject needs a table and `table` is `None`, it uses the newest
    /// table.
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
        // A separate task can end the picture properly even if the caller leaves.
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
    /// Renders the picture when its turn comes. Abandons a renderer that hangs.
    async fn supervise(self, place: OwnedSemaphorePermit) -> Result<PictureFile, PictureError> {
        let state = Arc::clone(&self.state);
        let pictures = &state.pictures;
        let limit = pictures.limit;
        let turn = Arc::clone(&pictures.turn).acquire_owned().await.map_err(|_| ServiceError::Stopping)?;
        // Another request may have rendered the same picture meanwhile.
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
                tracing::warn!("the renderer hung; it is abandoned, and a new renderer replaces it");
                let mut renderer = pictures.renderer();
                // After a driver has hung, the CPU renders, unless the configuration requires a GPU.
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
                let lookup_table = if matches!(plot, Plot::Error(_)) { self.lookup_table()? } else { None };
                let drawn = if let Some((digest, LutFile { recipe, lut })) = lookup_table {
                    Some(draw_lut(&recipe, &lut, &digest.hex()))
                } else {
                    let (digest, table) = self.measurable_table(matches!(plot, Plot::Error(_)))?;
                    plot.draw_while(&|| !is_stopped(), &table, &digest.hex())
                };
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

    /// The error for a picture that was stopped.
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
            let uneven = "the preview needs evenly spaced nodes, but the recipe of this table sets other nodes";
            return Err(PictureError::OtherBrdf(uneven.to_owned()));
        }
        Ok(Arc::new(ShaderTable::new(&table, TexelFormat::F32).labelled(&digest.hex())))
    }

    /// The table of a plot. If the plot measures the table, the table's tabulated BRDF must be stored.
    fn measurable_table(&self, is_measured: bool) -> Result<(Digest, Table), PictureError> {
        let digest = self.table.ok_or(PictureError::NoTable)?;
        let table = self.table(digest)?;
        if is_measured && !table.model().is_complete() {
            let missing = table.model().file().map(ToString::to_string).unwrap_or_default();
            return Err(PictureError::OtherBrdf(format!("the BRDF {missing} is not stored; upload it to /v1/brdfs")));
        }
        Ok((digest, table))
    }

    fn file(&self, digest: Digest) -> Result<Bytes, PictureError> {
        self.state.files.read(FileKind::Table, digest)?.ok_or(PictureError::UnknownTable(digest))
    }

    fn table(&self, digest: Digest) -> Result<Table, PictureError> {
        Ok(self.state.fitter.table(digest, &self.file(digest)?)?.table)
    }

    /// The table of a plot, if it is a lookup table.
    fn lookup_table(&self) -> Result<Option<(Digest, LutFile)>, PictureError> {
        let digest = self.table.ok_or(PictureError::NoTable)?;
        match decode_any(&self.file(digest)?) {
            Ok(AnyFile::Lut(lut)) => Ok(Some((digest, lut))),
            _ => Ok(None),
        }
    }
}

/// The digest of everything that determines a picture.
fn key(subject: &Subject, table: Option<Digest>) -> Result<Digest, PictureError> {
    let all = json!({ "subject": subject, "table": table });
    let text = serde_jcs::to_vec(&all).map_err(|error| PictureError::Failed(error.to_string()))?;
    Ok(Digest::of(&text))
}
