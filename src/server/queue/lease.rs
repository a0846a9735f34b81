//! Leasing tasks, renewing leases, and what a worker reports under a lease.

use jiff::Timestamp;

use super::{
    Failure, JobState, Lease, Queue, StaleLease,
    active::ActiveJob,
    jobs::{QueueState, conclusion},
    record,
    task::TaskState,
};
use crate::{
    files::digest::Digest,
    server::store::{Batch, StoreError, Tree},
};

/// What a task consists of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TaskKind {
    /// Fit this shard, then [`Queue::complete`].
    Shard(u32),
    /// Assemble the table from all shards' results, then [`Queue::finish`].
    Assemble,
}

/// A task under a lease.
#[derive(Debug, Clone, PartialEq)]
pub struct LeasedTask {
    /// The lease to deliver under.
    pub lease: Lease,
    /// What to do.
    pub kind: TaskKind,
    /// The job it belongs to.
    pub job: super::JobId,
    /// The job's recipe.
    pub recipe: String,
    /// Its digest.
    pub recipe_digest: Digest,
}

/// The answer to a worker that asks for a task.
#[derive(Debug, Clone, PartialEq)]
pub enum Offer {
    /// A task under a lease.
    Task(LeasedTask),
    /// No task is available now: pass `seen` to [`Queue::wait`].
    Nothing {
        /// The generation of the queue that was seen.
        seen: u64,
    },
    /// The queue is closed.
    Closed,
}

/// Why a result was not accepted.
#[derive(Debug, thiserror::Error)]
pub enum LeaseError {
    /// The lease is not the current one.
    #[error(transparent)]
    Stale(#[from] StaleLease),
    /// It could not be stored; the lease is still held.
    #[error(transparent)]
    Store(#[from] StoreError),
}

impl Queue {
    /// Leases a waiting task of the job that has the fewest leased, and of such jobs the one that was served longest ago:
    /// jobs share the workers evenly, and a new one is served next. Of the tasks during which process after process ended
    /// one is leased at a time.
    pub fn lease(&self, worker: u32) -> Offer {
        let mut state = self.lock();
        if state.closed {
            return Offer::Closed;
        }
        let leased = self.lease_of(&mut state, worker, |_| true);
        leased.map_or(Offer::Nothing { seen: state.generation }, Offer::Task)
    }

    /// Leases a task of a job that no worker works for, if there is one.
    pub fn lease_unserved(&self, worker: u32) -> Offer {
        let mut state = self.lock();
        if state.closed {
            return Offer::Closed;
        }
        let leased = self.lease_of(&mut state, worker, |active| active.tasks_leased() == 0);
        leased.map_or(Offer::Nothing { seen: state.generation }, Offer::Task)
    }

    fn lease_of(&self, state: &mut QueueState, worker: u32, of: impl Fn(&ActiveJob) -> bool) -> Option<LeasedTask> {
        let now = (self.clock)();
        let until = self.expiry(now);
        let with_suspects = !state.active.values().any(ActiveJob::has_suspect_leased);
        let waiting = state.active.iter().filter(|(_, active)| of(active));
        let waiting =
            waiting.filter_map(|(submission, active)| Some((*submission, active, active.next_waiting(with_suspects)?)));
        let next =
            waiting.min_by_key(|(submission, active, _)| (active.tasks_leased(), active.last_served, *submission));
        let (submission, _, task) = next?;
        let active = state.active.get_mut(&submission)?;
        let leased = active.tasks.get(task as usize)?.lease(worker, until).ok()?;
        state.leases += 1;
        active.last_served = state.leases;
        let mut batch = Batch::default();
        let job = &mut active.record.job;
        let first = job.state == JobState::Queued;
        if first {
            job.state = JobState::Running;
            job.started_at = Some(now);
        }
        let id = job.id;
        let lease = Lease { submission, task, attempt: leased.attempt() };
        active.set(task, leased.clone());
        // A lease ends with the process. Its row only serves to count that, so the disk is waited for only while a task may
        // be what ended the last process: within moments of its lease, and again and again.
        let is_careful = state.careful_until.is_some_and(|until| now < until);
        let mut stored = record::put_task(&mut batch, id, task, &leased);
        if first {
            stored = stored.and_then(|()| record::put_job(&mut batch, &active.record));
        }
        let write = |batch: &Batch| if is_careful { self.rows.commit(batch) } else { self.rows.stage(batch) };
        if let Err(error) = stored.and_then(|()| write(&batch)) {
            tracing::warn!(job = %id, task, %error, "the lease could not be recorded");
        }
        let leased = LeasedTask {
            lease,
            kind: if task == active.assembly() { TaskKind::Assemble } else { TaskKind::Shard(task) },
            job: id,
            recipe: active.record.job.recipe.clone(),
            recipe_digest: active.record.job.recipe_digest,
        };
        state.next_expiry = Some(state.next_expiry.map_or(until, |expiry| expiry.min(until)));
        state.changed_jobs.insert(id);
        Some(leased)
    }

    /// Records the entries done so far and renews the lease, in memory only.
    ///
    /// # Errors
    /// When the lease is not the current one; the worker then stops.
    pub fn progress(&self, lease: &Lease, entries_done: u64) -> Result<(), StaleLease> {
        let until = self.expiry((self.clock)());
        let mut state = self.lock();
        let active = state.active.get_mut(&lease.submission).ok_or(StaleLease)?;
        active.tasks.get_mut(lease.task as usize).ok_or(StaleLease)?.extend(lease.attempt, until)?;
        active.report(lease.task, entries_done);
        Ok(())
    }

    /// Stores the result of a shard; it is durable when this returns.
    ///
    /// # Errors
    /// When the lease is not the current one, or the result cannot be stored.
    pub fn complete(&self, lease: &Lease, result: &[u8]) -> Result<(), LeaseError> {
        let mut state = self.lock();
        let (active, task) = state.current(lease)?;
        if lease.task == active.assembly() {
            return Err(StaleLease.into());
        }
        let finished = task.finish(lease.attempt)?;
        let id = active.record.job.id;
        let mut batch = Batch::default();
        record::put_task(&mut batch, id, lease.task, &finished)?;
        batch.put(Tree::Results, record::task_key(id, lease.task), result);
        self.commit(&mut state, Ok(batch))?;
        self.set(&mut state, lease, finished);
        Ok(())
    }

    /// The results of all shards, in order, for the worker that assembles. If results are lost or damaged, their shards
    /// are queued again, the assembly counts as failed, and the answer is `None`.
    ///
    /// # Errors
    /// When the lease is not the current one, or the database fails.
    pub fn results(&self, lease: &Lease) -> Result<Option<Vec<Vec<u8>>>, LeaseError> {
        let id = self.lock().current(lease)?.0.record.job.id;
        let mut results = Vec::with_capacity(lease.task as usize);
        let mut lost = Vec::new();
        for shard in 0..lease.task {
            match self.rows.get(Tree::Results, &record::task_key(id, shard)) {
                Ok(Some(result)) => results.push(result),
                Ok(None) | Err(StoreError::DamagedRow { .. }) => lost.push(shard),
                Err(error) => return Err(error.into()),
            }
        }
        if lost.is_empty() {
            return Ok(Some(results));
        }
        let mut state = self.lock();
        let error = format!("the results of shards {lost:?} are lost or damaged");
        self.fail_task(&mut state, lease.submission, lease.task, lease.attempt, &error)?;
        if !state.active.contains_key(&lease.submission) {
            // That was its last attempt, and the job has failed.
            return Ok(None);
        }
        for shard in lost {
            let waiting = TaskState::new();
            let mut batch = Batch::default();
            record::put_task(&mut batch, id, shard, &waiting)?;
            batch.remove(Tree::Results, record::task_key(id, shard));
            self.commit(&mut state, Ok(batch))?;
            self.set(&mut state, &Lease { task: shard, ..*lease }, waiting);
        }
        Ok(None)
    }

    /// Concludes a job whose table is stored; `with` is committed in the same transaction.
    ///
    /// # Errors
    /// When the lease is not the current one, or this cannot be stored.
    pub fn finish(&self, lease: &Lease, table: Digest, with: Batch) -> Result<(), LeaseError> {
        let mut state = self.lock();
        let (active, _) = state.current(lease)?;
        if lease.task != active.assembly() {
            return Err(StaleLease.into());
        }
        let record = active.concluded(JobState::Done { table }, (self.clock)());
        let mut batch = with;
        batch.extend(conclusion(&record)?);
        self.commit(&mut state, Ok(batch))?;
        state.conclude(&record);
        self.changed.notify_all();
        Ok(())
    }

    /// Gives a task back unfinished. This does not count as a failure.
    ///
    /// # Errors
    /// When the lease is not the current one.
    pub fn give_back(&self, lease: &Lease) -> Result<(), StaleLease> {
        let mut state = self.lock();
        let (active, task) = state.current(lease)?;
        let waiting = task.give_back(lease.attempt)?;
        let mut batch = Batch::default();
        let id = active.record.job.id;
        let stored = record::put_task(&mut batch, id, lease.task, &waiting).and_then(|()| self.rows.stage(&batch));
        if let Err(error) = stored {
            tracing::warn!(job = %id, task = lease.task, %error, "giving the lease back could not be recorded");
        }
        self.set(&mut state, lease, waiting);
        Ok(())
    }

    /// Reports that a task failed. It is tried again until it has failed too often.
    ///
    /// # Errors
    /// When the lease is not the current one.
    pub fn fail(&self, lease: &Lease, error: &str) -> Result<(), StaleLease> {
        let mut state = self.lock();
        self.fail_task(&mut state, lease.submission, lease.task, lease.attempt, error)
    }

    /// Fails the whole job of a lease, where another attempt would not help.
    ///
    /// # Errors
    /// When the lease is not the current one.
    pub fn abort(&self, lease: &Lease, error: Failure) -> Result<(), StaleLease> {
        let mut state = self.lock();
        state.current(lease)?;
        self.fail_job(&mut state, lease.submission, error);
        self.changed.notify_all();
        Ok(())
    }

    fn set(&self, state: &mut QueueState, lease: &Lease, task: TaskState) {
        if let Some(active) = state.active.get_mut(&lease.submission) {
            active.set(lease.task, task);
            let id = active.record.job.id;
            state.record_change(id);
        }
        self.changed.notify_all();
    }

    fn expiry(&self, now: Timestamp) -> Timestamp {
        now.checked_add(self.limits.lease_ttl).unwrap_or(Timestamp::MAX)
    }
}

#[cfg(test)]
mod tests {
    use std::{num::NonZeroU32, sync::Arc, time::Duration};

    use super::*;
    use crate::server::{
        queue::{Limits, NewJob},
        store::memory::MemoryRows,
    };

    fn queue() -> Queue {
        let limits =
            Limits { jobs: 9, lease_ttl: Duration::from_secs(60), max_attempts: NonZeroU32::MIN, keep_ended: None };
        Queue::open(Arc::new(MemoryRows::default()), limits, Arc::new(Timestamp::now)).unwrap()
    }

    fn submit(queue: &Queue, name: &str, shards: usize) {
        let new = NewJob {
            recipe: name.to_owned(),
            recipe_digest: Digest::of(name.as_bytes()),
            shard_entries: vec![1; shards],
        };
        queue.submit(new, &|_| false).unwrap();
    }

    fn lease(queue: &Queue) -> LeasedTask {
        match queue.lease(0) {
            Offer::Task(task) => task,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn jobs_share_the_workers_evenly_and_a_new_one_is_next() {
        let queue = queue();
        submit(&queue, "long", 9);
        assert_eq!([lease(&queue), lease(&queue)].map(|task| task.recipe), ["long", "long"]);
        submit(&queue, "new", 9);
        let tasks: Vec<LeasedTask> = (0..4).map(|_| lease(&queue)).collect();
        let names: Vec<&str> = tasks.iter().map(|task| task.recipe.as_str()).collect();
        // Two each; of equals the one that was served longest ago.
        assert_eq!(names, ["new", "new", "long", "new"]);
    }

    #[test]
    fn one_worker_alternates() {
        let queue = queue();
        submit(&queue, "a", 3);
        submit(&queue, "b", 3);
        let names: Vec<String> = (0..4)
            .map(|_| {
                let task = lease(&queue);
                queue.complete(&task.lease, b"result").unwrap();
                task.recipe
            })
            .collect();
        assert_eq!(names, ["a", "b", "a", "b"]);
    }

    #[test]
    fn a_job_without_workers_is_told_from_others() {
        let queue = queue();
        submit(&queue, "long", 9);
        lease(&queue);
        let nothing = |offer: Offer| assert!(matches!(offer, Offer::Nothing { .. }), "{offer:?}");
        nothing(queue.lease_unserved(1));
        submit(&queue, "new", 9);
        let Offer::Task(other) = queue.lease_unserved(1) else { panic!("the new job has no worker") };
        assert_eq!(other.recipe, "new");
        nothing(queue.lease_unserved(2));
        queue.complete(&other.lease, b"result").unwrap();
        assert!(matches!(queue.lease_unserved(2), Offer::Task(_)));
        queue.close();
        assert_eq!(queue.lease_unserved(3), Offer::Closed);
    }
}
