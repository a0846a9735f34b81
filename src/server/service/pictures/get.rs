//! Getting a picture: of which table, from memory or from the render thread.

use std::{sync::Arc, time::Duration};

use super::{
    picture::{CPU, PictureError, PictureFile, Subject, tag},
    ranking::Ranking,
    request::{PictureRequest, Receipt, Reply},
    threads::RenderThreads,
};
use crate::service::{PictureCounts, PictureLimits, ServiceError, tables::Tables};
use ltcforge_files::digest::Digest;
use ltcforge_view::preview::Adapter;

/// How often a waiting caller looks whether the render thread hung.
const WATCH: Duration = Duration::from_secs(5);

/// The pictures of the stored tables.
#[derive(Debug)]
pub(in crate::service) struct Pictures {
    tables: Arc<Tables>,
    threads: RenderThreads,
    ranking: Ranking,
    /// How long a picture may take, from when it starts to be rendered.
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
    receipt: Receipt,
    threads: RenderThreads,
    limit: Duration,
}

impl Pictures {
    /// Pictures that `adapter` renders within limits. No adapter is opened yet.
    pub(in crate::service) fn new(tables: Arc<Tables>, adapter: Adapter, limits: PictureLimits) -> Self {
        let threads = RenderThreads::new(&tables, adapter, limits);
        Self { tables, threads, ranking: Ranking::default(), limit: limits.time }
    }

    /// The picture of `subject` with a table; where it needs one and none is named, with the best stored one. `is_known`
    /// tells whether the caller has the picture of a tag.
    pub(in crate::service) fn get(
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
            Some(table) if !self.tables.contains(table).map_err(ServiceError::from)? => {
                return Err(PictureError::UnknownTable(table));
            }
            None if subject.needs_table() => Some(self.ranking.best(&self.tables)?.ok_or(PictureError::NoTable)?),
            named_or_none => named_or_none,
        };
        let key = tag(&subject, table, None)?;
        if let Some(file) = self.threads.queue.cached(key) {
            return Ok(if is_known(file.tag) {
                PictureReply::Known { tag: file.tag, adapter: file.adapter }
            } else {
                PictureReply::Ready(file)
            });
        }
        let adapter = match &subject {
            Subject::Scene(_) => self.threads.queue.adapter(),
            Subject::Plot(_) => Some(CPU.into()),
        };
        if let Some(adapter) = adapter {
            let tag = tag(&subject, table, Some(&adapter))?;
            if is_known(tag) {
                return Ok(PictureReply::Known { tag, adapter });
            }
        }
        let (reply, receipt) = Reply::new();
        let limit = self.limit;
        self.threads.add(PictureRequest { key, table, subject, limit, replies: vec![reply] })?;
        Ok(PictureReply::Pending(PendingPicture { receipt, threads: self.threads.clone(), limit }))
    }

    /// How many pictures ended in which way.
    pub(in crate::service) fn counts(&self) -> PictureCounts {
        self.threads.queue.counts()
    }

    /// Accepts no more requests, drops the waiting ones and ends the render thread.
    pub(in crate::service) fn close(&self) {
        self.threads.queue.close();
    }

    /// The queue, for tests.
    #[cfg(test)]
    pub(super) fn queue(&self) -> &super::queue::PictureQueue {
        &self.threads.queue
    }
}

impl PendingPicture {
    /// The picture, once it is ready. It waits for as long as others are rendered before it; the time limit counts from
    /// when it starts to be rendered.
    ///
    /// # Errors
    /// See [`PictureError`].
    pub async fn file(self) -> Result<PictureFile, PictureError> {
        let Self { receipt: Receipt { mut started, file }, threads, limit } = self;
        let mut watch = tokio::time::interval(WATCH);
        let started = loop {
            tokio::select! {
                started = &mut started => break started,
                _ = watch.tick() => threads.replace_hung(),
            }
        };
        let result = match started {
            Ok(deadline) => {
                tokio::time::timeout_at(deadline.into(), file).await.map_err(|_| PictureError::too_slow(limit))?
            }
            // It never starts: the reason is there already, unless the service is stopping.
            Err(_) => file.await,
        };
        result.unwrap_or(Err(PictureError::Stopping))
    }
}
