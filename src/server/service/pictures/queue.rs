//! The queue of requested pictures before the render thread, and the pictures that it rendered.

use std::{
    collections::VecDeque,
    io,
    sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError},
    time::{Duration, Instant},
};

use tokio::sync::oneshot;

use super::{
    cache::Cache,
    picture::{PictureError, PictureFile, Subject},
};
use crate::{files::digest::Digest, server::service::PictureCounts};

/// Pictures that may wait or be rendered at the same time: one, and eight behind it.
const LIMIT: usize = 9;
/// When to try again if the queue is full: most pictures take less than a second.
const RETRY_FULL: Duration = Duration::from_secs(2);
/// Bytes of finished pictures that are kept.
const CACHE_BYTES: usize = 64 << 20;
/// How long past its deadline a picture may be rendered before its thread counts as hung. The renderer itself gives a
/// hanging driver up, and falls back to the CPU, after half of this time.
const HUNG_AFTER: Duration = Duration::from_secs(20);
/// How long the end of the service waits for the render thread.
const CLOSE_LIMIT: Duration = Duration::from_secs(5);

/// A picture to render.
#[derive(Debug)]
pub(super) struct PictureRequest {
    /// The tag without an adapter: equal requests have equal keys.
    pub(super) key: Digest,
    pub(super) table: Digest,
    pub(super) subject: Subject,
    pub(super) deadline: Instant,
    /// How long it may take in all.
    pub(super) limit: Duration,
    /// One for each caller that waits; closed if the caller no longer does.
    pub(super) replies: Vec<oneshot::Sender<Result<PictureFile, PictureError>>>,
}

impl PictureRequest {
    /// Whether no caller waits any more.
    pub(super) fn is_withdrawn(&self) -> bool {
        self.replies.iter().all(oneshot::Sender::is_closed)
    }

    /// Sends the result to every caller.
    pub(super) fn reply(self, result: &Result<PictureFile, PictureError>) {
        for reply in self.replies {
            // An error means that this caller no longer waits.
            let _ = reply.send(result.clone());
        }
    }
}

/// The queue and the pictures rendered so far.
#[derive(Debug, Default)]
pub(super) struct PictureQueue {
    state: Mutex<State>,
    changed: Condvar,
}

#[derive(Debug)]
struct State {
    waiting: VecDeque<PictureRequest>,
    /// The deadline of the picture that is being rendered.
    rendering: Option<Instant>,
    thread_runs: bool,
    /// Number of the current render thread: how many before it hung and were abandoned.
    thread: u32,
    is_closed: bool,
    cache: Cache,
    /// What rendered the last scene.
    adapter: Option<Arc<str>>,
    counts: PictureCounts,
}

impl Default for State {
    fn default() -> Self {
        Self {
            waiting: VecDeque::new(),
            rendering: None,
            thread_runs: false,
            thread: 0,
            is_closed: false,
            cache: Cache::new(CACHE_BYTES),
            adapter: None,
            counts: PictureCounts::default(),
        }
    }
}

impl PictureQueue {
    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// A picture that was rendered before.
    pub(super) fn cached(&self, key: Digest) -> Option<PictureFile> {
        self.state().cache.get(key)
    }

    /// What rendered the last scene.
    pub(super) fn adapter(&self) -> Option<Arc<str>> {
        self.state().adapter.clone()
    }

    /// Adds a request. A request equal to a waiting one joins it and takes no place of its own. If no render thread
    /// runs, or the current one hangs, `start_thread` starts one with the given number.
    pub(super) fn add(
        &self,
        request: PictureRequest,
        start_thread: impl FnOnce(u32) -> io::Result<()>,
    ) -> Result<(), PictureError> {
        let mut state = self.state();
        if state.is_closed {
            return Err(PictureError::Stopping);
        }
        if state.rendering.is_some_and(|deadline| Instant::now() > deadline + HUNG_AFTER) {
            tracing::warn!("the render thread hung; it is abandoned and another one takes its place");
            state.thread += 1;
            state.counts.given_up += 1;
            (state.rendering, state.thread_runs) = (None, false);
        }
        let before = state.waiting.len();
        state.waiting.retain(|request| !request.is_withdrawn());
        state.counts.given_up += (before - state.waiting.len()) as u64;
        if let Some(same) = state.waiting.iter_mut().find(|other| other.key == request.key) {
            same.deadline = same.deadline.max(request.deadline);
            same.replies.extend(request.replies);
            return Ok(());
        }
        if state.waiting.len() + usize::from(state.rendering.is_some()) >= LIMIT {
            state.counts.refused += 1;
            return Err(PictureError::QueueFull { limit: LIMIT, retry_after: RETRY_FULL });
        }
        if !state.thread_runs {
            start_thread(state.thread)
                .map_err(|error| PictureError::Failed(format!("the render thread did not start: {error}")))?;
            state.thread_runs = true;
        }
        state.waiting.push_back(request);
        self.changed.notify_all();
        Ok(())
    }

    /// Waits for the next request of which a caller still waits; `None` if the queue is closed or `thread` was
    /// abandoned. The request counts as being rendered until [`Self::finish`].
    pub(super) fn next(&self, thread: u32) -> Option<PictureRequest> {
        let mut state = self.state();
        loop {
            if state.is_closed || state.thread != thread {
                return None;
            }
            match state.waiting.pop_front() {
                Some(request) if request.is_withdrawn() => state.counts.given_up += 1,
                Some(request) => {
                    state.rendering = Some(request.deadline);
                    return Some(request);
                }
                None => state = self.changed.wait(state).unwrap_or_else(PoisonError::into_inner),
            }
        }
    }

    /// Keeps a picture in memory.
    pub(super) fn keep(&self, key: Digest, file: PictureFile) {
        self.state().cache.keep(key, file);
    }

    /// Records what rendered a scene.
    pub(super) fn set_adapter(&self, adapter: &Arc<str>) {
        self.state().adapter = Some(Arc::clone(adapter));
    }

    /// Records that `thread` is done with its request.
    pub(super) fn finish(&self, thread: u32, result: &Result<PictureFile, PictureError>) {
        let mut state = self.state();
        if state.thread != thread {
            return;
        }
        state.rendering = None;
        match result {
            Ok(_) => state.counts.done += 1,
            Err(PictureError::TooSlow { .. } | PictureError::Stopping) => state.counts.given_up += 1,
            Err(_) => state.counts.failed += 1,
        }
    }

    /// Records that `thread` has ended.
    pub(super) fn thread_ended(&self, thread: u32) {
        let mut state = self.state();
        state.thread_runs &= state.thread != thread;
        self.changed.notify_all();
    }

    /// Simulates a thread that renders a picture with this deadline, or with `None` one that has ended.
    #[cfg(test)]
    pub(super) fn simulate_rendering(&self, deadline: Option<Instant>) {
        let mut state = self.state();
        (state.thread_runs, state.rendering) = (deadline.is_some(), deadline);
    }

    /// Whether a render thread runs.
    #[cfg(test)]
    pub(super) fn thread_runs(&self) -> bool {
        self.state().thread_runs
    }

    /// How many pictures ended in which way.
    pub(super) fn counts(&self) -> PictureCounts {
        self.state().counts
    }

    pub(super) fn is_closed(&self) -> bool {
        self.state().is_closed
    }

    /// Accepts no more requests, drops the waiting ones and waits for the render thread to end.
    pub(super) fn close(&self) {
        let mut state = self.state();
        state.is_closed = true;
        state.waiting.clear();
        self.changed.notify_all();
        let waited = self.changed.wait_timeout_while(state, CLOSE_LIMIT, |state| state.thread_runs);
        if waited.unwrap_or_else(PoisonError::into_inner).1.timed_out() {
            tracing::warn!("the render thread did not end; the service ends without it");
        }
    }
}
