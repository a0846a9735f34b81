//! Tasks that are put back, and jobs that fail.

use super::{PostgresQueue, jobs};
use crate::{
    queue::{Failure, FailureKind, JobId, JobState, Lease, LeaseError, MOST_DEATHS, StaleLease},
    store::StoreError,
};

/// `$4` is the error, or NULL if there was none.
const PUT_BACK: &str = "
    UPDATE ltcforge.tasks SET state = 'waiting', lease_until = NULL, worker = NULL, entries_reported = 0,
        failures = failures + CASE WHEN $4::text IS NULL THEN 0 ELSE 1 END, last_error = coalesce($4, last_error)
    WHERE submission = $1 AND task = $2 AND worker = $3 AND lease_until > (SELECT ltcforge.clock())
    RETURNING is_assembly, failures";

/// `$2` are the shards whose results are lost.
const LOSE: &str = "
    WITH lost AS (
        UPDATE ltcforge.tasks SET state = 'waiting', failures = 0, result = NULL
        WHERE submission = $1 AND task = ANY ($2) AND state = 'finished' RETURNING entries
    )
    INSERT INTO ltcforge.finished_entries AS f (submission, slot, entries)
    SELECT $1, 0, -sum(entries) FROM lost HAVING count(*) > 0
    ON CONFLICT (submission, slot) DO UPDATE SET entries = f.entries + excluded.entries";

const TAKE_BACK: &str = "
    UPDATE ltcforge.tasks AS t SET state = 'waiting', deaths = t.deaths + 1,
        lease_until = NULL, worker = NULL, entries_reported = 0
    FROM (
        SELECT submission, task FROM ltcforge.tasks
        WHERE state = 'leased' AND lease_until <= (SELECT ltcforge.clock())
        LIMIT 1000 FOR UPDATE SKIP LOCKED
    ) AS e
    WHERE t.submission = e.submission AND t.task = e.task
    RETURNING t.submission, t.task, t.is_assembly, t.deaths";

/// The failure of a job whose task has failed, or lost its worker, too often.
fn too_often(task: i32, is_assembly: bool, detail: &str) -> Failure {
    let name = if is_assembly { "the assembly".to_owned() } else { format!("shard {task}") };
    Failure { kind: FailureKind::Attempts, detail: format!("{name} {detail}") }
}

impl PostgresQueue {
    /// Puts a leased task back. With an `error` the task has failed, and its job fails if that was too often. The
    /// shards `lost`, whose results are lost or damaged, are queued again.
    pub(super) fn put_back(&self, lease: &Lease, error: Option<&str>, lost: &[i32]) -> Result<(), LeaseError> {
        let (submission, task, name) = self.process.fence(lease);
        // PostgreSQL's texts have no NUL.
        let error = error.map(|error| error.replace('\0', "\u{fffd}"));
        let put_back = self.database.run(async |client| {
            let transaction = client.transaction().await?;
            let Some(job) = jobs::lock_open(&transaction, submission).await? else { return Ok(None) };
            let row = transaction.query_opt(PUT_BACK, &[&submission, &task, &name, &error]).await?;
            let Some(row) = row else { return Ok(None) };
            transaction.execute(LOSE, &[&submission, &lost]).await?;
            let times = row.get::<_, i32>("failures").cast_unsigned();
            let failure = error.as_ref().filter(|_| self.limits.max_attempts.get() <= times).map(|error| {
                let detail = format!("failed {times} times; the last error: {error}");
                too_often(task, row.get("is_assembly"), &detail)
            });
            match &failure {
                Some(error) => {
                    let failed = JobState::Failed { error: error.clone() };
                    jobs::end(&transaction, submission, job, &failed).await?;
                }
                None => jobs::notify(&transaction, "work").await?,
            }
            transaction.commit().await?;
            Ok(Some(failure.map(|failure| (job, failure))))
        });
        self.held.remove(lease);
        let failed = put_back?.ok_or(StaleLease)?;
        if let Some(error) = error {
            tracing::warn!(submission, task, error, "a task failed");
            self.count_failures(1, 0);
        }
        match failed {
            Some((job, failure)) => self.note_failed(submission, job, &failure),
            None => self.changes.note(None),
        }
        Ok(())
    }

    /// Fails an unfinished job, if `lease` is current or there is none.
    fn fail_job(&self, submission: i64, lease: Option<&Lease>, error: &Failure) -> Result<bool, StoreError> {
        let failed = self.database.run(async |client| {
            let transaction = client.transaction().await?;
            let Some(job) = jobs::lock_open(&transaction, submission).await? else { return Ok(None) };
            if let Some(lease) = lease
                && self.process.is_of_assembly(&transaction, lease).await?.is_none()
            {
                return Ok(None);
            }
            jobs::end(&transaction, submission, job, &JobState::Failed { error: error.clone() }).await?;
            transaction.commit().await?;
            Ok(Some(job))
        })?;
        if let Some(job) = failed {
            self.note_failed(submission, job, error);
        }
        Ok(failed.is_some())
    }

    fn note_failed(&self, submission: i64, job: JobId, failure: &Failure) {
        tracing::error!(%job, ?failure, "the job failed");
        self.held.remove_all(submission.cast_unsigned());
        self.changes.note(Some(job));
    }

    /// Takes back the leases that have expired, and fails the jobs whose task has lost too many workers.
    pub(super) fn take_back_expired(&self) -> Result<(), StoreError> {
        let rows = self
            .database
            .run(async |client| Ok(client.query(&client.prepare_cached(TAKE_BACK).await?, &[]).await?))?;
        if rows.is_empty() {
            return Ok(());
        }
        self.count_failures(rows.len() as u64, rows.len() as u64);
        self.changes.note(None);
        for row in &rows {
            let (submission, task, deaths): (i64, i32, i32) = (row.get(0), row.get(1), row.get(3));
            tracing::warn!(submission, task, deaths, "a lease expired");
            if MOST_DEATHS <= deaths.cast_unsigned() {
                let detail = format!("was leased {deaths} times by workers that stopped reporting");
                self.fail_job(submission, None, &too_often(task, row.get(2), &detail))?;
            }
        }
        Ok(())
    }

    /// Fails the whole job of a lease.
    pub(super) fn abort_job(&self, lease: &Lease, failure: &Failure) -> Result<(), LeaseError> {
        let failed = self.fail_job(lease.submission.cast_signed(), Some(lease), failure);
        self.held.remove(lease);
        if failed? { Ok(()) } else { Err(StaleLease.into()) }
    }
}
