//! Jobs and tasks as rows.

use std::ops::Range;

use serde::{Deserialize, Serialize};

use super::task::Task;
use crate::{
    queue::{Job, JobId},
    store::{Batch, Rows, StoreError, Tree},
};
use ltcforge_files::hex::to_hex;

/// A job's row.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct JobRecord {
    /// Number of the submission. It orders the queue and distinguishes the leases of different submissions of a job.
    pub(super) submission: u64,
    /// Entries of each shard.
    pub shard_entries: Vec<u32>,
    /// The job.
    pub job: Job,
}

/// All jobs, first submitted first.
///
/// # Errors
/// When the database fails.
pub fn stored_jobs(rows: &dyn Rows) -> Result<Vec<JobRecord>, StoreError> {
    let mut records = Vec::new();
    for row in rows.scan(Tree::Jobs, &[])? {
        match serde_json::from_slice::<JobRecord>(&row.value.unwrap_or_default()) {
            Ok(record) => records.push(record),
            Err(error) => tracing::error!(job = to_hex(&row.key), %error, "the job cannot be read; it is lost"),
        }
    }
    records.sort_by_key(|record| record.submission);
    Ok(records)
}

/// The finished shards of a job with their results, in order.
///
/// # Errors
/// When the database fails. Results that cannot be read are left out; their shards are fitted again.
pub fn stored_results(rows: &dyn Rows, job: JobId) -> Result<Vec<(u32, Vec<u8>)>, StoreError> {
    let results = rows.scan(Tree::Results, job.as_bytes())?.into_iter();
    Ok(results.filter_map(|row| Some((task_of_key(&row.key)?, row.value?))).collect())
}

/// The stored tasks of a job; `None` for a damaged row.
pub(super) fn stored_tasks(rows: &dyn Rows, id: JobId) -> Result<Vec<(u32, Option<Task>)>, StoreError> {
    let rows = rows.scan(Tree::Shards, id.as_bytes())?.into_iter();
    let read = |value: Option<Vec<u8>>| serde_json::from_slice(&value?).ok();
    Ok(rows.filter_map(|row| Some((task_of_key(&row.key)?, read(row.value)))).collect())
}

/// Key of a task's row and of its result: job id and task, big-endian.
pub(super) fn task_key(job: JobId, task: u32) -> [u8; 20] {
    let mut key = [0; 20];
    key[..16].copy_from_slice(job.as_bytes());
    key[16..].copy_from_slice(&task.to_be_bytes());
    key
}

/// The task in a key of [`task_key`].
fn task_of_key(key: &[u8]) -> Option<u32> {
    Some(u32::from_be_bytes(key.get(16..)?.try_into().ok()?))
}

/// Puts a job's row into `batch`.
pub(super) fn put_job(batch: &mut Batch, record: &JobRecord) -> Result<(), StoreError> {
    batch.put(Tree::Jobs, *record.job.id.as_bytes(), encode(record)?);
    Ok(())
}

/// Puts a task's row into `batch`.
pub(super) fn put_task(batch: &mut Batch, job: JobId, number: u32, task: &Task) -> Result<(), StoreError> {
    batch.put(Tree::Shards, task_key(job, number), encode(task)?);
    Ok(())
}

/// Removes the rows of tasks and their results.
pub(super) fn remove_tasks(batch: &mut Batch, keys: impl IntoIterator<Item = impl AsRef<[u8]>>) {
    for key in keys {
        batch.remove(Tree::Shards, key.as_ref());
        batch.remove(Tree::Results, key.as_ref());
    }
}

impl JobRecord {
    /// Number of shards.
    pub(super) fn shards(&self) -> u32 {
        u32::try_from(self.shard_entries.len()).unwrap_or(u32::MAX)
    }

    /// All tasks: one more than there are shards, the assembly.
    pub(super) fn tasks(&self) -> Range<u32> {
        0..self.shards().saturating_add(1)
    }
}

fn encode(row: &impl Serialize) -> Result<Vec<u8>, StoreError> {
    serde_json::to_vec(row).map_err(|error| StoreError::Database(error.to_string()))
}

#[cfg(test)]
mod tests {
    use std::num::NonZeroU32;

    use jiff::Timestamp;

    use super::*;
    use crate::queue::{Claim, Failure, FailureKind, JobState, Priority};
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
                submitted_by: Some("farm".to_owned()),
                cancelled_by: None,
                claim: Claim { team: "lighting".to_owned(), share: NonZeroU32::MIN, priority: Priority::High },
            };
            let record = JobRecord { submission: 7, shard_entries: vec![2, 1], job };
            assert_eq!(serde_json::from_slice::<JobRecord>(&encode(&record).unwrap()).unwrap(), record);
        }
        assert_eq!(task_of_key(&task_key(JobId::of_recipe(&digest), 513)), Some(513));
        assert_eq!(task_of_key(b"short"), None);
    }
}
