//! Removing jobs that ended long ago, and the rows of tasks that no job needs any more.
//!
//! A job of a million entries leaves tens of thousands of rows with its results. One transaction that removes them
//! all needs memory for each, and every worker waits for it. The end of a job removes the first ones; the workers
//! remove the others, some with each lease and the rest when there is nothing else to do. Rows that a process leaves
//! are removed at the next start.

use std::time::Duration;

use jiff::{SignedDuration, Timestamp};

use super::{
    record,
    state::{EmbeddedQueue, QueueState},
};
use crate::{
    queue::{JobId, JobState},
    store::{Batch, StoreError, Tree},
};

/// How often old jobs are looked for. Only submissions add jobs, so they are looked for at the start and then at
/// submissions.
const INTERVAL: Duration = Duration::from_secs(3600);

/// Jobs that are removed in one transaction.
const JOBS_AT_ONCE: usize = 256;

/// Tasks whose rows are removed in one transaction.
const TASKS_AT_ONCE: usize = 64;

impl EmbeddedQueue {
    /// Forgets jobs that ended longer ago than the limit, once an hour at most, and the oldest of too many. A failure is logged:
    /// the caller does not depend on it.
    pub(super) fn forget_old(&self, state: &mut QueueState) {
        self.forget_surplus(state);
        let now = (self.clock.steady)();
        let Some(keep) = self.limits.keep_ended.and_then(|keep| SignedDuration::try_from(keep).ok()) else { return };
        if state.next_forgetting.is_some_and(|next| now < next) {
            return;
        }
        state.next_forgetting = Some(now + INTERVAL);
        // A clock that is wrong is believed when it still says so the next time.
        let wall = (self.clock.wall)();
        let Ok(before) = std::mem::replace(&mut state.last_seen, wall).min(wall).checked_sub(keep) else { return };
        match self.forget_ended(state, before) {
            Ok(0) => {}
            Ok(jobs) => tracing::info!(jobs, %before, "jobs that ended by this time were forgotten"),
            Err(error) => tracing::warn!(%error, "old jobs could not be forgotten"),
        }
        self.remove_leftovers(state);
    }

    /// Forgets the jobs that ended first where there are more than the limit, and a sixteenth: then as many go at once.
    fn forget_surplus(&self, state: &mut QueueState) {
        let Some(most) = self.limits.most_ended.filter(|most| state.ended.len() > most + most / 16) else { return };
        let mut ended: Vec<_> = state
            .ended
            .iter()
            .map(|(submission, record)| (record.job.finished_at, *submission, record.job.id))
            .collect();
        ended.sort_unstable();
        let surplus: Vec<JobId> = ended[..ended.len() - most].iter().map(|(.., id)| *id).collect();
        match self.forget(state, &surplus) {
            Ok(()) => {
                tracing::info!(jobs = surplus.len(), "jobs that ended first were forgotten: their number has a limit");
            }
            Err(error) => tracing::warn!(%error, "jobs beyond their limit could not be forgotten"),
        }
    }

    /// Forgets every job that ended by `before`. Returns how many there were.
    fn forget_ended(&self, state: &mut QueueState, before: Timestamp) -> Result<usize, StoreError> {
        let is_old = |ended: Option<Timestamp>| ended.is_some_and(|ended| ended <= before);
        let old = state.ended.values().filter(|record| is_old(record.job.finished_at));
        let old: Vec<JobId> = old.map(|record| record.job.id).collect();
        self.forget(state, &old).map(|()| old.len())
    }

    /// Forgets ended jobs.
    fn forget(&self, state: &mut QueueState, old: &[JobId]) -> Result<(), StoreError> {
        for ids in old.chunks(JOBS_AT_ONCE) {
            let mut batch = Batch::default();
            for id in ids {
                batch.remove(Tree::Jobs, *id.as_bytes());
            }
            self.commit(state, batch)?;
            for id in ids {
                // The others have removed their rows.
                let failed = state.ended_job(*id).filter(|record| matches!(record.job.state, JobState::Failed { .. }));
                if let Some(tasks) = failed.map(record::JobRecord::tasks) {
                    state.leftovers.push_back((*id, tasks));
                }
                state.forget(*id);
            }
        }
        Ok(())
    }

    /// Removes some of the rows that ended jobs left; returns whether there are more. A failure is logged, and the
    /// next call tries again.
    pub(super) fn remove_leftovers(&self, state: &mut QueueState) -> bool {
        let Some((job, tasks)) = state.leftovers.front_mut() else { return false };
        let some = tasks.start..tasks.end.min(tasks.start.saturating_add(TASKS_AT_ONCE as u32));
        let mut batch = Batch::default();
        record::remove_tasks(&mut batch, some.clone().map(|task| record::task_key(*job, task)));
        // A removal that a power cut undoes is done again at the next start.
        if let Err(error) = self.rows.stage(&batch) {
            tracing::warn!(%job, %error, "rows of an ended job could not be removed yet");
            return false;
        }
        tasks.start = some.end;
        if tasks.start >= tasks.end {
            state.leftovers.pop_front();
        }
        !state.leftovers.is_empty()
    }

    /// Removes the rows of tasks of all jobs but those that are unfinished or have failed: the end of the last
    /// process, or a full disk, came first.
    pub(super) fn sweep(&self, state: &QueueState) -> Result<(), StoreError> {
        let is_kept = |id: JobId| {
            let failed = state.ended_job(id).is_some_and(|record| matches!(record.job.state, JobState::Failed { .. }));
            failed || state.active_job(id).is_some()
        };
        let mut keys: Vec<_> = self.rows.scan(Tree::Shards, &[])?.into_iter().map(|row| row.key).collect();
        keys.retain(|key| !key.get(..16).and_then(JobId::from_slice).is_some_and(is_kept));
        for some in keys.chunks(TASKS_AT_ONCE) {
            let mut batch = Batch::default();
            record::remove_tasks(&mut batch, some);
            match self.rows.stage(&batch) {
                // A later start removes them.
                Err(StoreError::DiskFull) => break,
                staged => staged?,
            };
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use std::{
        num::NonZeroU32,
        sync::{
            Arc,
            atomic::{AtomicI64, Ordering},
        },
    };

    use super::{super::state::Clock, *};
    use crate::{
        queue::{Demand, Job, Lease, Limits, NewJob, Offer, Queue as _, Submitted},
        store::{Rows, memory::MemoryRows},
    };
    use ltcforge_files::digest::Digest;

    /// Shards of a job, several times [`TASKS_AT_ONCE`].
    const SHARDS: usize = 4 * TASKS_AT_ONCE;

    fn open(rows: &Arc<MemoryRows>) -> EmbeddedQueue {
        let limits = Limits {
            jobs: 9,
            lease_ttl: Duration::from_secs(60),
            max_attempts: NonZeroU32::MIN,
            keep_ended: None,
            most_ended: None,
        };
        EmbeddedQueue::open(Arc::clone(rows) as Arc<dyn Rows>, limits, Clock::system()).unwrap()
    }

    fn submit(queue: &EmbeddedQueue) -> Job {
        let recipe_digest = Digest::of(b"recipe");
        let new = NewJob { recipe: "recipe".to_owned(), recipe_digest, shard_entries: vec![1; SHARDS], by: None };
        match queue.submit(new, &|_| false) {
            Ok(Submitted::Queued(job)) => job,
            other => panic!("{other:?}"),
        }
    }

    fn lease(queue: &EmbeddedQueue, most: usize) -> Vec<Lease> {
        match queue.lease(Demand::Any, most.try_into().unwrap()) {
            Offer::Tasks(tasks) => tasks.into_iter().map(|task| task.lease).collect(),
            Offer::Nothing { .. } => vec![],
            Offer::Closed => panic!("the queue is closed"),
        }
    }

    /// A job all of whose shards are finished.
    fn fitted(queue: &EmbeddedQueue) -> Job {
        let job = submit(queue);
        let leases = lease(queue, SHARDS);
        let done: Vec<(Lease, &[u8])> = leases.iter().map(|lease| (*lease, b"result".as_slice())).collect();
        assert!(queue.complete(&done).unwrap().iter().all(Result::is_ok));
        job
    }

    fn finish(queue: &EmbeddedQueue) {
        queue.finish(&lease(queue, 1)[0], Digest::of(b"table"), Batch::default()).unwrap();
    }

    /// Results that are still stored.
    fn left(rows: &MemoryRows) -> usize {
        rows.len(Tree::Results)
    }

    #[test]
    fn a_long_job_s_rows_are_removed_some_with_each_lease_and_all_of_them_by_an_idle_worker() {
        let rows = Arc::new(MemoryRows::default());
        let queue = open(&rows);
        fitted(&queue);
        finish(&queue);
        assert_eq!(left(&rows), 3 * TASKS_AT_ONCE, "the conclusion removes the first ones");
        assert_eq!((lease(&queue, 1), left(&rows)), (vec![], 2 * TASKS_AT_ONCE));
        rows.full.store(true, Ordering::Relaxed);
        assert_eq!((lease(&queue, 1), left(&rows)), (vec![], 2 * TASKS_AT_ONCE), "nothing is lost on a full disk");
        rows.full.store(false, Ordering::Relaxed);
        let Offer::Nothing { seen } = queue.lease(Demand::Any, 1.try_into().unwrap()) else { panic!("a task") };
        assert_eq!(left(&rows), TASKS_AT_ONCE);
        std::thread::scope(|scope| {
            let idle = scope.spawn(|| queue.wait(seen));
            while all_left(&rows) > 0 {
                std::thread::yield_now();
            }
            queue.close();
            idle.join().unwrap();
        });
    }

    /// Rows of tasks and results that are still stored.
    fn all_left(rows: &MemoryRows) -> usize {
        rows.len(Tree::Shards) + rows.len(Tree::Results)
    }

    #[test]
    fn what_a_process_leaves_behind_is_removed_at_the_next_start() {
        let rows = Arc::new(MemoryRows::default());
        let queue = open(&rows);
        let job = fitted(&queue);
        finish(&queue);
        drop(queue);
        assert!(left(&rows) > 0);
        let queue = open(&rows);
        assert_eq!(all_left(&rows), 0);
        assert!(matches!(queue.job(job.id).unwrap().unwrap().state, JobState::Done { .. }));
    }

    /// The hour of the look comes by the steady clock.
    #[test]
    fn a_clock_that_is_wrong_for_a_while_forgets_no_job() {
        const DAY: i64 = 86_400;
        let (wall, steady) = (Arc::new(AtomicI64::new(1_700_000_000)), Arc::new(AtomicI64::new(0)));
        let clock = Clock { steady: Clock::at(&steady).steady, ..Clock::at(&wall) };
        let limits = Limits {
            jobs: 99,
            lease_ttl: Duration::from_secs(60),
            max_attempts: NonZeroU32::MIN,
            keep_ended: Some(Duration::from_secs(30 * DAY.cast_unsigned())),
            most_ended: None,
        };
        let rows = Arc::new(MemoryRows::default());
        let open = || EmbeddedQueue::open(Arc::clone(&rows) as Arc<dyn Rows>, limits, clock.clone()).unwrap();
        let queue = open();
        let old = submit(&queue).id;
        queue.cancel(old, None).unwrap();
        let mut looks = 0;
        let mut look = |queue: &EmbeddedQueue| {
            looks += 1;
            steady.fetch_add(3600, Ordering::Relaxed);
            let recipe_digest = Digest::of(&[looks]);
            queue
                .submit(NewJob { recipe: String::new(), recipe_digest, shard_entries: vec![1], by: None }, &|_| false)
                .unwrap();
            queue.job(old).unwrap().is_some()
        };
        for jump in [1000 * DAY, -100_000 * DAY] {
            wall.fetch_add(jump, Ordering::Relaxed);
            assert!(open().job(old).unwrap().is_some(), "a process that starts meanwhile");
            assert!(look(&queue), "{jump}");
            wall.fetch_sub(jump, Ordering::Relaxed);
            assert!(look(&queue) && look(&queue), "{jump}");
        }
        wall.fetch_add(31 * DAY, Ordering::Relaxed);
        assert!(look(&queue) && !look(&queue), "time that has passed");
    }

    #[test]
    fn a_job_that_is_submitted_again_keeps_what_is_still_there() {
        let rows = Arc::new(MemoryRows::default());
        let queue = open(&rows);
        let job = fitted(&queue);
        queue.cancel(job.id, None).unwrap();
        let there = left(&rows);
        assert_eq!(submit(&queue).id, job.id);
        let again = lease(&queue, SHARDS);
        assert_eq!(again.len(), SHARDS - there, "only the others are fitted again");
        assert_eq!(all_left(&rows), 2 * there + again.len(), "a lease has a row, and nothing more was removed");
        let done: Vec<(Lease, &[u8])> = again.iter().map(|lease| (*lease, b"result".as_slice())).collect();
        assert!(queue.complete(&done).unwrap().iter().all(Result::is_ok));
        let mut results = 0;
        assert!(queue.results(&lease(&queue, 1)[0], &mut |_| results += 1).unwrap());
        assert_eq!(results, SHARDS);
    }
}
