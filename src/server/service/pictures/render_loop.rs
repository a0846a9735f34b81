//! Rendering one request after another, each within its time.

use std::{
    sync::{
        Arc,
        mpsc::{self, RecvTimeoutError},
    },
    thread,
    time::{Duration, Instant},
};

use super::{
    picture::{PictureError, no_thread},
    queue::{Outcome, PictureQueue, PictureRequest},
};
use ltcforge_view::preview::Adapter;

/// How long past its deadline a picture may be rendered before its renderer counts as hung. The renderer itself gives
/// up a hanging GPU, and falls back to the CPU, after half of this time.
pub(super) const HUNG_AFTER: Duration = Duration::from_secs(20);

/// Renders pictures, one after another.
pub(super) trait Render: Send + 'static {
    fn render(&mut self, task: &Task) -> Outcome;
}

/// A picture to render by a deadline.
#[derive(Debug)]
pub(super) struct Task {
    pub(super) request: Arc<PictureRequest>,
    pub(super) queue: Arc<PictureQueue>,
    pub(super) deadline: Instant,
}

impl Task {
    /// Whether the picture is late, no longer wanted, or the service is stopping.
    pub(super) fn is_stopped(&self) -> bool {
        Instant::now() >= self.deadline || self.request.is_withdrawn() || self.queue.state().is_closed
    }
}

/// Renders the requested pictures until the queue is closed. The renderer runs on a thread of its own for each picture,
/// so that it can be abandoned if a driver does not return. One that panicked or was abandoned is replaced.
pub(super) fn run<R: Render>(
    queue: &Arc<PictureQueue>,
    mut adapter: Adapter,
    hung_after: Duration,
    new_renderer: impl Fn(Adapter) -> R,
) {
    let mut kept: Option<R> = None;
    while let Some(request) = queue.next() {
        let limit = queue.limits.time;
        let deadline = Instant::now() + limit;
        let task = Task { request: Arc::clone(&request), queue: Arc::clone(queue), deadline };
        let mut renderer = kept.take().unwrap_or_else(|| new_renderer(adapter));
        let (sender, receiver) = mpsc::channel();
        let spawned = thread::Builder::new().name("preview".to_owned()).spawn(move || {
            let outcome = renderer.render(&task);
            // An error means that this thread was abandoned.
            let _ = sender.send((renderer, outcome));
        });
        let lost = match spawned {
            Ok(_) => PictureError::Failed("the renderer panicked".to_owned()),
            Err(error) => no_thread(&error),
        };
        let mut ended = receiver.recv_timeout(limit);
        if matches!(ended, Err(RecvTimeoutError::Timeout)) {
            request.reply(Err(PictureError::too_slow(limit)));
            ended = receiver.recv_timeout(hung_after);
        }
        let outcome = match ended {
            Ok((renderer, outcome)) => {
                kept = Some(renderer);
                outcome
            }
            // The thread dropped its sender, or never had it.
            Err(RecvTimeoutError::Disconnected) => Err(lost),
            Err(RecvTimeoutError::Timeout) => {
                tracing::warn!("the renderer hung; it is abandoned and another one takes its place");
                // A driver that hung is not used again, unless the configuration demands a GPU.
                if adapter == Adapter::Any {
                    adapter = Adapter::Cpu;
                }
                Err(PictureError::too_slow(limit))
            }
        };
        queue.finish(&request, outcome);
    }
    // Devices are closed before the service ends.
    drop(kept);
    queue.thread_ended();
}
