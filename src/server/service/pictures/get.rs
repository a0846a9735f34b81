//! Getting a picture: choosing its table, then from memory or by the render thread.

use std::{io, sync::Arc, thread};

use super::{
    picture::{CPU, PictureError, PictureFile, Subject, tag},
    queue::{PendingPicture, PictureQueue, PictureRequest},
    ranking::Ranking,
    render_loop::{HUNG_AFTER, run},
    renderer::Renderer,
};
use crate::service::{PictureCounts, PictureLimits, ServiceError, tables::Tables};
use ltcforge_files::digest::Digest;
use ltcforge_view::preview::Adapter;

/// The pictures of the stored tables.
#[derive(Debug)]
pub(in crate::service) struct Pictures {
    tables: Arc<Tables>,
    queue: Arc<PictureQueue>,
    ranking: Ranking,
    adapter: Adapter,
}

/// The answer to a request for a picture.
#[derive(Debug)]
pub enum PictureReply {
    /// The picture is not in memory, and the caller has it.
    Known {
        /// Its tag.
        tag: Digest,
        /// The adapter that would render it.
        adapter: Arc<str>,
    },
    /// The picture was in memory.
    Ready(PictureFile),
    /// The picture waits or is being rendered.
    Pending(PendingPicture),
}

impl Pictures {
    /// Pictures that `adapter` renders within limits. No adapter is opened yet.
    pub(in crate::service) fn new(tables: Arc<Tables>, adapter: Adapter, limits: PictureLimits) -> Self {
        let queue = Arc::new(PictureQueue::new(adapter, limits));
        Self { tables, queue, ranking: Ranking::default(), adapter }
    }

    /// The picture of `subject` with a table; where it needs one and none is named, with the best stored one.
    /// `is_known` tells whether the caller has the picture of a tag.
    pub(in crate::service) fn get(
        &self,
        table: Option<Digest>,
        subject: Subject,
        is_known: impl Fn(Digest) -> bool,
    ) -> Result<PictureReply, PictureError> {
        let subject = match subject {
            Subject::Scene(scene) => Subject::Scene(Box::new(scene.canonical())),
            of_table @ (Subject::Plot(_) | Subject::Errors(_)) => of_table,
        };
        let table = match table {
            Some(table) if !self.tables.contains(table).map_err(ServiceError::from)? => {
                return Err(PictureError::UnknownTable(table));
            }
            None if subject.needs_table() => Some(self.ranking.best(&self.tables)?.ok_or(PictureError::NoTable)?),
            named_or_none => named_or_none,
        };
        if let Some(table) = table {
            self.tables.uses.note(table);
        }
        let key = tag(&subject, table, None)?;
        if let Some(file) = self.queue.cache.get(&key) {
            return Ok(PictureReply::Ready(file));
        }
        let adapter = match &subject {
            Subject::Scene(_) => self.queue.state().adapter.clone(),
            Subject::Plot(_) | Subject::Errors(_) => Some(CPU.into()),
        };
        if let Some(adapter) = adapter {
            let tag = tag(&subject, table, Some(&adapter))?;
            if is_known(tag) {
                return Ok(PictureReply::Known { tag, adapter });
            }
        }
        let request = PictureRequest::new(key, table, subject);
        self.queue.add(request, || self.start_thread()).map(PictureReply::Pending)
    }

    /// Starts the thread that takes requests from the queue.
    fn start_thread(&self) -> io::Result<()> {
        let (queue, tables, adapter) = (Arc::clone(&self.queue), Arc::downgrade(&self.tables), self.adapter);
        let run = move || run(&queue, adapter, HUNG_AFTER, |adapter| Renderer::new(adapter, tables.clone()));
        thread::Builder::new().name("pictures".to_owned()).spawn(run).map(drop)
    }

    /// How many pictures ended in which way.
    pub(in crate::service) fn counts(&self) -> PictureCounts {
        self.queue.state().counts
    }

    /// Accepts no more requests, drops the waiting ones and ends the render thread.
    pub(in crate::service) fn close(&self) {
        self.queue.close();
    }
}
