//! Jobs in rows of the database, and in memory.

use serde::{Deserialize, Serialize};

use crate::{
    queue::{Job, JobId, Shard, TaskKind, order},
    store::{Batch, StoreError, Tree},
};

/// The row of a job.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Record {
    pub(super) job: Job,
    /// The number of the submission.
    pub(super) submission: u64,
    /// The fitter version of the job's results.
    pub(super) fitter: u32,
    /// The start of the job on the virtual clock of [`order`].
    pub(super) base: i64,
    /// The shards. Empty once the job is done or cancelled.
    pub(super) shards: Vec<Shard>,
}

impl Record {
    /// Adds the row to `batch`.
    pub(super) fn put(&self, batch: &mut Batch) -> Result<(), StoreError> {
        let value = serde_json::to_vec(self).map_err(|error| StoreError::Database(error.to_string()))?;
        batch.put(Tree::Jobs, *self.job.id.as_bytes(), value);
        Ok(())
    }
}

/// The key of a shard's result.
pub(super) fn result_key(job: JobId, shard: u32) -> Vec<u8> {
    [&job.as_bytes()[..], &shard.to_be_bytes()].concat()
}

/// The inverse of [`result_key`].
pub(super) fn parse_result_key(key: &[u8]) -> Option<(JobId, u32)> {
    let (job, shard) = key.split_at_checked(16)?;
    Some((JobId::from_slice(job)?, u32::from_be_bytes(shard.try_into().ok()?)))
}

/// The state of a task.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum TaskState {
    /// An assembly with unfinished shards, or a task of a doomed job.
    Blocked,
    /// No worker has the task.
    Waiting,
    /// A worker has the task.
    Leased {
        /// The number of the lease. Results under another number are refused.
        number: u64,
        /// When the lease expires, by the steady clock.
        until: std::time::Duration,
        /// Number of finished entries that the worker has reported.
        entries: u64,
    },
    /// The result of the shard is stored.
    Finished,
}

/// A task of an unfinished job.
#[derive(Debug, Clone, Copy)]
pub(super) struct Task {
    pub(super) tag: i64,
    pub(super) state: TaskState,
    /// Number of leases, except leases that were given back.
    pub(super) leases: u32,
    /// Number of reported failures.
    pub(super) failures: u32,
}

/// A job in memory.
#[derive(Debug)]
pub(super) struct Entry {
    pub(super) record: Record,
    /// A task for each shard, then the assembly; empty once the job has ended.
    pub(super) tasks: Vec<Task>,
    /// Number of unfinished shards.
    pub(super) unfinished: usize,
    /// Shards of a failed job whose results are stored.
    pub(super) kept: Vec<u32>,
    /// Whether the row says that the job is running.
    pub(super) is_stored_as_running: bool,
}

impl Entry {
    /// An unfinished job. `finished` lists its finished shards in ascending order.
    pub(super) fn unfinished(record: Record, finished: &[u32]) -> Self {
        let is_finished = |number| finished.binary_search(&number).is_ok();
        let tags = order::tags(record.base, &record.shards, is_finished);
        let unfinished = record.shards.len() - finished.len();
        let tasks = (0..).zip(tags).map(|(number, tag)| {
            let state = match number as usize == record.shards.len() {
                true if unfinished > 0 => TaskState::Blocked,
                false if is_finished(number) => TaskState::Finished,
                _ => TaskState::Waiting,
            };
            Task { tag, state, leases: 0, failures: 0 }
        });
        let is_stored_as_running = record.job.started_at.is_some();
        Self { tasks: tasks.collect(), unfinished, kept: vec![], is_stored_as_running, record }
    }

    /// A job that has ended, with the shards whose results are stored.
    pub(super) fn ended(record: Record, kept: Vec<u32>) -> Self {
        Self { record, tasks: vec![], unfinished: 0, kept, is_stored_as_running: true }
    }

    /// The kind of a task.
    pub(super) fn kind(&self, task: u32) -> TaskKind {
        if task as usize == self.record.shards.len() { TaskKind::Assemble } else { TaskKind::Shard(task) }
    }

    /// Shards whose results are stored.
    pub(super) fn finished(&self) -> Vec<u32> {
        if self.tasks.is_empty() {
            return self.kept.clone();
        }
        let tasks = (0..).zip(&self.tasks);
        tasks.filter(|(_, task)| task.state == TaskState::Finished).map(|(number, _)| number).collect()
    }

    /// Adds the removal of the job's row and results to `batch`.
    pub(super) fn remove(&self, batch: &mut Batch) {
        batch.remove(Tree::Jobs, *self.record.job.id.as_bytes());
        self.remove_results(batch);
    }

    /// Adds the removal of the stored results to `batch`.
    pub(super) fn remove_results(&self, batch: &mut Batch) {
        self.finished().iter().for_each(|shard| batch.remove(Tree::Results, result_key(self.record.job.id, *shard)));
    }

    /// The current state of the job.
    pub(super) fn job(&self) -> Job {
        let mut job = self.record.job.clone();
        if self.tasks.is_empty() {
            return job;
        }
        let done = self.tasks.iter().zip(&self.record.shards).map(|(task, shard)| match task.state {
            TaskState::Finished => shard.entries.into(),
            TaskState::Leased { entries, .. } => entries.min(shard.entries.into()),
            TaskState::Blocked | TaskState::Waiting => 0,
        });
        job.entries_done = done.sum();
        job.attempts = self.tasks.iter().map(|task| task.leases).fold(job.attempts, u32::max);
        job
    }
}
