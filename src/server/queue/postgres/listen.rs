//! Notifications of other processes.

use std::{sync::Arc, time::Duration};

use tokio_postgres::AsyncMessage;

use super::{changes::Changes, held::Held};
use crate::store::Database;

/// The pause before a lost connection is made again.
const PAUSE: Duration = Duration::from_millis(500);

/// Listens for notifications while the queue is open. Without a connection none arrives, and the callers ask now and
/// then.
pub(super) async fn listen(database: &Database, held: &Arc<Held>, changes: &Arc<Changes>) {
    loop {
        let on_message = |message| {
            if let AsyncMessage::Notification(notification) = message {
                hear(notification.payload(), held, changes);
            }
        };
        if let Err(error) = database.listen("LISTEN ltcforge", on_message).await {
            tracing::debug!(%error, "the connection for notifications was lost");
        }
        // Notifications may have been missed.
        changes.note(None);
        tokio::time::sleep(PAUSE).await;
    }
}

/// The payload is `work` when there may be a task, `begin JOB` for a new job, and `end JOB SUBMISSION` for a job that
/// has ended, whose leases are void. Later versions may send others.
fn hear(payload: &str, held: &Held, changes: &Changes) {
    let mut words = payload.split(' ').skip(1);
    let job = words.next().and_then(|id| id.parse().ok());
    if let Some(submission) = words.next().and_then(|submission| submission.parse().ok()) {
        held.remove_all(submission);
    }
    changes.note(job);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::queue::{JobId, Lease};
    use ltcforge_files::digest::Digest;

    #[test]
    fn notifications_wake_callers_and_the_end_of_a_job_voids_its_leases() {
        let (job, held, changes) = (JobId::of_recipe(&Digest::of(b"recipe")), Held::default(), Changes::default());
        let lease = |submission| Lease { submission, task: 0, name: 1 };
        held.add([lease(7), lease(8)].into_iter());
        for text in ["work", "", "later", &format!("begin {job}"), "end x y"] {
            let before = changes.generation();
            hear(text, &held, &changes);
            assert_ne!(changes.generation(), before, "{text}");
        }
        assert_eq!(changes.take_jobs(), [job].into());
        assert!(held.report(&lease(7), 1).is_ok());
        hear(&format!("end {job} 7"), &held, &changes);
        assert_eq!(changes.take_jobs(), [job].into());
        assert!(held.report(&lease(7), 1).is_err() && held.report(&lease(8), 1).is_ok());
    }
}
