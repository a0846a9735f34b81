//! Opening the queue and resuming the jobs of an earlier process.

use std::{
    sync::{Arc, Condvar, Mutex},
    time::Duration,
};

use super::{
    active::ActiveJob,
    record::{self, JobRecord},
    state::{Clock, EmbeddedQueue, QueueState},
    task::{Task, TaskState},
};
use crate::{
    queue::{Limits, unique_number},
    store::{Rows, StoreError},
};

/// How long after a start with unfinished jobs leases are written to the disk. A process that lives longer has written
/// them by itself: sled does so twice a second.
const CAREFUL: Duration = Duration::from_secs(10);

impl EmbeddedQueue {
    /// Opens the queue in `rows`. Unfinished jobs are resumed: leases of the dead process are void and are counted,
    /// apart from failures; finished shards stay finished.
    ///
    /// # Errors
    /// When the database fails.
    pub fn open(rows: Arc<dyn Rows>, limits: Limits, clock: Clock) -> Result<Self, StoreError> {
        let (state, changed) = (Mutex::new(QueueState::default()), Condvar::new());
        let queue = Self { rows, limits, clock, first_name: unique_number(), state, changed };
        {
            let mut state = queue.lock();
            for mut record in record::stored_jobs(queue.rows.as_ref())? {
                // No two have one number, even if a damaged journal says so.
                record.submission = record.submission.max(state.next_submission);
                state.next_submission = record.submission + 1;
                state.by_id.insert(record.job.id, record.submission);
                state.last_seen = state.last_seen.max(record.job.finished_at.unwrap_or(record.job.created_at));
                if record.job.state.name().is_final() {
                    state.ended.insert(record.submission, record);
                } else {
                    queue.resume(&mut state, record)?;
                }
            }
            queue.sweep(&state)?;
            queue.forget_old(&mut state);
            if !state.active.is_empty() {
                state.careful_until = Some((queue.clock.steady)() + CAREFUL);
            }
        }
        Ok(queue)
    }

    fn resume(&self, state: &mut QueueState, record: JobRecord) -> Result<(), StoreError> {
        let mut tasks = vec![Task::default(); record.shard_entries.len() + 1];
        for (number, stored) in record::stored_tasks(self.rows.as_ref(), record.job.id)? {
            if let Some((slot, stored)) = tasks.get_mut(number as usize).zip(stored) {
                *slot = stored;
            }
        }
        let finished = tasks.iter().filter(|task| task.state == TaskState::Finished).count();
        tracing::info!(job = %record.job.id, finished, shards = record.shard_entries.len(), "the job is resumed");
        let submission = record.submission;
        let active = ActiveJob::new(record, tasks);
        let crashed: Vec<_> = active.leases().collect();
        state.activate(submission, active);
        for (lease, _) in crashed {
            // An error means that the job has just failed through another of its leases.
            let _ = self.count_death(state, &lease);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use std::{
        num::{NonZeroU32, NonZeroUsize},
        path::Path,
    };

    use super::*;
    use crate::{
        queue::{
            Demand, JobId, JobState, Lease, MOST_DEATHS, NewJob, Offer, Queue as _, StaleLease, Submitted, TaskKind,
        },
        store::{Batch, Store, copy_folder, memory::MemoryRows},
    };
    use ltcforge_files::digest::Digest;

    fn open(dir: &Path, max_attempts: u32) -> (EmbeddedQueue, Store) {
        let store = Store::open(dir).unwrap();
        let max_attempts = NonZeroU32::new(max_attempts).unwrap();
        let limits =
            Limits { jobs: 9, lease_ttl: Duration::from_secs(60), max_attempts, keep_ended: None, most_ended: None };
        (EmbeddedQueue::open(Arc::clone(&store.rows), limits, Clock::system()).unwrap(), store)
    }

    fn submit(queue: &EmbeddedQueue) -> JobId {
        let recipe_digest = Digest::of(b"recipe");
        let new = NewJob { recipe: "recipe".to_owned(), recipe_digest, shard_entries: vec![1; 3], by: None };
        assert!(matches!(queue.submit(new, &|_| false), Ok(Submitted::Queued(_))));
        JobId::of_recipe(&recipe_digest)
    }

    fn ask(queue: &EmbeddedQueue) -> Offer {
        queue.lease(Demand::Any, NonZeroUsize::MIN)
    }

    fn complete(queue: &EmbeddedQueue, lease: Lease) {
        assert_eq!(queue.complete(&[(lease, b"result")]).unwrap(), [Ok(())]);
    }

    fn lease(queue: &EmbeddedQueue) -> (TaskKind, Lease) {
        match ask(queue) {
            Offer::Tasks(leased) => (leased[0].kind, leased[0].lease),
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn after_kill_9_leases_are_void_and_finished_shards_stay_finished() {
        let dir = tempfile::tempdir().unwrap();
        let (alive, killed) = (dir.path().join("alive"), dir.path().join("killed"));
        let (queue, _store) = open(&alive, 3);
        let id = submit(&queue);
        let (task, first) = lease(&queue);
        assert_eq!(task, TaskKind::Shard(0));
        let second = lease(&queue).1;
        queue.complete(&[(second, b"result")]).unwrap();
        // kill -9 leaves the files as they are now: the first shard is leased, the second finished.
        copy_folder(&alive, &killed).unwrap();
        let (again, _copy) = open(&killed, 3);
        let job = again.job(id).unwrap().unwrap();
        assert_eq!((job.state, job.entries_done), (JobState::Running, 1));
        let (task, void) = lease(&again);
        assert_eq!(task, TaskKind::Shard(0), "the dead process's lease does not hold it");
        assert_eq!(lease(&again).0, TaskKind::Shard(2), "the second shard is not fitted again");
        assert_ne!(void, first, "another lease");
        assert_eq!(again.complete(&[(first, b"late")]).unwrap(), [Err(StaleLease)]);
    }

    /// Numbers of submissions and attempts come again then, for other jobs too.
    #[test]
    fn a_lease_from_before_the_folder_was_restored_is_refused() {
        let rows = Arc::new(MemoryRows::default());
        submit_one(&after_kill(&rows), "job");
        let backup = Arc::new(rows.after_power_cut());
        let late = lease(&after_kill(&rows)).1;
        let queue = after_kill(&backup);
        let (_, current) = lease(&queue);
        assert_eq!((late.submission, late.task), (current.submission, current.task));
        assert_eq!(queue.complete(&[(late, b"late")]).unwrap(), [Err(StaleLease)]);
        assert_eq!([queue.progress(&late, 1), queue.give_back(&late), queue.fail(&late, "late")], [Err(StaleLease); 3]);
        complete(&queue, current);
    }

    #[test]
    fn a_shard_that_ends_the_process_at_once_fails_its_job_in_the_end() {
        let dir = tempfile::tempdir().unwrap();
        let folder = |death: u32| dir.path().join(death.to_string());
        let id = submit(&open(&folder(0), 2).0);
        for death in 0..MOST_DEATHS {
            let (queue, _store) = open(&folder(death), 2);
            assert!(!queue.job(id).unwrap().unwrap().state.name().is_final(), "after {death} deaths");
            // Nothing else writes the lease's row to the disk.
            assert_eq!(lease(&queue).0, TaskKind::Shard(0));
            copy_folder(&folder(death), &folder(death + 1)).unwrap();
        }
        let (queue, _store) = open(&folder(MOST_DEATHS), 2);
        let JobState::Failed { error } = queue.job(id).unwrap().unwrap().state else { panic!("it goes on") };
        assert_eq!(error.detail, "shard 0 was being worked on each of the 20 times that the service's process ended");
        assert!(matches!(ask(&queue), Offer::Nothing { .. }));
    }

    /// Writes that reached the database survive kill -9.
    fn after_kill(rows: &Arc<MemoryRows>) -> EmbeddedQueue {
        let max_attempts = NonZeroU32::new(3).unwrap();
        let limits =
            Limits { jobs: 9, lease_ttl: Duration::from_secs(60), max_attempts, keep_ended: None, most_ended: None };
        EmbeddedQueue::open(Arc::clone(rows) as Arc<dyn Rows>, limits, Clock::system()).unwrap()
    }

    fn submit_one(queue: &EmbeddedQueue, name: &str) -> JobId {
        let recipe_digest = Digest::of(name.as_bytes());
        let new = NewJob { recipe: name.to_owned(), recipe_digest, shard_entries: vec![1], by: None };
        queue.submit(new, &|_| false).unwrap();
        JobId::of_recipe(&recipe_digest)
    }

    /// A damaged journal may have an earlier state of a job, with a number that was given again.
    #[test]
    fn two_jobs_of_one_submission_get_a_number_each_and_one_that_cannot_be_read_hides_no_other() {
        let rows = Arc::new(MemoryRows::default());
        let queue = after_kill(&rows);
        let ids = ["a", "b", "c"].map(|name| submit_one(&queue, name));
        let mut records = record::stored_jobs(rows.as_ref()).unwrap();
        let mut batch = Batch::default();
        records[1].submission = 0;
        record::put_job(&mut batch, &records[1]).unwrap();
        batch.put(crate::store::Tree::Jobs, [9; 16], "no job");
        rows.commit(&batch).unwrap();
        let queue = after_kill(&rows);
        assert!(ids.iter().all(|id| queue.job(*id).unwrap().is_some()));
        let all = queue.list(None, None, 9).unwrap().0;
        assert_eq!(all.len(), 3);
        assert_eq!(all[0].recipe, "c");
        submit_one(&queue, "d");
        assert_eq!(queue.list(None, None, 1).unwrap().0[0].recipe, "d");
    }

    #[test]
    fn a_job_outlives_many_kills_in_a_row() {
        let rows = Arc::new(MemoryRows::default());
        let id = submit_one(&after_kill(&rows), "job");
        for _ in 1..MOST_DEATHS {
            lease(&after_kill(&rows));
        }
        let queue = after_kill(&rows);
        complete(&queue, lease(&queue).1);
        queue.finish(&lease(&queue).1, Digest::of(b"table"), Batch::default()).unwrap();
        assert!(matches!(queue.job(id).unwrap().unwrap().state, JobState::Done { .. }));
    }

    /// It ends the process before the other's shard is finished, which is leased each time as well.
    #[test]
    fn a_task_that_ends_the_process_takes_no_other_job_with_it() {
        let rows = Arc::new(MemoryRows::default());
        let first = after_kill(&rows);
        let [deadly, other] = ["deadly", "other"].map(|name| submit_one(&first, name));
        drop(first);
        for _ in 0..MOST_DEATHS {
            let queue = after_kill(&rows);
            let Offer::Tasks(leased) = ask(&queue) else { panic!("nothing to do") };
            assert_eq!(leased[0].recipe, "deadly");
            if let Offer::Tasks(leased) = ask(&queue) {
                assert_eq!(leased[0].recipe, "other");
            }
        }
        let queue = after_kill(&rows);
        assert!(matches!(queue.job(deadly).unwrap().unwrap().state, JobState::Failed { .. }));
        complete(&queue, lease(&queue).1);
        assert_eq!(queue.job(other).unwrap().unwrap().entries_done, 1);
    }

    #[test]
    fn suspect_tasks_run_one_at_a_time_beside_all_others() {
        let rows = Arc::new(MemoryRows::default());
        submit(&after_kill(&rows));
        for _ in 0..3 {
            let queue = after_kill(&rows);
            lease(&queue);
            lease(&queue);
        }
        let queue = after_kill(&rows);
        let (suspect, its_lease) = lease(&queue);
        assert_eq!((suspect, lease(&queue).0), (TaskKind::Shard(0), TaskKind::Shard(2)));
        assert!(matches!(ask(&queue), Offer::Nothing { .. }), "shard 1 is suspect too");
        complete(&queue, its_lease);
        assert_eq!(lease(&queue).0, TaskKind::Shard(1));
    }
}
