//! Getting a picture: of which table, from memory or from the render thread.

use std::{
    sync::Arc,
    thread,
    time::{Duration, Instant},
};

use tokio::sync::oneshot;

use super::{
    picture::{CPU, PictureError, PictureFile, Subject, tag},
    queue::{PictureQueue, PictureRequest},
    ranking::Ranking,
    render_thread::RenderThread,
};
use crate::{
    files::digest::Digest,
    server::service::{PictureCounts, tables::Tables},
    view::preview::Adapter,
};

/// The pictures of the stored tables.
#[derive(Debug)]
pub(in crate::server::service) struct Pictures {
    tables: Arc<Tables>,
    queue: Arc<PictureQueue>,
    ranking: Ranking,
    adapter: Adapter,
    /// How long a picture may take, waiting included.
    limit: Duration,
}

/// The answer to a request for a picture.
#[derive(Debug)]
pub enum PictureReply {
    /// The caller has the picture already.
    Known {
        /// Its tag.
        tag: Digest,
        /// What would render it.
        adapter: Arc<str>,
    },
    /// The picture was in memory.
    Ready(PictureFile),
    /// The picture waits or is being rendered.
    Pending(PendingPicture),
}

/// A picture that is not ready yet. Dropping this withdraws the request.
#[derive(Debug)]
pub struct PendingPicture {
    file: oneshot::Receiver<Result<PictureFile, PictureError>>,
    deadline: Instant,
    limit: Duration,
}

impl Pictures {
    /// Pictures that `adapter` renders, each within `limit`. No adapter is opened yet.
    pub(in crate::server::service) fn new(tables: Arc<Tables>, adapter: Adapter, limit: Duration) -> Self {
        let queue = Arc::new(PictureQueue::default());
        Self { tables, queue, ranking: Ranking::default(), adapter, limit }
    }

    /// The picture of `subject` with a table, or with the best stored one. `is_known` tells whether the caller has the
    /// picture of a tag.
    pub(in crate::server::service) fn get(
        &self,
        table: Option<Digest>,
        subject: Subject,
        is_known: impl Fn(Digest) -> bool,
    ) -> Result<PictureReply, PictureError> {
        let subject = match subject {
            Subject::Scene(scene) => Subject::Scene(Box::new(scene.canonical())),
            plot @ Subject::Plot(_) => plot,
        };
        let table = match table {
            Some(table) if !self.tables.contains(table) => return Err(PictureError::UnknownTable(table)),
            Some(table) => table,
            None => self.ranking.best(&self.tables)?.ok_or(PictureError::NoTable)?,
        };
        let key = tag(&subject, table, None)?;
        if let Some(file) = self.queue.cached(key) {
            return Ok(if is_known(file.tag) {
                PictureReply::Known { tag: file.tag, adapter: file.adapter }
            } else {
                PictureReply::Ready(file)
            });
        }
        let adapter = match &subject {
            Subject::Scene(_) => self.queue.adapter(),
            Subject::Plot(_) => Some(CPU.into()),
        };
        if let Some(adapter) = adapter {
            let tag = tag(&subject, table, Some(&adapter))?;
            if is_known(tag) {
                return Ok(PictureReply::Known { tag, adapter });
            }
        }
        let (reply, file) = oneshot::channel();
        let limit = self.limit;
        let deadline = Instant::now() + limit;
        let request = PictureRequest { key, table, subject, deadline, limit, replies: vec![reply] };
        self.queue.add(request, |number| self.start_thread(number))?;
        Ok(PictureReply::Pending(PendingPicture { file, deadline, limit }))
    }

    /// Starts render thread `number`; those before it hung.
    fn start_thread(&self, number: u32) -> std::io::Result<()> {
        // A driver in which a thread hung is not used again, unless the configuration demands it.
        let adapter = if self.adapter == Adapter::Any && number > 0 { Adapter::Cpu } else { self.adapter };
        // The thread holds the tables only while it reads one, so that the store closes with the service.
        let (queue, tables) = (Arc::clone(&self.queue), Arc::downgrade(&self.tables));
        let run = move || {
            RenderThread::new(adapter, tables).run(&queue, number);
            queue.thread_ended(number);
        };
        thread::Builder::new().name("preview".to_owned()).spawn(run).map(drop)
    }

    /// How many pictures ended in which way.
    pub(in crate::server::service) fn counts(&self) -> PictureCounts {
        self.queue.counts()
    }

    /// Accepts no more requests, drops the waiting ones and ends the render thread.
    pub(in crate::server::service) fn close(&self) {
        self.queue.close();
    }

    /// The queue, for tests.
    #[cfg(test)]
    pub(super) fn queue(&self) -> &PictureQueue {
        &self.queue
    }
}

impl PendingPicture {
    /// The picture, once it is ready.
    ///
    /// # Errors
    /// See [`PictureError`].
    pub async fn file(self) -> Result<PictureFile, PictureError> {
        match tokio::time::timeout_at(self.deadline.into(), self.file).await {
            Ok(Ok(result)) => result,
            Ok(Err(_)) => Err(PictureError::Stopping),
            Err(_) => Err(PictureError::too_slow(self.limit)),
        }
    }
}
