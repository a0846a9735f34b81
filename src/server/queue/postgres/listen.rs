//! Notifications of other processes.

use std::{sync::Arc, time::Duration};

use tokio_postgres::AsyncMessage;

use super::shared::Shared;
use crate::queue::JobId;

/// How long until a lost connection is made again.
const PAUSE: Duration = Duration::from_millis(500);

/// What a notification says.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Message {
    /// There may be a task.
    Work,
    /// This job was submitted, and there are tasks.
    Begin(JobId),
    /// This job has ended, and the leases of the submission are void.
    End(JobId, u64),
}

impl Message {
    fn parse(text: &str) -> Option<Self> {
        let mut words = text.split(' ');
        let message = match words.next()? {
            "work" => Self::Work,
            "begin" => Self::Begin(words.next()?.parse().ok()?),
            "end" => Self::End(words.next()?.parse().ok()?, words.next()?.parse().ok()?),
            _ => return None,
        };
        words.next().is_none().then_some(message)
    }
}

/// Hears notifications for as long as the queue is open. While there is no connection, none is heard, and the callers ask
/// now and then.
pub(super) async fn listen(shared: &Arc<Shared>) {
    loop {
        let hears = Arc::clone(shared);
        let ended = shared.database.listen("LISTEN ltcforge", move |message| hear(&hears, &message)).await;
        if let Err(error) = ended {
            tracing::debug!(%error, "the connection for notifications was lost");
        }
        // Something may have been missed.
        shared.note_change(None);
        tokio::time::sleep(PAUSE).await;
    }
}

fn hear(shared: &Shared, message: &AsyncMessage) {
    let AsyncMessage::Notification(notification) = message else { return };
    match Message::parse(notification.payload()) {
        Some(Message::Work) => shared.note_change(None),
        Some(Message::Begin(job)) => shared.note_change(Some(job)),
        Some(Message::End(job, submission)) => {
            shared.held.lose(submission);
            shared.note_change(Some(job));
        }
        // A later version's.
        None => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ltcforge_files::digest::Digest;

    #[test]
    fn messages_are_read_and_others_ignored() {
        let job = JobId::of_recipe(&Digest::of(b"recipe"));
        assert_eq!(Message::parse("work"), Some(Message::Work));
        assert_eq!(Message::parse(&format!("begin {job}")), Some(Message::Begin(job)));
        assert_eq!(Message::parse(&format!("end {job} 7")), Some(Message::End(job, 7)));
        for text in ["", "end", "end x 7", "work work", "begin 7"] {
            assert_eq!(Message::parse(text), None, "{text}");
        }
    }
}
