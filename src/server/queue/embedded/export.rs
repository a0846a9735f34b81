//! The jobs of an embedded queue, for another queue to take over.

use super::record::{self, JobRecord};
use crate::{
    queue::{Job, JobId},
    store::{Rows, StoreError, Tree},
};

/// A job with its shards.
#[derive(Debug, Clone, PartialEq)]
pub struct StoredJob {
    /// The job.
    pub job: Job,
    /// Entries of each shard.
    pub shard_entries: Vec<u32>,
}

/// All jobs, first submitted first.
///
/// # Errors
/// When the database fails. Rows that cannot be read are left out; opening the queue names them.
pub fn stored_jobs(rows: &dyn Rows) -> Result<Vec<StoredJob>, StoreError> {
    let records = rows.scan(Tree::Jobs, &[])?.into_iter();
    let mut records: Vec<JobRecord> = records.filter_map(|row| serde_json::from_slice(&row.value?).ok()).collect();
    records.sort_by_key(|record| record.submission);
    Ok(records.into_iter().map(|JobRecord { job, shard_entries, .. }| StoredJob { job, shard_entries }).collect())
}

/// The finished shards of a job with their results, in order.
///
/// # Errors
/// When the database fails. Results that cannot be read are left out; their shards are fitted again.
pub fn stored_results(rows: &dyn Rows, job: JobId) -> Result<Vec<(u32, Vec<u8>)>, StoreError> {
    let results = rows.scan(Tree::Results, job.as_bytes())?.into_iter();
    Ok(results.filter_map(|row| Some((record::task_of_key(&row.key)?, row.value?))).collect())
}
