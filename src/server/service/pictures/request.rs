//! A request for a picture.

use std::time::{Duration, Instant};

use tokio::sync::oneshot;

use super::picture::{PictureError, PictureFile, Subject};
use ltcforge_files::digest::Digest;

/// A picture to render.
#[derive(Debug)]
pub(super) struct PictureRequest {
    /// The tag without an adapter: equal requests have equal keys.
    pub(super) key: Digest,
    /// The table that it shows, if any.
    pub(super) table: Option<Digest>,
    pub(super) subject: Subject,
    /// How long it may take, from when it starts to be rendered.
    pub(super) limit: Duration,
    /// One for each caller that waits.
    pub(super) replies: Vec<Reply>,
}

/// Where a caller waits.
#[derive(Debug)]
pub(super) struct Reply {
    /// Takes the deadline when the picture starts to be rendered.
    started: Option<oneshot::Sender<Instant>>,
    /// Closed if the caller no longer waits.
    file: oneshot::Sender<Result<PictureFile, PictureError>>,
}

/// What a caller waits for. Dropping this withdraws the request.
#[derive(Debug)]
pub(super) struct Receipt {
    /// The deadline, once the picture starts to be rendered; closed if it never does.
    pub(super) started: oneshot::Receiver<Instant>,
    pub(super) file: oneshot::Receiver<Result<PictureFile, PictureError>>,
}

impl Reply {
    /// A reply and what it is received by.
    pub(super) fn new() -> (Self, Receipt) {
        let ((started, when_started), (file, when_ready)) = (oneshot::channel(), oneshot::channel());
        (Self { started: Some(started), file }, Receipt { started: when_started, file: when_ready })
    }
}

impl PictureRequest {
    /// Whether no caller waits any more.
    pub(super) fn is_withdrawn(&self) -> bool {
        self.replies.iter().all(|reply| reply.file.is_closed())
    }

    /// Tells every caller that the picture starts to be rendered, and until when it may take.
    pub(super) fn start(&mut self, deadline: Instant) {
        for started in self.replies.iter_mut().filter_map(|reply| reply.started.take()) {
            // An error means that this caller no longer waits.
            let _ = started.send(deadline);
        }
    }

    /// Sends the result to every caller.
    pub(super) fn reply(self, result: &Result<PictureFile, PictureError>) {
        for reply in self.replies {
            // As above.
            let _ = reply.file.send(result.clone());
        }
    }
}
