//! Tasks and jobs that fail, and how jobs end.

use deadpool_postgres::{GenericClient, Transaction};

use super::{
    fence::{IS_CURRENT, fence},
    shared::Shared,
};
use crate::{
    queue::{Failure, FailureKind, JobId, Lease, LeaseError, MOST_DEATHS, StaleLease},
    store::StoreError,
};

/// The highest attempt number among the tasks of the job in `ltcforge.jobs`, as an expression.
pub(super) const ATTEMPTS: &str = "greatest(CASE WHEN started_at IS NULL THEN 0 ELSE 1 END, (
    SELECT max(t.attempt) FROM ltcforge.tasks AS t WHERE t.submission = jobs.submission AND t.attempt > 1))";

/// Locks an unfinished job; returns its id.
pub(super) async fn lock_open_job(
    client: &impl GenericClient,
    submission: i64,
) -> Result<Option<JobId>, tokio_postgres::Error> {
    let lock = "SELECT id FROM ltcforge.jobs WHERE submission = $1 AND state IN ('queued', 'running') FOR UPDATE";
    let row = client.query_opt(lock, &[&submission]).await?;
    Ok(row.and_then(|row| JobId::from_slice(row.get(0))))
}

/// Removes the tasks of a job that has ended; its finished shards stay if they are to be kept.
pub(super) async fn remove_tasks(
    client: &impl GenericClient,
    submission: i64,
    keep_finished: bool,
) -> Result<(), tokio_postgres::Error> {
    let tasks = "DELETE FROM ltcforge.tasks WHERE submission = $1 AND NOT ($2 AND state = 'finished')";
    // First the blocks, which waits for transactions that are leasing from them: no task comes after that.
    client.execute("DELETE FROM ltcforge.blocks WHERE submission = $1", &[&submission]).await?;
    client.execute(tasks, &[&submission, &keep_finished]).await?;
    client.execute("DELETE FROM ltcforge.serving WHERE submission = $1", &[&submission]).await?;
    client.execute("DELETE FROM ltcforge.finished_entries WHERE submission = $1", &[&submission]).await?;
    Ok(())
}

/// Tells all processes that a job has ended, when the transaction is committed.
pub(super) async fn notify_end(
    client: &impl GenericClient,
    submission: i64,
    job: &JobId,
) -> Result<(), tokio_postgres::Error> {
    let message = format!("end {job} {submission}");
    client.execute("SELECT pg_notify('ltcforge', $1)", &[&message]).await?;
    Ok(())
}

async fn fail_locked_job(
    transaction: &Transaction<'_>,
    submission: i64,
    job: &JobId,
    failure: &str,
) -> Result<(), tokio_postgres::Error> {
    let fail = format!(
        "UPDATE ltcforge.jobs SET state = 'failed', failure = $2, finished_at = (SELECT ltcforge.clock()),
            attempts = {ATTEMPTS}, entries_done = (
                SELECT coalesce(sum(entries), 0) FROM ltcforge.finished_entries AS f WHERE f.submission = jobs.submission)
        WHERE submission = $1"
    );
    transaction.execute(&fail, &[&submission, &failure]).await?;
    remove_tasks(transaction, submission, true).await?;
    notify_end(transaction, submission, job).await
}

/// Fails a job, if it is unfinished and `lease`, if there is one, is current.
fn fail_job(shared: &Shared, submission: i64, lease: Option<&Lease>, failure: &Failure) -> Result<bool, StoreError> {
    let text = serde_json::to_string(failure).map_err(|error| StoreError::Database(error.to_string()))?;
    let failed = shared.database.run(async |client| {
        let transaction = client.transaction().await?;
        let Some(job) = lock_open_job(&transaction, submission).await? else { return Ok(None) };
        if let Some(lease) = lease {
            let (submission, task, attempt) = fence(lease);
            if transaction.query_opt(IS_CURRENT, &[&submission, &task, &attempt]).await?.is_none() {
                return Ok(None);
            }
        }
        fail_locked_job(&transaction, submission, &job, &text).await?;
        transaction.commit().await?;
        Ok(Some(job))
    })?;
    let Some(job) = failed else { return Ok(false) };
    tracing::error!(%job, ?failure, "the job failed");
    shared.held.lose(submission.cast_unsigned());
    shared.note_change(Some(job));
    Ok(true)
}

/// A task that has failed, or whose lease has expired, once more.
struct FailedTask {
    submission: i64,
    task: i32,
    is_assembly: bool,
    /// How often by now.
    times: i32,
    /// The error; `None` if the lease has expired.
    error: Option<String>,
}

impl FailedTask {
    fn of(row: &tokio_postgres::Row, error: Option<&str>) -> Self {
        let error = error.map(str::to_owned);
        Self { submission: row.get(0), task: row.get(1), is_assembly: row.get(2), times: row.get(3), error }
    }

    /// Fails the job if this was once too often.
    fn conclude(&self, shared: &Shared) -> Result<(), StoreError> {
        let Self { submission, task, times, error, .. } = self;
        tracing::warn!(submission, task, times, error, "a task failed, or its lease expired");
        let most = if error.is_some() { shared.limits.max_attempts.get() } else { MOST_DEATHS };
        if i64::from(*times) < i64::from(most) {
            return Ok(());
        }
        let name = if self.is_assembly { "the assembly".to_owned() } else { format!("shard {task}") };
        let detail = match error {
            Some(error) => format!("{name} failed {times} times; the last error: {error}"),
            None => format!("{name} was leased {times} times by workers that did not report any more"),
        };
        fail_job(shared, *submission, None, &Failure { kind: FailureKind::Attempts, detail }).map(drop)
    }
}

/// Takes back the leases that have expired, and fails jobs for which that is one failure too many.
pub(super) fn take_back_expired(shared: &Shared) -> Result<(), StoreError> {
    let rows = shared.database.run(async |client| {
        let take_back = "
            UPDATE ltcforge.tasks AS t SET state = 'waiting', deaths = t.deaths + 1,
                lease_until = NULL, worker = NULL, entries_reported = 0
            FROM (
                SELECT submission, task FROM ltcforge.tasks
                WHERE state = 'leased' AND lease_until <= (SELECT ltcforge.clock())
                LIMIT 1000 FOR UPDATE SKIP LOCKED
            ) AS e
            WHERE t.submission = e.submission AND t.task = e.task
            RETURNING t.submission, t.task, t.is_assembly, t.deaths";
        client.query(&client.prepare_cached(take_back).await?, &[]).await
    })?;
    if rows.is_empty() {
        return Ok(());
    }
    shared.count_failures(rows.len() as u64, rows.len() as u64);
    shared.note_change(None);
    rows.iter().try_for_each(|row| FailedTask::of(row, None).conclude(shared))
}

/// Counts a failure of a leased task.
pub(super) fn fail_task(shared: &Shared, lease: &Lease, error: &str) -> Result<(), StaleLease> {
    let (submission, task, attempt) = fence(lease);
    // PostgreSQL's texts have no NUL.
    let error = error.replace('\0', "\u{fffd}");
    let failed = shared.database.run(async |client| {
        let fail = "
            WITH failed AS (
                UPDATE ltcforge.tasks SET state = 'waiting', failures = failures + 1, last_error = $4,
                    lease_until = NULL, worker = NULL, entries_reported = 0
                WHERE submission = $1 AND task = $2 AND attempt = $3
                    AND lease_until > (SELECT ltcforge.clock())
                RETURNING submission, task, is_assembly, failures
            )
            SELECT submission, task, is_assembly, failures, pg_notify('ltcforge', 'work')::text FROM failed";
        client.query_opt(&client.prepare_cached(fail).await?, &[&submission, &task, &attempt, &error]).await
    });
    shared.held.remove(lease);
    let row = match failed {
        Ok(row) => row.ok_or(StaleLease)?,
        Err(error) => {
            tracing::warn!(%error, "the failure of a task could not be recorded; its lease will expire");
            return Err(StaleLease);
        }
    };
    shared.count_failures(1, 0);
    shared.note_change(None);
    let concluded = FailedTask::of(&row, Some(&error)).conclude(shared);
    // The task has failed too often then, and does so again with its next lease.
    concluded.inspect_err(|error| tracing::warn!(%error, "the failure of a job could not be recorded")).ok();
    Ok(())
}

/// Fails the whole job of a lease.
pub(super) fn abort(shared: &Shared, lease: &Lease, failure: &Failure) -> Result<(), StaleLease> {
    let failed = fail_job(shared, lease.submission.cast_signed(), Some(lease), failure);
    shared.held.remove(lease);
    match failed {
        Ok(true) => Ok(()),
        Ok(false) => Err(StaleLease),
        Err(error) => {
            tracing::warn!(%error, "the failure of a job could not be recorded; its lease will expire");
            Err(StaleLease)
        }
    }
}

/// Queues shards again whose results are lost; the assembly that found it out counts as failed.
pub(super) fn lose_results(shared: &Shared, lease: &Lease, lost: &[i32]) -> Result<(), LeaseError> {
    let (submission, task, attempt) = fence(lease);
    let error = format!("the results of shards {lost:?} are lost or damaged");
    let row = shared.database.run(async |client| {
        let transaction = client.transaction().await?;
        if lock_open_job(&transaction, submission).await?.is_none() {
            return Ok(None);
        }
        let fail = "
            UPDATE ltcforge.tasks SET state = 'waiting', failures = failures + 1, last_error = $4, lease_until = NULL, worker = NULL
            WHERE submission = $1 AND task = $2 AND attempt = $3
                AND lease_until > (SELECT ltcforge.clock())
            RETURNING submission, task, is_assembly, failures";
        let Some(row) = transaction.query_opt(fail, &[&submission, &task, &attempt, &error]).await? else { return Ok(None) };
        let again = "
            WITH again AS (
                UPDATE ltcforge.tasks SET state = 'waiting', failures = 0, result = NULL
                WHERE submission = $1 AND task = ANY ($2) RETURNING entries
            )
            INSERT INTO ltcforge.finished_entries AS f (submission, slot, entries)
            SELECT $1, 0, -sum(entries) FROM again HAVING count(*) > 0
            ON CONFLICT (submission, slot) DO UPDATE SET entries = f.entries + excluded.entries";
        transaction.execute(again, &[&submission, &lost]).await?;
        transaction.execute("SELECT pg_notify('ltcforge', 'work')", &[]).await?;
        transaction.commit().await?;
        Ok(Some(row))
    })?;
    shared.held.remove(lease);
    let row = row.ok_or(StaleLease)?;
    shared.count_failures(1, 0);
    shared.note_change(None);
    Ok(FailedTask::of(&row, Some(&error)).conclude(shared)?)
}
