//! The queue of requested pictures, and the rendered pictures that are kept in memory.

use std::{
    io,
    sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError},
    time::Duration,
};

use quick_cache::{Weighter, sync::Cache};
use tokio::sync::watch;

use super::picture::{CPU, PictureError, PictureFile, Subject, no_thread};
use crate::service::{PictureCounts, PictureLimits};
use ltcforge_files::digest::Digest;
use ltcforge_view::preview::Adapter;

/// When to try again if the queue is full: most pictures take less than a second.
const RETRY_FULL: Duration = Duration::from_secs(2);
/// How long the end of the service waits for the render thread.
const CLOSE_LIMIT: Duration = Duration::from_secs(5);
/// How often a picture may be overtaken by cheaper ones that were requested after it.
const MAX_OVERTAKEN: u32 = 8;
/// How many pictures the cache expects. A cache for more than 63 divides its bytes among several parts, and a large
/// picture would fit into none of them.
const EXPECTED_PICTURES: usize = 32;

/// The picture, or the reason that there is none.
pub(super) type Outcome = Result<PictureFile, PictureError>;

/// A picture to render, for any number of callers.
#[derive(Debug)]
pub(super) struct PictureRequest {
    /// The tag without an adapter: equal requests have equal keys.
    pub(super) key: Digest,
    /// The table that it shows, if any.
    pub(super) table: Option<Digest>,
    pub(super) subject: Subject,
    outcome: watch::Sender<Option<Outcome>>,
}

/// A picture that is not ready yet. Dropping this withdraws the request, unless other callers wait for the picture.
#[derive(Debug)]
pub struct PendingPicture(watch::Receiver<Option<Outcome>>);

/// The queue and the cache.
#[derive(Debug)]
pub(super) struct PictureQueue {
    pub(super) limits: PictureLimits,
    pub(super) cache: Cache<Digest, PictureFile, PngBytes>,
    state: Mutex<State>,
    changed: Condvar,
}

/// A picture weighs as many bytes as its PNG file has.
#[derive(Debug, Clone)]
pub(super) struct PngBytes;

#[derive(Debug, Default)]
pub(super) struct State {
    /// In order of arrival. Beside each request is how many that arrived after it were taken before it.
    waiting: Vec<(Arc<PictureRequest>, u32)>,
    is_rendering: bool,
    thread_runs: bool,
    pub(super) is_closed: bool,
    /// The adapter that rendered the last scene. Before the first it is known only if the CPU is demanded.
    pub(super) adapter: Option<Arc<str>>,
    pub(super) counts: PictureCounts,
}

impl PictureRequest {
    /// A request for which no caller waits yet.
    pub(super) fn new(key: Digest, table: Option<Digest>, subject: Subject) -> Self {
        Self { key, table, subject, outcome: watch::Sender::new(None) }
    }

    /// Whether all callers have gone.
    pub(super) fn is_withdrawn(&self) -> bool {
        self.outcome.is_closed()
    }

    /// Sends the outcome to every caller.
    pub(super) fn reply(&self, outcome: Outcome) {
        self.outcome.send_replace(Some(outcome));
    }
}

impl PendingPicture {
    /// The picture, once it is ready. It waits for as long as others are rendered before it; the time limit counts from
    /// when it starts to be rendered.
    ///
    /// # Errors
    /// See [`PictureError`].
    pub async fn file(mut self) -> Result<PictureFile, PictureError> {
        match self.0.wait_for(Option::is_some).await {
            Ok(outcome) => outcome.clone().unwrap_or(Err(PictureError::Stopping)),
            // The service dropped the request.
            Err(_) => Err(PictureError::Stopping),
        }
    }
}

impl Weighter<Digest, PictureFile> for PngBytes {
    fn weight(&self, _: &Digest, file: &PictureFile) -> u64 {
        file.bytes.len() as u64
    }
}

impl State {
    fn remove_withdrawn(&mut self) {
        let before = self.waiting.len();
        self.waiting.retain(|(request, _)| !request.is_withdrawn());
        self.counts.given_up += (before - self.waiting.len()) as u64;
    }

    /// Takes the next request: the first that was overtaken as often as it may be, else the first of the cheapest.
    fn take(&mut self) -> Option<Arc<PictureRequest>> {
        let rank = |(request, overtaken): &(Arc<PictureRequest>, u32)| {
            if *overtaken < MAX_OVERTAKEN { request.subject.cost() } else { f64::NEG_INFINITY }
        };
        // `min_by` takes the first of equal ones.
        let (next, _) = self.waiting.iter().enumerate().min_by(|(_, a), (_, b)| rank(a).total_cmp(&rank(b)))?;
        for (_, overtaken) in &mut self.waiting[..next] {
            *overtaken += 1;
        }
        Some(self.waiting.remove(next).0)
    }
}

impl PictureQueue {
    /// An empty queue of pictures whose scenes `adapter` renders.
    pub(super) fn new(adapter: Adapter, limits: PictureLimits) -> Self {
        let adapter = (adapter == Adapter::Cpu).then(|| CPU.into());
        let state = Mutex::new(State { adapter, ..State::default() });
        let cache = Cache::with_weighter(EXPECTED_PICTURES, limits.memory_bytes as u64, PngBytes);
        Self { limits, cache, state, changed: Condvar::new() }
    }

    pub(super) fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The error of a picture that was stopped before its end.
    pub(super) fn stopped(&self) -> PictureError {
        if self.state().is_closed { PictureError::Stopping } else { PictureError::too_slow(self.limits.time) }
    }

    /// Adds a request, unless its picture is too expensive. A request equal to a waiting one joins it and takes no room
    /// of its own. `start_thread` starts the render thread if it does not run yet.
    pub(super) fn add(
        &self,
        request: PictureRequest,
        start_thread: impl FnOnce() -> io::Result<()>,
    ) -> Result<PendingPicture, PictureError> {
        let mut state = self.state();
        if state.is_closed {
            return Err(PictureError::Stopping);
        }
        state.remove_withdrawn();
        let checked = request.subject.check_cost(state.adapter.as_deref(), self.limits.time);
        checked.inspect_err(|_| state.counts.refused += 1)?;
        if let Some((same, _)) = state.waiting.iter().find(|(waiting, _)| waiting.key == request.key) {
            return Ok(PendingPicture(same.outcome.subscribe()));
        }
        let limit = self.limits.queue.get();
        if state.waiting.len() + usize::from(state.is_rendering) >= limit {
            state.counts.refused += 1;
            return Err(PictureError::QueueFull { limit, retry_after: RETRY_FULL });
        }
        if !state.thread_runs {
            start_thread().map_err(|error| no_thread(&error))?;
            state.thread_runs = true;
        }
        let pending = PendingPicture(request.outcome.subscribe());
        state.waiting.push((Arc::new(request), 0));
        self.changed.notify_all();
        Ok(pending)
    }

    /// Waits for the next request for which a caller still waits; `None` once the queue is closed. The request counts
    /// as being rendered until [`Self::finish`].
    pub(super) fn next(&self) -> Option<Arc<PictureRequest>> {
        let state = self.changed.wait_while(self.state(), |state| {
            state.remove_withdrawn();
            state.waiting.is_empty() && !state.is_closed
        });
        let mut state = state.unwrap_or_else(PoisonError::into_inner);
        let request = state.take();
        state.is_rendering = request.is_some();
        request
    }

    /// Keeps and counts the outcome of a request, and sends it to the callers.
    pub(super) fn finish(&self, request: &PictureRequest, outcome: Outcome) {
        let mut state = self.state();
        state.is_rendering = false;
        match &outcome {
            Ok(file) => {
                self.cache.insert(request.key, file.clone());
                state.counts.done += 1;
            }
            Err(PictureError::TooSlow { .. } | PictureError::Stopping) => state.counts.given_up += 1,
            Err(PictureError::TooExpensive { .. }) => state.counts.refused += 1,
            Err(_) => state.counts.failed += 1,
        }
        drop(state);
        request.reply(outcome);
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

    /// Records that the render thread has ended.
    pub(super) fn thread_ended(&self) {
        self.state().thread_runs = false;
        self.changed.notify_all();
    }
}
