//! Starting render threads.

use std::{
    io,
    sync::{Arc, Weak},
    thread,
};

use super::{picture::PictureError, queue::PictureQueue, render_thread::RenderThread, request::PictureRequest};
use crate::service::{PictureLimits, tables::Tables};
use ltcforge_view::preview::Adapter;

/// The queue with what is needed to start its render thread.
#[derive(Debug, Clone)]
pub(super) struct RenderThreads {
    pub(super) queue: Arc<PictureQueue>,
    /// A thread holds the tables only while it reads one, so that the store closes with the service.
    tables: Weak<Tables>,
    adapter: Adapter,
}

impl RenderThreads {
    /// No thread is started and no adapter opened yet.
    pub(super) fn new(tables: &Arc<Tables>, adapter: Adapter, limits: PictureLimits) -> Self {
        Self { queue: Arc::new(PictureQueue::new(adapter, limits)), tables: Arc::downgrade(tables), adapter }
    }

    /// Adds a request to the queue and sees to it that a thread renders it.
    pub(super) fn add(&self, request: PictureRequest) -> Result<(), PictureError> {
        self.queue.add(request, |number| self.start(number))
    }

    /// Replaces a thread that hung while requests wait for it.
    pub(super) fn replace_hung(&self) {
        self.queue.replace_hung(|number| self.start(number));
    }

    /// Starts render thread `number`; those before it hung.
    fn start(&self, number: u32) -> io::Result<()> {
        // A driver in which a thread hung is not used again, unless the configuration demands it.
        let adapter = if self.adapter == Adapter::Any && number > 0 { Adapter::Cpu } else { self.adapter };
        let (queue, tables) = (Arc::clone(&self.queue), Weak::clone(&self.tables));
        let run = move || {
            RenderThread::new(adapter, tables).run(&queue, number);
            queue.thread_ended(number);
        };
        thread::Builder::new().name("preview".to_owned()).spawn(run).map(drop)
    }
}
