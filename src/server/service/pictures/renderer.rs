//! Rendering the picture of a request.

use std::sync::{Arc, Weak};

use super::{
    picture::{CPU, PictureError, PictureFile, Subject, tag},
    queue::{Outcome, PictureQueue, PictureRequest},
    render_loop::{Render, Task},
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
    plots::{ErrorSlice, Plot, error_numbers_while},
    preview::{Adapter, Mode, Preview, PreviewError, Scene, ShaderTable, TexelFormat},
};

/// A renderer, and the table that it used last.
pub(super) struct Renderer {
    /// The tables are held only while one is read, so that the store closes with the service.
    tables: Weak<Tables>,
    preview: Preview,
    shader_table: Option<(Digest, Arc<ShaderTable>)>,
}

impl Render for Renderer {
    fn render(&mut self, task: &Task) -> Outcome {
        let PictureRequest { key, table, subject, .. } = &*task.request;
        // An equal picture may have been rendered since this one was requested.
        if let Some(file) = task.queue.cache.get(key) {
            return Ok(file);
        }
        let png = |picture: Picture| picture.png().map_err(|error| PictureError::Failed(error.to_string()));
        let (bytes, adapter) = match subject {
            _ if task.is_stopped() => return Err(task.queue.stopped()),
            Subject::Scene(scene) => {
                let (picture, adapter) = self.scene(scene, task)?;
                (png(picture)?, adapter)
            }
            Subject::Plot(plot) => (png(self.plot(plot, task)?)?, CPU.into()),
            Subject::Errors(slice) => (self.errors(slice, task)?.into_bytes(), CPU.into()),
        };
        let tag = tag(subject, *table, Some(&adapter))?;
        Ok(PictureFile { bytes: Arc::new(bytes), adapter, tag })
    }
}

impl Renderer {
    /// A renderer that has opened nothing yet.
    pub(super) fn new(adapter: Adapter, tables: Weak<Tables>) -> Self {
        Self { tables, preview: Preview::new(adapter), shader_table: None }
    }

    /// The picture of a scene, and the adapter that rendered it.
    fn scene(&mut self, scene: &Scene, task: &Task) -> Result<(Picture, Arc<str>), PictureError> {
        let Task { request, queue, .. } = task;
        let none = Arc::new(ShaderTable::none());
        let table = request.table.map_or_else(|| Ok(Arc::clone(&none)), |table| self.shader_table(table))?;
        let is_for_cpu = table.has_reference_on_cpu_only(scene);
        let mut render = |table, scene: &Scene| {
            let rendered = self.preview.render(table, scene, &|| task.is_stopped());
            let rendered = rendered.map_err(|error| failure(error, queue))?;
            Ok::<_, PictureError>((rendered.picture, Arc::<str>::from(rendered.adapter)))
        };
        if queue.state().adapter.is_none() && !is_for_cpu {
            // The smallest picture tells which adapter there is, before a large one is begun on a CPU.
            let smallest = Scene { size: 64, spp: 1, mode: Mode::Reference, ..Scene::default() };
            let (_, adapter) = render(&none, &smallest)?;
            queue.state().adapter = Some(adapter);
        }
        let expected = if is_for_cpu { Some(CPU.into()) } else { queue.state().adapter.clone() };
        request.subject.check_cost(expected.as_deref(), queue.limits.time)?;
        let rendered = render(&table, scene)?;
        if !is_for_cpu {
            queue.state().adapter = Some(Arc::clone(&rendered.1));
        }
        Ok(rendered)
    }

    fn plot(&self, plot: &Plot, task: &Task) -> Result<Picture, PictureError> {
        let digest = task.request.table.ok_or(PictureError::NoTable)?;
        let table = self.table(digest)?;
        if matches!(plot, Plot::Error(_)) {
            check_complete(&table)?;
        }
        plot.draw_while(&|| !task.is_stopped(), &table, &digest.hex()).ok_or_else(|| task.queue.stopped())
    }

    fn errors(&self, slice: &ErrorSlice, task: &Task) -> Result<String, PictureError> {
        let table = self.table(task.request.table.ok_or(PictureError::NoTable)?)?;
        check_complete(&table)?;
        error_numbers_while(&|| !task.is_stopped(), &table, *slice).ok_or_else(|| task.queue.stopped())
    }

    fn shader_table(&mut self, digest: Digest) -> Result<Arc<ShaderTable>, PictureError> {
        if let Some((_, table)) = self.shader_table.as_ref().filter(|(last, _)| *last == digest) {
            return Ok(Arc::clone(table));
        }
        // Tables may be large: free the last one before the next is read.
        self.shader_table = None;
        let table = self.table(digest)?;
        if !table.layout().is_even(table.axes()) {
            let what =
                "the table's recipe gives nodes that are not evenly spaced, and the preview's shader searches for none";
            return Err(PictureError::OtherBrdf(what.to_owned()));
        }
        let table = ShaderTable::new(&table, TexelFormat::F32).labelled(&digest.hex());
        let table = Arc::new(table);
        self.shader_table = Some((digest, Arc::clone(&table)));
        Ok(table)
    }

    fn table(&self, digest: Digest) -> Result<Table, PictureError> {
        let tables = self.tables.upgrade().ok_or(PictureError::Stopping)?;
        let bytes = tables.read(digest)?.ok_or(PictureError::UnknownTable(digest))?;
        let file = container::decode(&bytes);
        let mut file = file.map_err(|error| ServiceError::Storage(format!("the blob {digest}: {error}")))?;
        // A missing BRDF is an error only where a picture needs it.
        let _ = file.find_brdf(&|name| find(tables.store.blobs.as_ref(), name).map_err(FindBrdfError::lines));
        Ok(file.table)
    }
}

/// Refuses to measure a table whose scattering model is a file that is not stored.
fn check_complete(table: &Table) -> Result<(), PictureError> {
    if table.model().is_complete() {
        return Ok(());
    }
    let missing = table.model().file().map(ToString::to_string).unwrap_or_default();
    Err(PictureError::OtherBrdf(format!("the tabulated BRDF of the table, {missing}, is not stored")))
}

fn failure(error: PreviewError, queue: &PictureQueue) -> PictureError {
    match error {
        PreviewError::Stopped => queue.stopped(),
        other @ (PreviewError::Table(_) | PreviewError::CpuOnly(_) | PreviewError::NoBrdfFile(_)) => {
            PictureError::OtherBrdf(other.to_string())
        }
        other => PictureError::Failed(other.to_string()),
    }
}
