//! The rows of jobs and the list of jobs compared with each other.

use std::collections::{BTreeMap, BTreeSet};

use serde::Serialize;

use super::{record, record::JobRecord};
use crate::{
    queue::JobId,
    store::{Batch, Rows, StoreError, Tree},
};
use ltcforge_files::{hex::to_hex, job::listed};

/// What was done to make the rows of jobs and the list of jobs agree.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
pub struct ReconciledJobs {
    /// Ids of jobs that were missing in the list.
    pub listed: Vec<String>,
    /// Ids of jobs that are in the list and have no row, or one that cannot be read.
    pub lost: Vec<String>,
    /// Places in the list that belong to no job. They are removed.
    pub places_without_job: usize,
}

/// Gives each job in `rows` its place in the list, and removes places without a job and rows that cannot be read.
///
/// # Errors
/// When the database fails.
pub fn reconcile(rows: &dyn Rows) -> Result<ReconciledJobs, StoreError> {
    let (mut jobs, mut lost) = (BTreeMap::new(), BTreeSet::new());
    let mut batch = Batch::default();
    for row in rows.scan(Tree::Jobs, &[])? {
        if let Some(record) = row.value.and_then(|value| serde_json::from_slice::<JobRecord>(&value).ok()) {
            jobs.insert(record.job.id, record);
        } else {
            lost.insert(to_hex(&row.key));
            batch.remove(Tree::Jobs, row.key);
        }
    }
    let (mut placed, mut places_without_job) = (BTreeMap::new(), 0);
    for row in rows.scan(Tree::JobOrder, &[])? {
        let submission = <[u8; 8]>::try_from(row.key.as_slice()).ok().map(u64::from_be_bytes);
        let id = row.value.as_deref().and_then(JobId::from_slice);
        let job = id.and_then(|id| jobs.get(&id));
        if let Some(job) = job.filter(|job| Some(job.submission) == submission) {
            placed.insert(job.submission, job.job.id);
            continue;
        }
        if let Some(id) = id.filter(|_| job.is_none()) {
            lost.insert(id.to_string());
        }
        places_without_job += 1;
        batch.remove(Tree::JobOrder, row.key);
    }
    let mut unused = jobs.values().map(|job| job.submission + 1).max().unwrap_or(0);
    let mut listed_now = Vec::new();
    for job in jobs.values_mut() {
        if placed.get(&job.submission) == Some(&job.job.id) {
            continue;
        }
        if placed.contains_key(&job.submission) {
            job.submission = unused;
            unused += 1;
        }
        placed.insert(job.submission, job.job.id);
        record::put_job(&mut batch, job)?;
        listed_now.push(job.job.id.to_string());
    }
    if !batch.is_empty() {
        rows.commit(&batch)?;
    }
    let done = ReconciledJobs { listed: listed_now, lost: lost.into_iter().collect(), places_without_job };
    done.log();
    Ok(done)
}

impl ReconciledJobs {
    fn log(&self) {
        if !self.lost.is_empty() {
            tracing::error!(
                jobs = listed(&self.lost),
                "these jobs have no row; they are lost and can be submitted again"
            );
        }
        if !self.listed.is_empty() {
            tracing::error!(jobs = listed(&self.listed), "these jobs were missing in the list and are added to it");
        }
        if self.places_without_job > 0 {
            tracing::error!(places = self.places_without_job, "places in the list belong to no job; they are removed");
        }
    }
}

#[cfg(test)]
mod tests {
    use std::{num::NonZeroU32, sync::Arc, time::Duration};

    use jiff::Timestamp;

    use super::*;
    use crate::{
        queue::{Limits, NewJob, Queue as _, embedded::EmbeddedQueue},
        store::memory::MemoryRows,
    };
    use ltcforge_files::digest::Digest;

    fn open(rows: &Arc<MemoryRows>) -> EmbeddedQueue {
        let lease_ttl = Duration::from_secs(60);
        let limits = Limits { jobs: 9, lease_ttl, max_attempts: NonZeroU32::MIN, keep_ended: None };
        EmbeddedQueue::open(rows.clone(), limits, Arc::new(Timestamp::now)).unwrap()
    }

    /// Rows of the jobs a, b and c, and the ids.
    fn three() -> (Arc<MemoryRows>, [JobId; 3]) {
        let rows = Arc::new(MemoryRows::default());
        let queue = open(&rows);
        let ids = ["a", "b", "c"].map(|name| {
            let recipe_digest = Digest::of(name.as_bytes());
            let new = NewJob { recipe: name.to_owned(), recipe_digest, shard_entries: vec![1] };
            queue.submit(new, &|_| false).unwrap();
            JobId::of_recipe(&recipe_digest)
        });
        (rows, ids)
    }

    fn recipes(queue: &EmbeddedQueue) -> Vec<String> {
        queue.list(None, None, 9).unwrap().0.into_iter().map(|job| job.recipe).collect()
    }

    #[test]
    fn jobs_that_agree_with_the_list_stay_as_they_are() {
        let (rows, _) = three();
        let commits = rows.commits.load(std::sync::atomic::Ordering::Relaxed);
        assert_eq!(reconcile(rows.as_ref()).unwrap(), ReconciledJobs::default());
        assert_eq!(rows.commits.load(std::sync::atomic::Ordering::Relaxed), commits);
    }

    #[test]
    fn a_job_without_a_place_gets_it_back() {
        let (rows, [_, b, _]) = three();
        let mut batch = Batch::default();
        batch.remove(Tree::JobOrder, 1_u64.to_be_bytes());
        rows.commit(&batch).unwrap();
        let copy = Arc::new(rows.after_power_cut());
        assert_eq!(recipes(&open(&copy)), ["c", "b", "a"], "each start does it");
        let done = reconcile(rows.as_ref()).unwrap();
        assert_eq!(done, ReconciledJobs { listed: vec![b.to_string()], ..Default::default() });
        assert_eq!(reconcile(rows.as_ref()).unwrap(), ReconciledJobs::default());
    }

    #[test]
    fn a_place_without_a_job_is_removed_and_the_job_named_as_lost() {
        let (rows, [a, _, c]) = three();
        let mut batch = Batch::default();
        batch.remove(Tree::Jobs, *c.as_bytes());
        // Another place of a job, a row that cannot be read, and a place that names nobody.
        batch.put(Tree::JobOrder, 7_u64.to_be_bytes(), *a.as_bytes());
        batch.put(Tree::Jobs, [9; 16], "no job");
        batch.put(Tree::JobOrder, 8_u64.to_be_bytes(), "nobody");
        rows.commit(&batch).unwrap();
        let done = reconcile(rows.as_ref()).unwrap();
        let mut lost = vec![c.to_string(), to_hex(&[9; 16])];
        lost.sort();
        assert_eq!(done, ReconciledJobs { lost, places_without_job: 3, ..Default::default() });
        assert_eq!((rows.len(Tree::Jobs), rows.len(Tree::JobOrder)), (2, 2));
        assert_eq!(recipes(&open(&rows)), ["b", "a"]);
    }

    #[test]
    fn two_jobs_with_one_place_get_one_each() {
        let (rows, [a, b, _]) = three();
        let value = rows.get(Tree::Jobs, b.as_bytes()).unwrap().unwrap();
        let mut record: JobRecord = serde_json::from_slice(&value).unwrap();
        record.submission = 0;
        let mut batch = Batch::default();
        batch.remove(Tree::JobOrder, 1_u64.to_be_bytes());
        batch.put(Tree::Jobs, *b.as_bytes(), serde_json::to_vec(&record).unwrap());
        rows.commit(&batch).unwrap();
        assert_eq!(reconcile(rows.as_ref()).unwrap().listed, [b.to_string()]);
        assert_eq!(rows.get(Tree::JobOrder, &0_u64.to_be_bytes()).unwrap().unwrap(), a.as_bytes());
        assert_eq!(recipes(&open(&rows)), ["b", "c", "a"]);
    }
}
