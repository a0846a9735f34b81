//! The queue in PostgreSQL. Any number of processes can share it.
//!
//! Invariant: only the database's clock determines when leases expire. A transaction that locks the row of a job does
//! so before it locks the rows of the job's tasks.

mod jobs;
mod results;
mod submit;
mod tasks;

use std::{
    num::NonZeroUsize,
    sync::{
        Arc, Condvar, Mutex, PoisonError,
        atomic::{AtomicU64, Ordering},
    },
    time::Duration,
};

use super::{
    Depth, Job, JobId, JobPage, JobState, Lease, LeaseError, LeasedTask, Limits, NewJob, Queue, QueueError, Release,
    StaleLease, StateName, Statistics, Submitted,
};
use crate::store::{Batch, Database, StoreError};
use ltcforge_files::digest::Digest;

/// The pause between two queries for waiting tasks.
const ASK: Duration = Duration::from_millis(500);

/// A queue in a PostgreSQL database.
#[derive(Debug)]
pub struct PostgresQueue {
    database: Arc<Database>,
    limits: Limits,
    /// The fitter version of this process. It leases no tasks of jobs with another version.
    fitter: i32,
    is_closed: Mutex<bool>,
    closed: Condvar,
    expired: AtomicU64,
    failed: AtomicU64,
}

impl PostgresQueue {
    /// The queue in `database`. It leases only tasks of jobs with the version `fitter`.
    #[must_use]
    pub fn new(database: Arc<Database>, limits: Limits, fitter: u32) -> Self {
        Self {
            database,
            limits,
            fitter: fitter.cast_signed(),
            is_closed: Mutex::new(false),
            closed: Condvar::new(),
            expired: AtomicU64::new(0),
            failed: AtomicU64::new(0),
        }
    }

    /// Submission, task and number of a lease, as columns.
    fn fence(lease: &Lease) -> (i64, i32, i64) {
        (lease.submission.cast_signed(), lease.task.cast_signed(), lease.number.cast_signed())
    }
}

impl Queue for PostgresQueue {
    fn submit(&self, new: NewJob, has_table: &dyn Fn(Digest) -> bool) -> Result<Submitted, QueueError> {
        let known = self.job(JobId::of_recipe(&new.recipe_digest))?;
        let mut missing = None;
        if let Some(job) = known
            && let JobState::Done { table } = job.state
        {
            if has_table(table) {
                return Ok(Submitted::Done(job, table));
            }
            missing = Some(table);
        }
        self.forget()?;
        self.store_new(&new, missing)
    }

    fn cancel(&self, id: JobId, by: Option<&str>) -> Result<Option<Job>, StoreError> {
        self.cancel_job(id, by)?;
        self.job(id)
    }

    fn lease(&self, most: NonZeroUsize) -> Result<Vec<LeasedTask>, StoreError> {
        if *self.is_closed.lock().unwrap_or_else(PoisonError::into_inner) {
            return Ok(vec![]);
        }
        self.lease_waiting(most)
    }

    fn renew(&self, leases: &[(Lease, u64)]) -> Result<Vec<Result<(), StaleLease>>, StoreError> {
        let answers = self.renew_leases(leases)?;
        self.put_back_expired()?;
        Ok(answers)
    }

    fn complete(&self, done: &[(Lease, Vec<u8>)]) -> Result<Vec<Result<(), StaleLease>>, StoreError> {
        self.store_results(done)
    }

    fn results(&self, lease: &Lease) -> Result<Vec<Vec<u8>>, LeaseError> {
        self.read_results(lease)
    }

    fn finish(&self, lease: &Lease, table: Digest, rows: Batch) -> Result<(), LeaseError> {
        self.finish_job(lease, table, &rows)
    }

    fn release(&self, lease: &Lease, how: Release) -> Result<(), LeaseError> {
        let error = match how {
            Release::GiveBack => None,
            Release::Failed(error) => {
                tracing::warn!(?lease, error, "a task failed");
                Some(error)
            }
            Release::Abort(failure) => {
                self.failed.fetch_add(1, Ordering::Relaxed);
                return self.abort(lease, &failure);
            }
        };
        self.failed.fetch_add(u64::from(error.is_some()), Ordering::Relaxed);
        self.put_back(lease, error.as_deref())
    }

    fn job(&self, id: JobId) -> Result<Option<Job>, StoreError> {
        Ok(self.jobs("id = $1", &[&id.as_bytes().as_slice()])?.pop().map(|(_, job)| job))
    }

    fn job_of_table(&self, table: Digest) -> Result<Option<Job>, StoreError> {
        Ok(self.jobs("table_digest = $1 LIMIT 1", &[&table.as_bytes().as_slice()])?.pop().map(|(_, job)| job))
    }

    fn list(&self, wanted: Option<StateName>, before: Option<u64>, limit: usize) -> Result<JobPage, StoreError> {
        let before = before.map_or(i64::MAX, |before| i64::try_from(before).unwrap_or(i64::MAX));
        // One extra row shows whether there is a next page.
        let one_more = i64::try_from(limit).unwrap_or(i64::MAX).saturating_add(1);
        let mut page = match wanted {
            None => self.jobs("submission < $1 ORDER BY submission DESC LIMIT $2", &[&before, &one_more])?,
            Some(state) => {
                let those = "state = $3 AND submission < $1 ORDER BY submission DESC LIMIT $2";
                self.jobs(those, &[&before, &one_more, &state.text()])?
            }
        };
        let has_more = page.len() > limit;
        page.truncate(limit);
        let next = page.last().filter(|_| has_more).map(|(submission, _)| *submission);
        Ok((page.into_iter().map(|(_, job)| job).collect(), next))
    }

    fn statistics(&self) -> Result<Statistics, StoreError> {
        let counts = "SELECT state, count(*) FROM ltcforge.jobs GROUP BY state";
        let shards = "SELECT count(*) FILTER (WHERE state = 'waiting'), count(*) FILTER (WHERE state = 'leased'),
            coalesce(sum(seconds), 0) FROM ltcforge.tasks WHERE state IN ('waiting', 'leased') AND NOT is_assembly";
        let oldest = "SELECT min(created_at) FROM ltcforge.jobs WHERE state IN ('queued', 'running')";
        self.database.run(async |client| {
            let counted = client.query(&client.prepare_cached(counts).await?, &[]).await?;
            let count = |name: StateName| {
                let row = counted.iter().find(|row| row.get::<_, &str>(0) == name.text());
                (name, row.map_or(0, |row| row.get::<_, i64>(1).cast_unsigned()))
            };
            let row = client.query_one(&client.prepare_cached(shards).await?, &[]).await?;
            let [waiting, leased] = [0, 1].map(|column| row.get::<_, i64>(column).cast_unsigned());
            Ok(Statistics {
                jobs: StateName::ALL.map(count).to_vec(),
                depth: Depth { waiting, leased },
                core_seconds: row.get(2),
                oldest: client.query_one(&client.prepare_cached(oldest).await?, &[]).await?.get(0),
            })
        })
    }

    fn failures(&self) -> (u64, u64) {
        (self.expired.load(Ordering::Relaxed), self.failed.load(Ordering::Relaxed))
    }

    /// Returns after `ASK` at the latest, because other processes change the queue without notifying this one.
    fn wait(&self, most: Duration) -> bool {
        let is_closed = self.is_closed.lock().unwrap_or_else(PoisonError::into_inner);
        let waited = self.closed.wait_timeout_while(is_closed, most.min(ASK), |is_closed| !*is_closed);
        !*waited.unwrap_or_else(PoisonError::into_inner).0
    }

    fn close(&self) {
        *self.is_closed.lock().unwrap_or_else(PoisonError::into_inner) = true;
        self.closed.notify_all();
    }
}
