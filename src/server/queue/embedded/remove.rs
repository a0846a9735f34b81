//! Removing the rows of tasks that no job needs any more, a few at a time.
//!
//! A job of a million entries leaves tens of thousands of rows with its results. One transaction that removes them all
//! needs memory for each, and every worker waits for it. The conclusion of a job removes the first ones; the workers
//! remove the others, some with each lease and the rest when there is nothing else to do. What a process leaves behind is
//! removed at the next start.

use super::{
    jobs::{EmbeddedQueue, QueueState},
    record::JobRecord,
    remains::Remains,
};
use crate::{
    queue::JobId,
    store::{Batch, StoreError},
};

impl EmbeddedQueue {
    /// Removes some of the rows that ended jobs left behind; returns whether there are more. A failure is logged, and the
    /// next call tries again.
    pub(super) fn remove_some(&self, state: &mut QueueState) -> bool {
        let Some(first) = state.remains.front_mut() else { return false };
        let mut left = first.clone();
        let mut batch = Batch::default();
        left.remove_some(&mut batch);
        // A removal that a power cut undoes is done again at the next start.
        if let Err(error) = self.rows.stage(&batch) {
            tracing::warn!(job = %left.job, %error, "rows of an ended job could not be removed yet");
            return false;
        }
        *first = left;
        if first.is_empty() {
            state.remains.pop_front();
        }
        !state.remains.is_empty()
    }
}

impl EmbeddedQueue {
    /// Removes the rows of all tasks of a job, some at a time.
    ///
    /// # Errors
    /// When the database fails; some may be removed then.
    pub(super) fn remove_all(&self, record: &JobRecord) -> Result<(), StoreError> {
        let mut remains = Remains::of(record);
        while !remains.is_empty() {
            let mut batch = Batch::default();
            remains.remove_some(&mut batch);
            self.rows.stage(&batch)?;
        }
        Ok(())
    }
}

impl QueueState {
    /// Has the rows of an ended job's tasks removed.
    pub(super) fn leave(&mut self, remains: Remains) {
        if !remains.is_empty() {
            self.remains.push_back(remains);
        }
    }

    /// Keeps the rows of a job that is submitted again.
    pub(super) fn reclaim(&mut self, job: JobId) {
        self.remains.retain(|remains| remains.job != job);
    }
}

#[cfg(test)]
mod tests {
    use std::{
        num::NonZeroU32,
        sync::{Arc, atomic::Ordering},
        time::Duration,
    };

    use jiff::Timestamp;

    use super::{super::remains::AT_ONCE, *};
    use crate::{
        queue::{Demand, Job, JobState, Lease, Limits, NewJob, Offer, Queue as _, Submitted},
        store::{Rows, Tree, memory::MemoryRows},
    };
    use ltcforge_files::digest::Digest;

    /// Shards of a job, several times [`AT_ONCE`].
    const SHARDS: usize = 4 * AT_ONCE;

    fn open(rows: &Arc<MemoryRows>) -> EmbeddedQueue {
        let limits =
            Limits { jobs: 9, lease_ttl: Duration::from_secs(60), max_attempts: NonZeroU32::MIN, keep_ended: None };
        EmbeddedQueue::open(Arc::clone(rows) as Arc<dyn Rows>, limits, Arc::new(Timestamp::now)).unwrap()
    }

    fn submit(queue: &EmbeddedQueue) -> Job {
        let recipe_digest = Digest::of(b"recipe");
        let new = NewJob { recipe: "recipe".to_owned(), recipe_digest, shard_entries: vec![1; SHARDS] };
        match queue.submit(new, &|_| false) {
            Ok(Submitted::Queued(job)) => job,
            other => panic!("{other:?}"),
        }
    }

    fn lease(queue: &EmbeddedQueue, most: usize) -> Vec<Lease> {
        match queue.lease(0, Demand::Any, most.try_into().unwrap()) {
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
        assert_eq!(left(&rows), 3 * AT_ONCE, "the conclusion removes the first ones");
        assert_eq!((lease(&queue, 1), left(&rows)), (vec![], 2 * AT_ONCE));
        rows.full.store(true, Ordering::Relaxed);
        assert_eq!((lease(&queue, 1), left(&rows)), (vec![], 2 * AT_ONCE), "nothing is lost on a full disk");
        rows.full.store(false, Ordering::Relaxed);
        let Offer::Nothing { seen } = queue.lease(0, Demand::Any, 1.try_into().unwrap()) else { panic!("a task") };
        assert_eq!(left(&rows), AT_ONCE);
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

    #[test]
    fn a_job_that_is_submitted_again_keeps_what_is_still_there() {
        let rows = Arc::new(MemoryRows::default());
        let queue = open(&rows);
        let job = fitted(&queue);
        queue.cancel(job.id).unwrap();
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
