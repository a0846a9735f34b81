//! Jobs and tasks as rows.

use serde::{Deserialize, Serialize};

use super::task::TaskState;
use crate::{
    queue::{Job, JobId},
    store::{Batch, StoreError, Tree},
};

/// A job's row.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct JobRecord {
    /// Number of the submission. It orders the queue and distinguishes the leases of different submissions of a job.
    pub(super) submission: u64,
    /// Entries of each shard.
    pub(super) shard_entries: Vec<u32>,
    /// The job.
    pub(super) job: Job,
}

/// Key of a task's row and of its result: job id and task, big-endian.
pub(super) fn task_key(job: JobId, task: u32) -> [u8; 20] {
    let mut key = [0; 20];
    key[..16].copy_from_slice(job.as_bytes());
    key[16..].copy_from_slice(&task.to_be_bytes());
    key
}

/// The task in a key of [`task_key`].
pub(super) fn task_of_key(key: &[u8]) -> Option<u32> {
    Some(u32::from_be_bytes(key.get(16..)?.try_into().ok()?))
}

/// Puts a job's row, and its place in the order, into `batch`.
pub(super) fn put_job(batch: &mut Batch, record: &JobRecord) -> Result<(), StoreError> {
    batch.put(Tree::Jobs, *record.job.id.as_bytes(), encode(record)?);
    batch.put(Tree::JobOrder, record.submission.to_be_bytes(), *record.job.id.as_bytes());
    Ok(())
}

/// Puts a task's row into `batch`.
pub(super) fn put_task(batch: &mut Batch, job: JobId, task: u32, state: &TaskState) -> Result<(), StoreError> {
    batch.put(Tree::Shards, task_key(job, task), encode(state)?);
    Ok(())
}

/// Removes the row of a task and its result.
pub(super) fn remove_task(batch: &mut Batch, job: JobId, task: u32) {
    batch.remove(Tree::Shards, task_key(job, task));
    batch.remove(Tree::Results, task_key(job, task));
}

impl JobRecord {
    /// Number of shards.
    pub(super) fn shards(&self) -> u32 {
        u32::try_from(self.shard_entries.len()).unwrap_or(u32::MAX)
    }
}

fn encode(row: &impl Serialize) -> Result<Vec<u8>, StoreError> {
    serde_json::to_vec(row).map_err(|error| StoreError::Database(error.to_string()))
}

#[cfg(test)]
mod tests {
    use jiff::Timestamp;

    use super::*;
    use crate::queue::{Failure, FailureKind, JobState};
    use ltcforge_files::digest::Digest;

    #[test]
    fn rows_come_back_as_they_were() {
        let digest = Digest::of(b"recipe");
        for state in [
            JobState::Queued,
            JobState::Done { table: digest },
            JobState::Failed { error: Failure { kind: FailureKind::DiskFull, detail: "full".to_owned() } },
        ] {
            let job = Job {
                id: JobId::of_recipe(&digest),
                recipe: "{}".to_owned(),
                recipe_digest: digest,
                state,
                entries_total: 3,
                entries_done: 1,
                attempts: 1,
                created_at: Timestamp::UNIX_EPOCH,
                started_at: None,
                finished_at: Some(Timestamp::MAX),
            };
            let record = JobRecord { submission: 7, shard_entries: vec![2, 1], job };
            let mut batch = Batch::default();
            put_job(&mut batch, &record).unwrap();
            assert_eq!(serde_json::from_slice::<JobRecord>(&encode(&record).unwrap()).unwrap(), record);
        }
        assert_eq!(task_of_key(&task_key(JobId::of_recipe(&digest), 513)), Some(513));
        assert_eq!(task_of_key(b"short"), None);
    }
}
