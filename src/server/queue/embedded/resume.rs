//! Opening the queue and resuming the jobs of an earlier process.

use std::{
    collections::HashSet,
    sync::{Arc, Condvar, Mutex},
};

use super::{
    active::ActiveJob,
    jobs::{Clock, EmbeddedQueue, QueueState},
    reconcile::reconcile,
    record::JobRecord,
    task::TaskState,
};
use crate::server::{
    queue::{JobId, JobState, Limits},
    store::{Batch, Rows, StoreError, Tree},
};

impl EmbeddedQueue {
    /// Opens the queue in `rows`. Unfinished jobs are resumed: leases of the dead process are void and count as failed
    /// attempts, finished shards stay finished. Rows of jobs and the list of jobs are made to agree.
    ///
    /// # Errors
    /// When the database fails.
    pub fn open(rows: Arc<dyn Rows>, limits: Limits, clock: Clock) -> Result<Self, StoreError> {
        let queue = Self { rows, limits, clock, state: Mutex::new(QueueState::default()), changed: Condvar::new() };
        reconcile(queue.rows.as_ref())?;
        let mut keep = HashSet::new();
        {
            let mut state = queue.lock();
            let last = queue.rows.page(Tree::JobOrder, None, 1)?;
            let last = last.first().and_then(|row| Some(u64::from_be_bytes(row.key.as_slice().try_into().ok()?)));
            state.next_submission = last.map_or(0, |last| last + 1);
            let mut obsolete = Batch::default();
            for row in queue.rows.scan(Tree::Jobs, &[])? {
                let record = row.value.and_then(|value| serde_json::from_slice::<JobRecord>(&value).ok());
                let Some(record) = record else { continue };
                match record.job.state {
                    JobState::Queued | JobState::Running => {
                        keep.insert(record.job.id);
                        queue.resume(&mut state, record)?;
                    }
                    JobState::Failed { .. } => {
                        keep.insert(record.job.id);
                        *state.concluded.entry(record.job.state.name()).or_default() += 1;
                    }
                    JobState::Done { .. } | JobState::Cancelled => {
                        *state.concluded.entry(record.job.state.name()).or_default() += 1;
                    }
                }
            }
            queue.sweep(&mut obsolete, &keep)?;
            if !obsolete.is_empty() {
                queue.commit(&mut state, Ok(obsolete))?;
            }
            queue.forget_old(&mut state);
        }
        Ok(queue)
    }

    fn resume(&self, state: &mut QueueState, record: JobRecord) -> Result<(), StoreError> {
        let mut tasks = vec![TaskState::new(); record.shard_entries.len() + 1];
        let (id, submission) = (record.job.id, record.submission);
        let mut crashed = Vec::new();
        for (task, stored) in self.stored_tasks(id)? {
            let Some((slot, stored)) = tasks.get_mut(task as usize).zip(stored) else { continue };
            if let TaskState::Leased { attempt, .. } = stored {
                crashed.push((task, attempt));
            }
            *slot = stored;
        }
        let finished = tasks.iter().filter(|task| matches!(task, TaskState::Finished { .. })).count();
        tracing::info!(job = %id, finished, shards = record.shard_entries.len(), "the job is resumed");
        state.by_id.insert(id, submission);
        state.active.insert(submission, ActiveJob::new(record, tasks));
        for (task, attempt) in crashed {
            // An error means that the job has just failed through another of its leases.
            let _ = self.fail_task(state, submission, task, attempt, "the process ended while the task was leased");
        }
        Ok(())
    }

    /// Removes tasks and results of jobs that no longer need them; a full disk may have prevented that earlier.
    fn sweep(&self, batch: &mut Batch, keep: &HashSet<JobId>) -> Result<(), StoreError> {
        for row in self.rows.scan(Tree::Shards, &[])? {
            let id = row.key.get(..16).and_then(JobId::from_slice);
            if id.is_none_or(|id| !keep.contains(&id)) {
                batch.remove(Tree::Results, row.key.clone());
                batch.remove(Tree::Shards, row.key);
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use std::{
        num::{NonZeroU32, NonZeroUsize},
        path::Path,
        time::Duration,
    };

    use jiff::Timestamp;

    use super::*;
    use crate::{
        files::digest::Digest,
        server::{
            queue::{Demand, Lease, NewJob, Offer, Queue as _, StaleLease, Submitted, TaskKind},
            store::{Store, copy_folder},
        },
    };

    fn open(dir: &Path, max_attempts: u32) -> (EmbeddedQueue, Store) {
        let store = Store::open(dir).unwrap();
        let max_attempts = NonZeroU32::new(max_attempts).unwrap();
        let limits = Limits { jobs: 9, lease_ttl: Duration::from_secs(60), max_attempts, keep_ended: None };
        (EmbeddedQueue::open(Arc::clone(&store.rows), limits, Arc::new(Timestamp::now)).unwrap(), store)
    }

    fn submit(queue: &EmbeddedQueue) -> JobId {
        let recipe_digest = Digest::of(b"recipe");
        let new = NewJob { recipe: "recipe".to_owned(), recipe_digest, shard_entries: vec![1; 3] };
        assert!(matches!(queue.submit(new, &|_| false), Ok(Submitted::Queued(_))));
        JobId::of_recipe(&recipe_digest)
    }

    fn lease(queue: &EmbeddedQueue) -> (TaskKind, Lease) {
        match queue.lease(0, Demand::Any, NonZeroUsize::MIN) {
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
        assert_ne!(void, first, "another attempt");
        assert_eq!(again.complete(&[(first, b"late")]).unwrap(), [Err(StaleLease)]);
    }

    #[test]
    fn a_shard_that_crashes_the_process_every_time_fails_its_job() {
        let dir = tempfile::tempdir().unwrap();
        let mut last = dir.path().join("0");
        let id = submit(&open(&last, 2).0);
        for crash in 1..=2 {
            let (queue, _store) = open(&last, 2);
            assert_eq!(lease(&queue).0, TaskKind::Shard(0));
            // Committing another shard's result also writes the lease's row to the disk.
            let other = lease(&queue).1;
            queue.complete(&[(other, b"result")]).unwrap();
            last = dir.path().join(crash.to_string());
            copy_folder(&dir.path().join((crash - 1).to_string()), &last).unwrap();
        }
        let (queue, _store) = open(&last, 2);
        assert!(matches!(queue.job(id).unwrap().unwrap().state, JobState::Failed { .. }));
        assert!(matches!(queue.lease(0, Demand::Any, NonZeroUsize::MIN), Offer::Nothing { .. }));
    }
}
