//! The queue of requested pictures before the render thread, and the pictures that it rendered.

use std::{
    io,
    sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError},
    time::{Duration, Instant},
};

use super::{
    picture::{PictureError, PictureFile, Subject},
    rate::Took,
    rates::{Rates, RendererKind},
    request::PictureRequest,
    waiting::Waiting,
};
use crate::service::{PictureCounts, PictureLimits, ServiceError, cache::Cache};
use ltcforge_files::digest::Digest;
use ltcforge_view::preview::Adapter;

/// When to try again if the queue is full: most pictures take less than a second.
const RETRY_FULL: Duration = Duration::from_secs(2);
/// How long past its deadline a picture may be rendered before its thread counts as hung. The renderer itself gives a
/// hanging driver up, and falls back to the CPU, after half of this time.
const HUNG_AFTER: Duration = Duration::from_secs(20);
/// How long the end of the service waits for the render thread.
const CLOSE_LIMIT: Duration = Duration::from_secs(5);

/// The queue and the pictures rendered so far.
#[derive(Debug)]
pub(super) struct PictureQueue {
    state: Mutex<State>,
    changed: Condvar,
}

#[derive(Debug)]
struct State {
    waiting: Waiting,
    /// Pictures that may wait or be rendered at the same time.
    limit: usize,
    /// The deadline of the picture that is being rendered.
    rendering: Option<Instant>,
    thread_runs: bool,
    /// Number of the current render thread: how many before it hung and were abandoned.
    thread: u32,
    is_closed: bool,
    cache: Cache<PictureFile>,
    /// What may render scenes.
    allowed: Adapter,
    /// What rendered the last scene.
    adapter: Option<Arc<str>>,
    rates: Rates,
    counts: PictureCounts,
}

impl State {
    /// What will render a picture.
    fn kind(&self, subject: &Subject) -> RendererKind {
        RendererKind::expected(subject, self.adapter.as_deref(), self.allowed)
    }

    /// Refuses a request whose picture is predicted to take longer than it may. What was never measured is not predicted.
    fn check_cost(&mut self, request: &PictureRequest) -> Result<(), PictureError> {
        let (subject, limit) = (&request.subject, request.limit);
        let kind = self.kind(subject);
        let predicted = self.rates.seconds(kind, subject.cost(), Instant::now());
        if !self.rates.is_known(kind) || predicted <= limit.as_secs_f64() {
            return Ok(());
        }
        self.counts.refused += 1;
        Err(PictureError::TooExpensive { predicted, limit })
    }

    fn remove_withdrawn(&mut self) {
        self.counts.given_up += self.waiting.remove_withdrawn() as u64;
    }

    /// Abandons a render thread that hung.
    fn abandon_hung(&mut self) {
        if self.rendering.is_some_and(|deadline| Instant::now() > deadline + HUNG_AFTER) {
            tracing::warn!("the render thread hung; it is abandoned and another one takes its place");
            self.thread += 1;
            self.counts.given_up += 1;
            (self.rendering, self.thread_runs) = (None, false);
        }
    }

    /// Starts a render thread if none runs.
    fn ensure_thread(&mut self, start_thread: impl FnOnce(u32) -> io::Result<()>) -> Result<(), PictureError> {
        if !self.thread_runs {
            start_thread(self.thread)
                .map_err(|error| ServiceError::Lacking(format!("the render thread did not start: {error}")))?;
            self.thread_runs = true;
        }
        Ok(())
    }
}

impl PictureQueue {
    /// An empty queue of pictures whose scenes `allowed` renders.
    pub(super) fn new(allowed: Adapter, limits: PictureLimits) -> Self {
        let state = State {
            waiting: Waiting::default(),
            limit: limits.queue.get(),
            rendering: None,
            thread_runs: false,
            thread: 0,
            is_closed: false,
            cache: Cache::new(limits.memory_bytes),
            allowed,
            adapter: None,
            rates: Rates::new(Instant::now()),
            counts: PictureCounts::default(),
        };
        Self { state: Mutex::new(state), changed: Condvar::new() }
    }

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

    /// Adds a request, unless its picture is predicted to take too long. A request equal to a waiting one joins it and
    /// takes no place of its own. If no render thread runs, or the current one hangs, `start_thread` starts one with the
    /// given number.
    pub(super) fn add(
        &self,
        request: PictureRequest,
        start_thread: impl FnOnce(u32) -> io::Result<()>,
    ) -> Result<(), PictureError> {
        let mut state = self.state();
        if state.is_closed {
            return Err(PictureError::Stopping);
        }
        state.abandon_hung();
        state.remove_withdrawn();
        state.check_cost(&request)?;
        if let Some(same) = state.waiting.find(request.key) {
            same.replies.extend(request.replies);
            return Ok(());
        }
        if state.waiting.len() + usize::from(state.rendering.is_some()) >= state.limit {
            state.counts.refused += 1;
            return Err(PictureError::QueueFull { limit: state.limit, retry_after: RETRY_FULL });
        }
        state.ensure_thread(start_thread)?;
        state.waiting.add(request);
        self.changed.notify_all();
        Ok(())
    }

    /// Replaces the render thread if it hangs.
    pub(super) fn replace_hung(&self, start_thread: impl FnOnce(u32) -> io::Result<()>) {
        let mut state = self.state();
        state.abandon_hung();
        if !state.is_closed
            && state.waiting.len() > 0
            && let Err(error) = state.ensure_thread(start_thread)
        {
            tracing::warn!("{error}");
        }
    }

    /// Waits for the next request of which a caller still waits, and tells it when its time ends; `None` if the queue is
    /// closed or `thread` was abandoned. The request counts as being rendered until [`Self::finish`]. What was found to
    /// be slow since a request came may have it refused.
    pub(super) fn next(&self, thread: u32) -> Option<(PictureRequest, Instant)> {
        let mut state = self.state();
        loop {
            if state.is_closed || state.thread != thread {
                return None;
            }
            state.remove_withdrawn();
            let Some(mut request) = state.waiting.take() else {
                state = self.changed.wait(state).unwrap_or_else(PoisonError::into_inner);
                continue;
            };
            if let Err(error) = state.check_cost(&request) {
                request.reply(&Err(error));
                continue;
            }
            let deadline = Instant::now() + request.limit;
            state.rendering = Some(deadline);
            request.start(deadline);
            return Some((request, deadline));
        }
    }

    /// What will render a picture.
    pub(super) fn kind(&self, subject: &Subject) -> RendererKind {
        self.state().kind(subject)
    }

    /// Whether the speed of what will render a scene is not known yet.
    pub(super) fn needs_probe(&self, subject: &Subject) -> bool {
        let state = self.state();
        !state.rates.is_known(state.kind(subject))
    }

    /// Records what a probe found: by which the scenes that follow are predicted.
    pub(super) fn set_probed(&self, adapter: &Arc<str>, rate: f64) {
        let mut state = self.state();
        state.rates.set_probed(RendererKind::of_scene(adapter), rate, Instant::now());
        state.adapter = Some(Arc::clone(adapter));
    }

    /// Refuses a request whose picture is predicted, by what is known now, to take longer than it may.
    pub(super) fn check_cost(&self, request: &PictureRequest) -> Result<(), PictureError> {
        self.state().check_cost(request)
    }

    /// Takes into account what a picture took.
    pub(super) fn learn(&self, kind: RendererKind, cost: f64, took: Took) {
        self.state().rates.learn(kind, cost, took, Instant::now());
    }

    /// Keeps a picture in memory.
    pub(super) fn keep(&self, key: Digest, file: PictureFile) {
        self.state().cache.keep(key, file.png.len(), file);
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
            // It was counted when it was refused.
            Err(PictureError::TooExpensive { .. }) => {}
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
