//! Opening the queue, looking jobs up, and the operations of [`Queue`], most of which are in the other files.

use std::{
    collections::BTreeSet,
    num::NonZeroUsize,
    sync::{
        Arc,
        atomic::{AtomicU32, AtomicU64, Ordering},
        mpsc,
    },
    thread,
    time::Duration,
};

use jiff::Timestamp;
use tokio_postgres::{Row, types::ToSql};

use super::{
    changes::{Changes, Periodic},
    held::{Held, renew},
    jobs::{COLUMNS, job},
    listen::listen,
};
use crate::{
    queue::{
        Demand, Depth, Failure, Job, JobId, JobPage, Lease, LeaseError, Limits, NewJob, Offer, Queue, QueueError,
        StaleLease, StateName, Submitted, unique_number,
    },
    store::{Batch, Database, StoreError},
};
use ltcforge_files::digest::Digest;

/// How often old jobs are looked for.
const HOUSEKEEPING: Duration = Duration::from_secs(600);

/// How often expired leases are looked for, and jobs with few rows, at most.
const SWEEP: Duration = Duration::from_secs(1);

/// How long a worker waits after so many leases that the database refused, longer each time.
pub(super) fn back_off(refusals: u32) -> Duration {
    Duration::from_secs(1 << refusals.min(6))
}

/// A process that uses the queue.
#[derive(Debug, Clone)]
pub struct Process {
    /// Its name in the database, which no other process has.
    pub name: String,
    /// Version of its fitter. It leaves jobs of other versions alone.
    pub fitter: u32,
}

/// Jobs that any number of processes share.
#[derive(Debug)]
pub struct PostgresQueue {
    pub(super) database: Arc<Database>,
    pub(super) limits: Limits,
    pub(super) process: Process,
    pub(super) held: Arc<Held>,
    pub(super) changes: Arc<Changes>,
    pub(super) sweep: Periodic,
    housekeeping: Periodic,
    /// The name of the next lease.
    pub(super) lease_names: AtomicU64,
    /// How often in a row no lease was to be had of the database.
    pub(super) refusals: AtomicU32,
    leases_expired: AtomicU64,
    failures: AtomicU64,
    listener: Option<tokio::task::JoinHandle<()>>,
    /// The thread that renews leases ends when this is dropped; `None` if leases are renewed at once.
    renewer: Option<mpsc::Sender<()>>,
}

impl Drop for PostgresQueue {
    fn drop(&mut self) {
        self.listener.iter().for_each(tokio::task::JoinHandle::abort);
    }
}

impl PostgresQueue {
    /// The queue in `database`.
    ///
    /// # Errors
    /// When the database fails.
    pub fn open(database: Arc<Database>, limits: Limits, process: Process) -> Result<Self, StoreError> {
        let mut queue = Self::new(database, limits, process, (SWEEP, HOUSEKEEPING));
        let (ends, ended) = mpsc::channel();
        let (held, database, process) = (Arc::clone(&queue.held), Arc::clone(&queue.database), queue.process.clone());
        let renewer = thread::Builder::new().name("renew".to_owned());
        let renewer = renewer.spawn(move || held.renew_until(&ended, &database, &process, limits.lease_ttl));
        renewer.map_err(|error| StoreError::Unavailable(format!("no thread for renewing leases: {error}")))?;
        let (held, changes, database) =
            (Arc::clone(&queue.held), Arc::clone(&queue.changes), Arc::clone(&queue.database));
        let listener = queue.database.runtime().spawn(async move { listen(&database, &held, &changes).await });
        (queue.renewer, queue.listener) = (Some(ends), Some(listener));
        queue.forget_old_jobs();
        Ok(queue)
    }

    /// As [`Self::open`], for a database whose clock a test sets: periodic work is done at each call.
    #[cfg(test)]
    pub(in crate::queue) fn open_eager(database: Arc<Database>, limits: Limits) -> Self {
        let process = Process { name: "test".to_owned(), fitter: 1 };
        let queue = Self::new(database, limits, process, (Duration::ZERO, Duration::ZERO));
        queue.forget_old_jobs();
        queue
    }

    fn new(database: Arc<Database>, limits: Limits, process: Process, every: (Duration, Duration)) -> Self {
        Self {
            database,
            limits,
            process,
            held: Arc::default(),
            changes: Arc::default(),
            sweep: Periodic::new(every.0),
            housekeeping: Periodic::new(every.1),
            lease_names: AtomicU64::new(unique_number()),
            refusals: AtomicU32::new(0),
            leases_expired: AtomicU64::new(0),
            failures: AtomicU64::new(0),
            listener: None,
            renewer: None,
        }
    }

    pub(super) fn count_failures(&self, failed: u64, expired: u64) {
        self.failures.fetch_add(failed, Ordering::Relaxed);
        self.leases_expired.fetch_add(expired, Ordering::Relaxed);
    }

    /// Removes jobs that ended longer ago than the limit, and the oldest of too many, now and then. A failure is logged: callers do
    /// not depend on it.
    pub(super) fn forget_old_jobs(&self) {
        let Limits { keep_ended, most_ended, .. } = self.limits;
        if keep_ended.is_none() && most_ended.is_none() || !self.housekeeping.is_due() {
            return;
        }
        let forget = "
            WITH old AS (
                DELETE FROM ltcforge.jobs WHERE submission IN (
                    SELECT submission FROM ltcforge.jobs
                    WHERE finished_at < (SELECT ltcforge.clock()) - make_interval(secs => $1)
                        OR (finished_at, submission) <= (
                            SELECT finished_at, submission FROM ltcforge.jobs WHERE finished_at IS NOT NULL
                            ORDER BY finished_at DESC, submission DESC OFFSET $2 LIMIT 1)
                    FOR UPDATE SKIP LOCKED
                ) RETURNING submission
            ), tasks AS (
                DELETE FROM ltcforge.tasks WHERE submission IN (SELECT submission FROM old)
            )
            SELECT count(*) FROM old";
        let forgotten = self.database.run(async |client| {
            let statement = client.prepare_cached(forget).await?;
            let seconds = keep_ended.map(|keep| keep.as_secs_f64());
            let most = most_ended.and_then(|most| i64::try_from(most).ok()).unwrap_or(i64::MAX);
            Ok(client.query_one(&statement, &[&seconds, &most]).await?.get::<_, i64>(0))
        });
        match forgotten {
            Ok(0) => {}
            Ok(jobs) => tracing::info!(jobs, "jobs that ended long ago, or first of too many, were forgotten"),
            Err(error) => tracing::warn!(%error, "old jobs could not be forgotten"),
        }
    }

    /// The rows of [`COLUMNS`] that `which`, the rest of the statement, selects.
    fn rows(&self, which: &str, parameters: &[&(dyn ToSql + Sync)]) -> Result<Vec<Row>, StoreError> {
        self.database.run(async |client| {
            let statement = client.prepare_cached(&format!("{COLUMNS} {which}")).await?;
            Ok(client.query(&statement, parameters).await?)
        })
    }

    pub(super) fn job_by_id(&self, id: JobId) -> Result<Option<Job>, StoreError> {
        Ok(self.job_now(id)?.map(|(job, _)| job))
    }
}

impl Queue for PostgresQueue {
    fn submit(&self, new: NewJob, has_table: &dyn Fn(Digest) -> bool) -> Result<Submitted, QueueError> {
        self.submit_job(&new, has_table)
    }

    fn adopt(&self, done: Job) -> Result<Job, StoreError> {
        self.adopt_job(&done)
    }

    fn cancel(&self, id: JobId, by: Option<&str>) -> Result<Option<Job>, StoreError> {
        self.cancel_job(id, by)
    }

    fn lease(&self, demand: Demand, most: NonZeroUsize) -> Offer {
        let Some(seen) = self.changes.generation() else { return Offer::Closed };
        match self.lease_tasks(demand, most) {
            Ok(tasks) => {
                self.refusals.store(0, Ordering::Relaxed);
                if tasks.is_empty() { Offer::Nothing { seen } } else { Offer::Tasks(tasks) }
            }
            Err(error) => {
                let before = self.refusals.fetch_add(1, Ordering::Relaxed);
                // A database that does not answer was waited for, and is told once; one that refuses needs somebody.
                if error.is_passing() && before > 0 {
                    tracing::debug!(%error, "no task could be leased");
                } else {
                    tracing::warn!(%error, "no task could be leased");
                }
                if !error.is_passing() {
                    self.changes.pause(back_off(before));
                }
                Offer::Nothing { seen }
            }
        }
    }

    fn progress(&self, lease: &Lease, entries_done: u64) -> Result<(), StaleLease> {
        if self.renewer.is_some() {
            return self.held.report(lease, entries_done);
        }
        let renewed = renew(&self.database, &self.process, &[(*lease, entries_done)], self.limits.lease_ttl);
        if renewed.is_ok_and(|renewed| renewed == [*lease]) { Ok(()) } else { Err(StaleLease) }
    }

    fn complete(&self, done: &[(Lease, &[u8])]) -> Result<Vec<Result<(), StaleLease>>, StoreError> {
        self.store_results(done)
    }

    fn results(&self, lease: &Lease, take: &mut dyn FnMut(&[u8])) -> Result<bool, LeaseError> {
        self.read_results(lease, take)
    }

    fn finish(&self, lease: &Lease, table: Digest, with: Batch) -> Result<(), LeaseError> {
        self.finish_job(lease, table, &with)
    }

    fn give_back(&self, lease: &Lease) -> Result<(), StaleLease> {
        or_stale(self.put_back(lease, None, &[]))
    }

    fn fail(&self, lease: &Lease, error: &str) -> Result<(), StaleLease> {
        or_stale(self.put_back(lease, Some(error), &[]))
    }

    fn abort(&self, lease: &Lease, error: Failure) -> Result<(), StaleLease> {
        or_stale(self.abort_job(lease, &error))
    }

    fn job(&self, id: JobId) -> Result<Option<Job>, StoreError> {
        self.job_by_id(id)
    }

    /// With the database's time, which is the same for all processes.
    fn job_now(&self, id: JobId) -> Result<Option<(Job, Timestamp)>, StoreError> {
        let rows = self.rows("WHERE id = $1", &[&id.as_bytes().as_slice()])?;
        rows.first().map(|row| Ok((job(row)?, row.get("now")))).transpose()
    }

    fn list(&self, wanted: Option<StateName>, before: Option<u64>, limit: usize) -> Result<JobPage, StoreError> {
        let before = before.map_or(i64::MAX, |before| i64::try_from(before).unwrap_or(i64::MAX));
        let most = i64::try_from(limit.saturating_add(1)).unwrap_or(i64::MAX);
        let rows = match wanted {
            None => self.rows("WHERE submission < $1 ORDER BY submission DESC LIMIT $2", &[&before, &most]),
            Some(state) => self.rows(
                "WHERE state = $3 AND submission < $1 ORDER BY submission DESC LIMIT $2",
                &[&before, &most, &state.text()],
            ),
        }?;
        let page = &rows[..limit.min(rows.len())];
        let next = page.last().filter(|_| limit < rows.len());
        let next = next.map(|row| row.get::<_, i64>("submission").cast_unsigned());
        Ok((page.iter().map(job).collect::<Result<_, _>>()?, next))
    }

    fn counts(&self) -> Result<Vec<(StateName, u64)>, StoreError> {
        let rows = self.database.run(async |client| {
            let count = "SELECT state, count(*) FROM ltcforge.jobs GROUP BY state";
            Ok(client.query(&client.prepare_cached(count).await?, &[]).await?)
        })?;
        let count = |state: StateName| {
            let row = rows.iter().find(|row| row.get::<_, &str>(0) == state.text());
            (state, row.map_or(0, |row| row.get::<_, i64>(1).cast_unsigned()))
        };
        Ok(StateName::ALL.map(count).to_vec())
    }

    fn depth(&self) -> Result<Depth, StoreError> {
        // Shards that were never leased are in `blocks`. A lease that has expired is another's to take.
        let count = "
            SELECT (SELECT coalesce(sum(past - next), 0) FROM ltcforge.blocks JOIN ltcforge.serving USING (submission))::bigint,
                count(*) FILTER (WHERE t.state = 'waiting' OR t.lease_until <= (SELECT ltcforge.clock())),
                count(*) FILTER (WHERE t.lease_until > (SELECT ltcforge.clock()))
            FROM ltcforge.tasks AS t JOIN ltcforge.serving USING (submission)
            WHERE t.state <> 'finished' AND NOT t.is_assembly";
        let row = self
            .database
            .run(async |client| Ok(client.query_one(&client.prepare_cached(count).await?, &[]).await?))?;
        let [never, waiting, leased] = [0, 1, 2].map(|column| row.get::<_, i64>(column).cast_unsigned());
        Ok(Depth { waiting: never + waiting, leased })
    }

    fn first_unfinished(&self) -> Result<Option<Job>, StoreError> {
        let rows = self.rows("WHERE state IN ('queued', 'running') ORDER BY submission LIMIT 1", &[])?;
        rows.first().map(job).transpose()
    }

    fn failures(&self) -> (u64, u64) {
        (self.leases_expired.load(Ordering::Relaxed), self.failures.load(Ordering::Relaxed))
    }

    fn wait(&self, seen: u64) {
        self.changes.wait(seen);
    }

    fn pause(&self, time: Duration) {
        self.changes.pause(time);
    }

    fn close(&self) {
        self.changes.close();
    }

    /// The database's time; this machine's if the database does not answer.
    fn now(&self) -> Timestamp {
        let now = self.database.run(async |client| Ok(client.query_one("SELECT ltcforge.clock()", &[]).await?.get(0)));
        now.unwrap_or_else(|_| Timestamp::now())
    }

    fn is_local(&self) -> bool {
        false
    }

    fn fault(&self) -> Option<String> {
        self.database.fault()
    }

    fn take_changed(&self) -> BTreeSet<JobId> {
        self.changes.take_jobs()
    }
}

/// An error of the database is logged and counts as a stale lease: the lease expires.
fn or_stale(done: Result<(), LeaseError>) -> Result<(), StaleLease> {
    done.map_err(|error| {
        if let LeaseError::Store(error) = error {
            tracing::warn!(%error, "a task could not be put back; its lease will expire");
        }
        StaleLease
    })
}
