//! Forgetting jobs that ended long ago.

use jiff::{SignedDuration, Timestamp};

use super::{
    JobId, JobState, Queue,
    jobs::QueueState,
    record::{self, JobRecord},
};
use crate::server::store::{Batch, StoreError, Tree};

/// How often old jobs are looked for. Only submissions add rows, so they are looked for at the start and then at
/// submissions.
const INTERVAL: SignedDuration = SignedDuration::from_hours(1);

/// Jobs that are removed in one transaction.
const AT_ONCE: usize = 256;

impl Queue {
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
                forget(&mut batch, record);
            }
            self.commit(state, Ok(batch))?;
            for record in records {
                state.forget_concluded(Some(record));
            }
        }
        Ok(old.len())
    }
}

fn forget(batch: &mut Batch, record: &JobRecord) {
    batch.remove(Tree::Jobs, *record.job.id.as_bytes());
    batch.remove(Tree::JobOrder, record.submission.to_be_bytes());
    // The others have none.
    if matches!(record.job.state, JobState::Failed { .. }) {
        record::remove_tasks(batch, record);
    }
}

#[cfg(test)]
mod tests {
    use std::{
        num::NonZeroU32,
        sync::{Arc, Mutex},
        time::Duration,
    };

    use super::*;
    use crate::{
        files::digest::Digest,
        server::{
            queue::{Failure, FailureKind, Lease, Limits, NewJob, Offer, StateName, Submitted},
            store::{Rows as _, memory::MemoryRows},
        },
    };

    const DAY: Duration = Duration::from_secs(86_400);

    struct Setting {
        rows: Arc<MemoryRows>,
        now: Arc<Mutex<Timestamp>>,
    }

    impl Setting {
        fn new() -> Self {
            let now = Timestamp::from_second(1_700_000_000).unwrap();
            Self { rows: Arc::default(), now: Arc::new(Mutex::new(now)) }
        }

        fn open(&self, keep_ended: Option<Duration>) -> Queue {
            let limits = Limits { jobs: 9, lease_ttl: 9 * DAY, max_attempts: NonZeroU32::MIN, keep_ended };
            let now = Arc::clone(&self.now);
            Queue::open(self.rows.clone(), limits, Arc::new(move || *now.lock().unwrap())).unwrap()
        }

        fn pass(&self, time: Duration) {
            let mut now = self.now.lock().unwrap();
            *now = now.checked_add(time).unwrap();
        }
    }

    fn submit(queue: &Queue, name: &str) -> JobId {
        let recipe_digest = Digest::of(name.as_bytes());
        let new = NewJob { recipe: name.to_owned(), recipe_digest, shard_entries: vec![1; 2] };
        assert!(matches!(queue.submit(new, &|_| false), Ok(Submitted::Queued(_))));
        JobId::of_recipe(&recipe_digest)
    }

    fn lease(queue: &Queue) -> Lease {
        match queue.lease(0) {
            Offer::Task(task) => task.lease,
            other => panic!("{other:?}"),
        }
    }

    /// Jobs that were cancelled, failed with one finished shard, and are running.
    fn one_of_each(queue: &Queue) -> [JobId; 3] {
        let cancelled = submit(queue, "cancelled");
        queue.cancel(cancelled).unwrap();
        let failed = submit(queue, "failed");
        queue.complete(&lease(queue), b"result").unwrap();
        let error = Failure { kind: FailureKind::Attempts, detail: "no luck".to_owned() };
        queue.abort(&lease(queue), error).unwrap();
        let running = submit(queue, "running");
        lease(queue);
        [cancelled, failed, running]
    }

    #[test]
    fn jobs_that_ended_long_ago_are_forgotten_with_all_their_rows() {
        let setting = Setting::new();
        let queue = setting.open(Some(DAY));
        let [cancelled, failed, running] = one_of_each(&queue);
        setting.pass(DAY);
        let young = submit(&queue, "young");
        assert!(queue.job(cancelled).unwrap().is_some(), "a day is not over a day");
        setting.pass(Duration::from_secs(3600));
        submit(&queue, "another");
        assert_eq!([cancelled, failed].map(|id| queue.job(id).unwrap()), [None, None]);
        assert!([running, young].iter().all(|id| queue.job(*id).unwrap().is_some()));
        for (state, count) in queue.counts() {
            let expected = match state {
                StateName::Queued => 2,
                StateName::Running => 1,
                _ => 0,
            };
            assert_eq!(count, expected, "{state:?}");
        }
        assert_eq!((setting.rows.len(Tree::Jobs), setting.rows.len(Tree::JobOrder)), (3, 3));
        assert_eq!(setting.rows.len(Tree::Results), 0);
        assert!(setting.rows.scan(Tree::Shards, failed.as_bytes()).unwrap().is_empty());
        // It is simply a new job.
        submit(&queue, "cancelled");
        assert_eq!(queue.job(cancelled).unwrap().unwrap().state, JobState::Queued);
    }

    #[test]
    fn a_start_forgets_too_and_without_a_limit_nothing_is_forgotten() {
        let setting = Setting::new();
        let [cancelled, failed, running] = one_of_each(&setting.open(None));
        setting.pass(1000 * DAY);
        let queue = setting.open(None);
        assert!([cancelled, failed, running].iter().all(|id| queue.job(*id).unwrap().is_some()));
        let queue = setting.open(Some(DAY));
        assert_eq!(queue.job(cancelled).unwrap(), None);
        // The process ended while it was leased, which failed it just now.
        assert!(queue.job(running).unwrap().is_some());
    }
}
