//! Forgetting jobs that ended long ago.

use jiff::{SignedDuration, Timestamp};

use super::{
    jobs::{EmbeddedQueue, QueueState},
    remains::Remains,
};
use crate::{
    queue::{JobId, JobState},
    store::{Batch, StoreError, Tree},
};

/// How often old jobs are looked for. Only submissions add rows, so they are looked for at the start and then at
/// submissions.
const INTERVAL: SignedDuration = SignedDuration::from_hours(1);

/// Jobs that are removed in one transaction.
const AT_ONCE: usize = 256;

impl EmbeddedQueue {
    /// Removes the rows of jobs that ended longer ago than the limit, once an hour at most. A failure is logged: the
    /// caller does not depend on it.
    pub(super) fn forget_old(&self, state: &mut QueueState) {
        let now = (self.clock)();
        let Some(keep) = self.limits.keep_ended.and_then(|keep| SignedDuration::try_from(keep).ok()) else { return };
        if state.next_forgetting.is_some_and(|next| now < next) {
            return;
        }
        state.next_forgetting = now.checked_add(INTERVAL).ok();
        let Ok(before) = now.checked_sub(keep) else { return };
        match self.forget_ended(state, before) {
            Ok(0) => {}
            Ok(jobs) => tracing::info!(jobs, %before, "jobs that ended before this time were forgotten"),
            Err(error) => tracing::warn!(%error, "old jobs could not be forgotten"),
        }
        self.remove_some(state);
    }

    /// Forgets every job that ended before `before`. Returns how many there were.
    fn forget_ended(&self, state: &mut QueueState, before: Timestamp) -> Result<usize, StoreError> {
        let mut old = Vec::new();
        for row in self.rows.scan(Tree::JobOrder, &[])? {
            let Some(id) = row.value.and_then(|id| JobId::from_slice(&id)) else { continue };
            if state.by_id.contains_key(&id) || state.unsaved.contains_key(&id) {
                continue;
            }
            let Some(record) = self.record(state, id)? else { continue };
            if record.job.finished_at.is_some_and(|ended| ended < before) {
                old.push(record);
            } else if record.job.created_at >= before {
                // Later submissions are younger still.
                break;
            }
        }
        for records in old.chunks(AT_ONCE) {
            let mut batch = Batch::default();
            for record in records {
                batch.remove(Tree::Jobs, *record.job.id.as_bytes());
                batch.remove(Tree::JobOrder, record.submission.to_be_bytes());
            }
            self.commit(state, batch)?;
            for record in records {
                state.forget_concluded(Some(record));
                // The others have none.
                if matches!(record.job.state, JobState::Failed { .. }) {
                    state.leave(Remains::of(record));
                }
            }
        }
        Ok(old.len())
    }
}
