//! The thread that renders.

use std::{
    panic::{AssertUnwindSafe, catch_unwind},
    sync::{Arc, Weak},
    time::Instant,
};

use super::{
    CPU, PictureError, PictureFile, Subject,
    desk::{Desk, Order},
    name, too_slow,
};
use crate::{
    files::{digest::Digest, export},
    fit::Table,
    server::service::{ServiceError, core::Core},
    view::{
        picture::Picture,
        preview::{Adapter, Preview, PreviewError, ShaderTable, TexelFormat},
    },
};

/// A renderer and the table that it rendered last.
pub(super) struct Studio {
    adapter: Adapter,
    core: Weak<Core>,
    preview: Preview,
    shader_table: Option<(Digest, Arc<ShaderTable>)>,
}

impl Studio {
    pub(super) fn new(adapter: Adapter, core: Weak<Core>) -> Self {
        Self { adapter, core, preview: Preview::new(adapter), shader_table: None }
    }

    /// Renders what is ordered until the desk is closed, or has given up this thread, which has a number.
    pub(super) fn work(mut self, desk: &Desk, number: u32) {
        while let Some(order) = desk.next(number) {
            let done = catch_unwind(AssertUnwindSafe(|| self.render(&order, desk)));
            let done = done.unwrap_or_else(|_| {
                // What a panic leaves of a driver is not trusted.
                self.preview = Preview::new(self.adapter);
                Err(PictureError::Failed("the renderer panicked".to_owned()))
            });
            desk.finish(number, &done);
            order.answer(&done);
        }
    }

    fn render(&mut self, order: &Order, desk: &Desk) -> Result<PictureFile, PictureError> {
        // The same may have been ordered while it was rendered.
        if let Some(file) = desk.kept(order.key) {
            return Ok(file);
        }
        let stop = || Instant::now() >= order.until || order.is_given_up() || desk.is_closed();
        if stop() {
            return Err(stopped(desk, order));
        }
        let (picture, adapter): (Picture, Arc<str>) = match &order.subject {
            Subject::Scene(scene) => {
                let table = self.shader_table(order.table)?;
                let rendered = self.preview.render(&table, scene, &stop).map_err(|error| match error {
                    PreviewError::Stopped => stopped(desk, order),
                    other => PictureError::Failed(other.to_string()),
                })?;
                let adapter = rendered.adapter.into();
                desk.was_rendered_by(&adapter);
                (rendered.picture, adapter)
            }
            Subject::Plot(plot) => (plot.draw(&self.table(order.table)?), CPU.into()),
        };
        let png = picture.png().map_err(|error| PictureError::Failed(error.to_string()))?;
        let tag = name(&order.subject, order.table, Some(&adapter))?;
        let file = PictureFile { png: Arc::new(png), adapter, tag };
        desk.keep(order.key, file.clone());
        Ok(file)
    }

    fn shader_table(&mut self, digest: Digest) -> Result<Arc<ShaderTable>, PictureError> {
        if let Some((_, table)) = self.shader_table.as_ref().filter(|(kept, _)| *kept == digest) {
            return Ok(Arc::clone(table));
        }
        // The one before makes room first: tables may be large.
        self.shader_table = None;
        let table = ShaderTable::new(&self.table(digest)?, TexelFormat::F32).labelled(&digest.hex());
        let table = Arc::new(table);
        self.shader_table = Some((digest, Arc::clone(&table)));
        Ok(table)
    }

    fn table(&self, digest: Digest) -> Result<Table, PictureError> {
        let core = self.core.upgrade().ok_or(PictureError::Stopping)?;
        let bytes = core.table(digest)?.ok_or(PictureError::UnknownTable(digest))?;
        drop(core);
        let file = export::decode(&bytes);
        let file = file.map_err(|error| ServiceError::Storage(format!("the blob {digest}: {error}")))?;
        Ok(file.table)
    }
}

fn stopped(desk: &Desk, order: &Order) -> PictureError {
    if desk.is_closed() { PictureError::Stopping } else { too_slow(order.limit) }
}
