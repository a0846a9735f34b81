//! Where pictures are ordered: a short queue before the one thread that renders.

use std::{
    collections::VecDeque,
    sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError},
    thread,
    time::{Duration, Instant},
};

use tokio::sync::oneshot;

use super::{PictureError, PictureFile, RETRY_FULL, Subject, cache::Cache, studio::Studio};
use crate::{
    files::digest::Digest,
    server::service::{PictureCounts, core::Core},
    view::preview::Adapter,
};

/// Pictures that wait or are rendered at the same time: one, and eight behind it.
const LIMIT: usize = 9;
/// Bytes of finished pictures that are kept.
const KEPT_BYTES: usize = 64 << 20;
/// How long past its time a picture may be rendered: a driver hangs for half as long before the CPU takes its place.
const LOST: Duration = Duration::from_secs(20);
/// How long the end of the service waits for a renderer that does not come back.
const PATIENCE: Duration = Duration::from_secs(5);

/// A picture to render.
#[derive(Debug)]
pub(super) struct Order {
    /// The digest of what is asked for.
    pub(super) key: Digest,
    pub(super) table: Digest,
    pub(super) subject: Subject,
    /// When it is of no more use.
    pub(super) until: Instant,
    /// How long it may take in all.
    pub(super) limit: Duration,
    /// One for each who waits, closed when that one does not wait any more.
    pub(super) replies: Vec<oneshot::Sender<Result<PictureFile, PictureError>>>,
}

impl Order {
    /// Whether nobody waits any more.
    pub(super) fn is_given_up(&self) -> bool {
        self.replies.iter().all(oneshot::Sender::is_closed)
    }

    /// Tells everybody who waits how it ended.
    pub(super) fn answer(self, done: &Result<PictureFile, PictureError>) {
        for reply in self.replies {
            // Whoever has gone need not be told.
            let _ = reply.send(done.clone());
        }
    }
}

/// The queue and what was rendered.
#[derive(Debug)]
pub(in crate::server::service) struct Desk {
    adapter: Adapter,
    state: Mutex<State>,
    changed: Condvar,
}

#[derive(Debug)]
struct State {
    waiting: VecDeque<Order>,
    /// When the picture that is being rendered is of no more use.
    rendering: Option<Instant>,
    /// The thread runs.
    is_open: bool,
    /// Threads that were left to themselves: the one that runs now has this number.
    lost: u32,
    is_closed: bool,
    kept: Cache,
    /// What rendered the last scene.
    adapter: Option<Arc<str>>,
    counts: PictureCounts,
}

impl Desk {
    pub(in crate::server::service) fn new(adapter: Adapter) -> Self {
        let state = State {
            waiting: VecDeque::new(),
            rendering: None,
            is_open: false,
            lost: 0,
            is_closed: false,
            kept: Cache::new(KEPT_BYTES),
            adapter: None,
            counts: PictureCounts::default(),
        };
        Self { adapter, state: Mutex::new(state), changed: Condvar::new() }
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// A picture that was rendered before.
    pub(super) fn kept(&self, key: Digest) -> Option<PictureFile> {
        self.state().kept.get(key)
    }

    /// What rendered the last scene.
    pub(super) fn adapter(&self) -> Option<Arc<str>> {
        self.state().adapter.clone()
    }

    /// Puts an order into the queue; one for a picture that others wait for takes no place of its own. The first one
    /// starts the thread, as does one that finds it lost.
    pub(super) fn order(self: &Arc<Self>, core: &Arc<Core>, order: Order) -> Result<(), PictureError> {
        let mut state = self.state();
        if state.is_closed {
            return Err(PictureError::Stopping);
        }
        if state.rendering.is_some_and(|until| Instant::now() > until + LOST) {
            tracing::warn!(
                "what renders pictures does not come back; it is left to itself, and another takes its place"
            );
            state.lost += 1;
            state.counts.given_up += 1;
            (state.rendering, state.is_open) = (None, false);
        }
        let before = state.waiting.len();
        state.waiting.retain(|order| !order.is_given_up());
        state.counts.given_up += (before - state.waiting.len()) as u64;
        if let Some(same) = state.waiting.iter_mut().find(|other| other.key == order.key) {
            same.until = same.until.max(order.until);
            same.replies.extend(order.replies);
            return Ok(());
        }
        if state.waiting.len() + usize::from(state.rendering.is_some()) >= LIMIT {
            state.counts.refused += 1;
            return Err(PictureError::QueueFull { limit: LIMIT, retry_after: RETRY_FULL });
        }
        if !state.is_open {
            // It holds the service's parts only while it reads a table: the store closes with the service.
            let (desk, core, number) = (Arc::clone(self), Arc::downgrade(core), state.lost);
            // A driver in which a thread was lost is not asked again, unless nothing else may render.
            let adapter = if self.adapter == Adapter::Any && number > 0 { Adapter::Cpu } else { self.adapter };
            let run = move || {
                Studio::new(adapter, core).work(&desk, number);
                let mut state = desk.state();
                state.is_open &= state.lost != number;
                desk.changed.notify_all();
            };
            let spawned = thread::Builder::new().name("preview".to_owned()).spawn(run);
            spawned.map_err(|error| PictureError::Failed(format!("no thread: {error}")))?;
            state.is_open = true;
        }
        state.waiting.push_back(order);
        self.changed.notify_all();
        Ok(())
    }

    /// The next order that somebody waits for, for the thread of this number; `None` at the end of the service and to a
    /// thread that is lost. It counts as being rendered until [`Desk::finish`].
    pub(super) fn next(&self, number: u32) -> Option<Order> {
        let mut state = self.state();
        loop {
            if state.is_closed || state.lost != number {
                return None;
            }
            match state.waiting.pop_front() {
                Some(order) if order.is_given_up() => state.counts.given_up += 1,
                Some(order) => {
                    state.rendering = Some(order.until);
                    return Some(order);
                }
                None => state = self.changed.wait(state).unwrap_or_else(PoisonError::into_inner),
            }
        }
    }

    /// Keeps a picture.
    pub(super) fn keep(&self, key: Digest, file: PictureFile) {
        self.state().kept.keep(key, file);
    }

    /// A scene was rendered.
    pub(super) fn was_rendered_by(&self, adapter: &Arc<str>) {
        self.state().adapter = Some(Arc::clone(adapter));
    }

    /// The thread of this number does not render any more: that is how it ended.
    pub(super) fn finish(&self, number: u32, done: &Result<PictureFile, PictureError>) {
        let mut state = self.state();
        if state.lost != number {
            return;
        }
        state.rendering = None;
        match done {
            Ok(_) => state.counts.done += 1,
            Err(PictureError::TooSlow { .. } | PictureError::Stopping) => state.counts.given_up += 1,
            Err(_) => state.counts.failed += 1,
        }
    }

    /// As if a thread rendered a picture that is of no more use after `until`; without one, as if it had ended.
    #[cfg(test)]
    pub(super) fn pretend_to_render(&self, until: Option<Instant>) {
        let mut state = self.state();
        (state.is_open, state.rendering) = (until.is_some(), until);
    }

    /// Whether no thread renders or waits for orders.
    #[cfg(test)]
    pub(super) fn is_at_rest(&self) -> bool {
        !self.state().is_open
    }

    /// How many pictures ended how.
    pub(in crate::server::service) fn counts(&self) -> PictureCounts {
        self.state().counts
    }

    pub(super) fn is_closed(&self) -> bool {
        self.state().is_closed
    }

    /// Takes no more orders, drops those that wait and ends the thread.
    pub(in crate::server::service) fn close(&self) {
        let mut state = self.state();
        state.is_closed = true;
        state.waiting.clear();
        self.changed.notify_all();
        let waited = self.changed.wait_timeout_while(state, PATIENCE, |state| state.is_open);
        if waited.unwrap_or_else(PoisonError::into_inner).1.timed_out() {
            tracing::warn!("the renderer does not come back; the service ends without it");
        }
    }
}
