//! The thread that renders.

use std::{
    panic::{AssertUnwindSafe, catch_unwind},
    sync::{Arc, Weak},
    time::Instant,
};

use super::{
    picture::{CPU, PictureError, PictureFile, Subject, tag},
    probe::{Probed, probe},
    queue::PictureQueue,
    rate::Took,
    rates::RendererKind,
    request::PictureRequest,
};
use crate::service::{
    ServiceError,
    find_brdf::{FindBrdfError, find},
    tables::Tables,
};
use ltcforge_files::{container, digest::Digest};
use ltcforge_fit::Table;
use ltcforge_view::{
    picture::Picture,
    plots::Plot,
    preview::{Adapter, Mode, Preview, PreviewError, Scene, ShaderTable, Stop, TexelFormat},
};

/// A renderer, and the table that it used last.
pub(super) struct RenderThread {
    adapter: Adapter,
    tables: Weak<Tables>,
    preview: Preview,
    shader_table: Option<(Digest, Arc<ShaderTable>)>,
}

impl RenderThread {
    pub(super) fn new(adapter: Adapter, tables: Weak<Tables>) -> Self {
        Self { adapter, tables, preview: Preview::new(adapter), shader_table: None }
    }

    /// Renders what is requested until the queue is closed or has abandoned this thread, which has a number.
    pub(super) fn run(mut self, queue: &PictureQueue, number: u32) {
        while let Some((request, deadline)) = queue.next(number) {
            let rendered = catch_unwind(AssertUnwindSafe(|| self.render(&request, deadline, queue)));
            let result = rendered.unwrap_or_else(|_| {
                // The panic may have left the device in any state.
                self.preview = Preview::new(self.adapter);
                Err(PictureError::Failed("the renderer panicked".to_owned()))
            });
            queue.finish(number, &result);
            request.reply(&result);
        }
    }

    fn render(
        &mut self,
        request: &PictureRequest,
        deadline: Instant,
        queue: &PictureQueue,
    ) -> Result<PictureFile, PictureError> {
        // An equal picture may have been rendered since this one was requested.
        if let Some(file) = queue.cached(request.key) {
            return Ok(file);
        }
        let stop = || Instant::now() >= deadline || request.is_withdrawn() || queue.is_closed();
        if stop() {
            return Err(stopped(queue, request));
        }
        let cost = request.subject.cost();
        let (picture, adapter): (Picture, Arc<str>) = match &request.subject {
            Subject::Scene(scene) => {
                let table = request
                    .table
                    .map_or_else(|| Ok(Arc::new(ShaderTable::none())), |table| self.shader_table(table))?;
                if queue.needs_probe(&request.subject) {
                    self.probe(&table, request, queue, &stop)?;
                }
                let kind = queue.kind(&request.subject);
                let start = Instant::now();
                let rendered = self.preview.render(&table, scene, &stop).map_err(|error| {
                    if error == PreviewError::Stopped {
                        let is_late = Instant::now() >= deadline;
                        let took = if is_late { Took::GivenUp } else { Took::Abandoned };
                        queue.learn(kind, cost, took(start.elapsed()));
                    }
                    self::error(error, queue, request)
                })?;
                let adapter: Arc<str> = rendered.adapter.into();
                // Where another renderer stands in for one that failed, the time is not its own.
                if RendererKind::of_scene(&adapter) == kind {
                    queue.learn(kind, cost, Took::Finished(start.elapsed()));
                }
                // A reference that shaders do not know says nothing of what renders others.
                if !table.has_reference_on_cpu_only(scene) {
                    queue.set_adapter(&adapter);
                }
                (rendered.picture, adapter)
            }
            Subject::Plot(plot) => {
                let digest = request.table.ok_or(PictureError::NoTable)?;
                let table = self.table(digest)?;
                if let (Plot::Error(_), false) = (plot, table.model().is_complete()) {
                    let missing = table.model().file().map(ToString::to_string).unwrap_or_default();
                    return Err(PictureError::OtherBrdf(format!(
                        "the tabulated BRDF of the table, {missing}, is not stored"
                    )));
                }
                let start = Instant::now();
                let picture = plot.draw_while(&|| !stop(), &table, &digest.hex());
                let picture = picture.ok_or_else(|| stopped(queue, request))?;
                queue.learn(RendererKind::Plot, cost, Took::Finished(start.elapsed()));
                (picture, CPU.into())
            }
        };
        let png = picture.png().map_err(|error| PictureError::Failed(error.to_string()))?;
        let tag = tag(&request.subject, request.table, Some(&adapter))?;
        let file = PictureFile { png: Arc::new(png), adapter, tag };
        queue.keep(request.key, file.clone());
        Ok(file)
    }

    /// Measures how fast scenes are rendered, and refuses the request if its own would take too long.
    fn probe(
        &mut self,
        table: &Arc<ShaderTable>,
        request: &PictureRequest,
        queue: &PictureQueue,
        stop: Stop<'_>,
    ) -> Result<(), PictureError> {
        // What is measured is the speed of references that the adapter has itself.
        let none = Arc::new(ShaderTable::none());
        let table = if table.has_reference_on_cpu_only(&Scene { mode: Mode::Reference, ..Scene::default() }) {
            &none
        } else {
            table
        };
        let probed = probe(&mut self.preview, table, stop).map_err(|other| error(other, queue, request))?;
        if let Some(Probed { adapter, rate }) = probed {
            tracing::info!(adapter, rate, "seconds that a sample of a picture takes");
            queue.set_probed(&adapter.into(), rate);
        }
        queue.check_cost(request)
    }

    fn shader_table(&mut self, digest: Digest) -> Result<Arc<ShaderTable>, PictureError> {
        if let Some((_, table)) = self.shader_table.as_ref().filter(|(last, _)| *last == digest) {
            return Ok(Arc::clone(table));
        }
        // Tables may be large: free the last one before the next is read.
        self.shader_table = None;
        let table = ShaderTable::new(&self.table(digest)?, TexelFormat::F32).labelled(&digest.hex());
        let table = Arc::new(table);
        self.shader_table = Some((digest, Arc::clone(&table)));
        Ok(table)
    }

    fn table(&self, digest: Digest) -> Result<Table, PictureError> {
        let tables = self.tables.upgrade().ok_or(PictureError::Stopping)?;
        let bytes = tables.read(digest)?.ok_or(PictureError::UnknownTable(digest))?;
        let file = container::decode(&bytes);
        let mut file = file.map_err(|error| ServiceError::Storage(format!("the blob {digest}: {error}")))?;
        // A missing file is told where it is needed.
        let _ = file.find_brdf(&|name| find(tables.store.blobs.as_ref(), name).map_err(FindBrdfError::lines));
        drop(tables);
        Ok(file.table)
    }
}

fn error(error: PreviewError, queue: &PictureQueue, request: &PictureRequest) -> PictureError {
    match error {
        PreviewError::Stopped => stopped(queue, request),
        other @ (PreviewError::OtherBrdf(_)
        | PreviewError::GaussianLobe(_)
        | PreviewError::CpuOnly(_)
        | PreviewError::NoBrdfFile(_)) => PictureError::OtherBrdf(other.to_string()),
        other => PictureError::Failed(other.to_string()),
    }
}

fn stopped(queue: &PictureQueue, request: &PictureRequest) -> PictureError {
    if queue.is_closed() { PictureError::Stopping } else { PictureError::too_slow(request.limit) }
}
