//! The thread that renders.

use std::{
    panic::{AssertUnwindSafe, catch_unwind},
    sync::{Arc, Weak},
    time::Instant,
};

use super::{
    PictureError, PictureFile,
    desk::{Desk, Order},
    name, too_slow,
};
use crate::{
    digest::Digest,
    export,
    preview::{Adapter, Precision, Preview, PreviewError, ShaderTable},
    service::{ServiceError, core::Core},
};

/// A renderer and the table that it rendered last.
pub(super) struct Studio {
    adapter: Adapter,
    core: Weak<Core>,
    preview: Preview,
    table: Option<(Digest, Arc<ShaderTable>)>,
}

impl Studio {
    pub(super) fn new(adapter: Adapter, core: Weak<Core>) -> Self {
        Self { adapter, core, preview: Preview::new(adapter), table: None }
    }

    /// Renders what is ordered until the desk is closed.
    pub(super) fn work(mut self, desk: &Desk) {
        while let Some(order) = desk.next() {
            let done = catch_unwind(AssertUnwindSafe(|| self.render(&order, desk)));
            let done = done.unwrap_or_else(|_| {
                // What a panic leaves of a driver is not trusted.
                self.preview = Preview::new(self.adapter);
                Err(PictureError::Failed("the renderer panicked".to_owned()))
            });
            desk.finish();
            // Nobody may wait any more.
            let _ = order.reply.send(done);
        }
    }

    fn render(&mut self, order: &Order, desk: &Desk) -> Result<PictureFile, PictureError> {
        // The same may have been ordered twice.
        if let Some(file) = desk.kept(order.key) {
            return Ok(file);
        }
        let stop = || Instant::now() >= order.until || order.reply.is_closed() || desk.is_closed();
        if stop() {
            return Err(stopped(desk));
        }
        let table = self.table(order.table)?;
        let rendered = self.preview.render(&table, &order.scene, &stop).map_err(|error| match error {
            PreviewError::Stopped => stopped(desk),
            other => PictureError::Failed(other.to_string()),
        })?;
        let png = rendered.picture.png().map_err(|error| PictureError::Failed(error.to_string()))?;
        let tag = name(&order.scene, order.table, Some(&rendered.adapter))?;
        let file = PictureFile { png: Arc::new(png), adapter: rendered.adapter.into(), tag };
        desk.keep(order.key, file.clone());
        Ok(file)
    }

    fn table(&mut self, digest: Digest) -> Result<Arc<ShaderTable>, PictureError> {
        if let Some((_, table)) = self.table.as_ref().filter(|(kept, _)| *kept == digest) {
            return Ok(Arc::clone(table));
        }
        // The one before makes room first: tables may be large.
        self.table = None;
        let core = self.core.upgrade().ok_or(PictureError::Stopping)?;
        let bytes = core.table(digest)?.ok_or(PictureError::UnknownTable(digest))?;
        drop(core);
        let file = export::decode(&bytes);
        let file = file.map_err(|error| ServiceError::Storage(format!("the blob {digest}: {error}")))?;
        let table = Arc::new(ShaderTable::new(&file.table, Precision::F32));
        self.table = Some((digest, Arc::clone(&table)));
        Ok(table)
    }
}

fn stopped(desk: &Desk) -> PictureError {
    if desk.is_closed() { PictureError::Stopping } else { too_slow() }
}
