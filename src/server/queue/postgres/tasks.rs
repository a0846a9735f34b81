//! Leases tasks, and sets tasks back to waiting.

use std::{num::NonZeroUsize, sync::atomic::Ordering};

use deadpool_postgres::GenericClient;

use super::{PostgresQueue, jobs};
use crate::{
    queue::{
        Failure, JobState, Lease, LeaseError, LeasedTask, MOST_FAILURES, MOST_LEASES, StaleLease, TaskKind,
        failed_often, leased_often,
    },
    store::StoreError,
};

/// Leases tasks. `$1` the fitter, `$2` maximum number of tasks, `$3` seconds. Lease numbers are random, so that after a
/// database is restored, an old lease does not match a new lease.
const LEASE: &str = "
    WITH first AS MATERIALIZED (
        SELECT submission, task FROM ltcforge.tasks WHERE state = 'waiting' AND fitter = $1
        ORDER BY tag, submission, task LIMIT $2 FOR UPDATE SKIP LOCKED
    )
    UPDATE ltcforge.tasks AS t SET state = 'leased', lease = (random() * 9e15)::bigint, leases = t.leases + 1,
        lease_until = ltcforge.clock() + make_interval(secs => $3), entries_reported = 0
    FROM first AS f JOIN ltcforge.jobs AS j ON j.submission = f.submission
    WHERE t.submission = f.submission AND t.task = f.task
    RETURNING t.submission, t.task, t.lease, t.is_assembly, t.tag, j.id, j.recipe, j.recipe_digest, j.state";

const RUNNING: &str = "
    UPDATE ltcforge.jobs SET state = 'running', started_at = ltcforge.clock()
    WHERE submission = ANY ($1) AND state = 'queued'";

const RENEW: &str = "
    UPDATE ltcforge.tasks AS t SET lease_until = ltcforge.clock() + make_interval(secs => $5), entries_reported = g.entries
    FROM unnest($1::bigint[], $2::integer[], $3::bigint[], $4::bigint[]) WITH ORDINALITY
        AS g (submission, task, lease, entries, n)
    WHERE t.submission = g.submission AND t.task = g.task AND t.lease = g.lease AND t.state = 'leased'
    RETURNING g.n - 1";

const EXPIRE: &str = "
    WITH expired AS MATERIALIZED (
        SELECT submission, task FROM ltcforge.tasks WHERE state = 'leased' AND lease_until <= ltcforge.clock()
        LIMIT 1000 FOR UPDATE SKIP LOCKED
    )
    UPDATE ltcforge.tasks AS t SET state = 'waiting', lease_until = NULL, entries_reported = 0
    FROM expired AS e WHERE t.submission = e.submission AND t.task = e.task
    RETURNING t.submission, t.task, t.is_assembly, t.leases";

/// Selects jobs with a blocked assembly. The worker of the last shard may have ended before it unblocked the assembly.
const BLOCKED: &str = "SELECT submission FROM ltcforge.tasks WHERE state = 'blocked'";

/// Sets a leased task back to waiting. `$4` is true if the worker reports a failure.
const PUT_BACK: &str = "
    UPDATE ltcforge.tasks SET state = 'waiting', lease_until = NULL, entries_reported = 0,
        leases = leases - CASE WHEN $4 THEN 0 ELSE 1 END, failures = failures + CASE WHEN $4 THEN 1 ELSE 0 END
    WHERE submission = $1 AND task = $2 AND lease = $3 AND state = 'leased' RETURNING is_assembly, leases, failures";

const CURRENT: &str = "
    SELECT is_assembly FROM ltcforge.tasks WHERE submission = $1 AND task = $2 AND lease = $3 AND state = 'leased'";

fn kind(task: i32, is_assembly: bool) -> TaskKind {
    if is_assembly { TaskKind::Assemble } else { TaskKind::Shard(task.cast_unsigned()) }
}

impl PostgresQueue {
    pub(super) fn lease_waiting(&self, most: NonZeroUsize) -> Result<Vec<LeasedTask>, StoreError> {
        let most = i64::try_from(most.get()).unwrap_or(i64::MAX);
        let seconds = self.limits.lease_ttl.as_secs_f64();
        let mut rows = self.database.run(async |client| {
            let rows = client.query(&client.prepare_cached(LEASE).await?, &[&self.fitter, &most, &seconds]).await?;
            let first = rows.iter().filter(|row| row.get::<_, &str>(8) == "queued");
            let first: Vec<i64> = first.map(|row| row.get(0)).collect();
            if !first.is_empty() {
                client.execute(&client.prepare_cached(RUNNING).await?, &[&first]).await?;
            }
            Ok(rows)
        })?;
        rows.sort_by_key(|row| (row.get::<_, i64>(4), row.get::<_, i64>(0), row.get::<_, i32>(1)));
        let leased = rows.iter().map(|row| {
            let (submission, task, number): (i64, i32, i64) = (row.get(0), row.get(1), row.get(2));
            Ok(LeasedTask {
                lease: Lease {
                    submission: submission.cast_unsigned(),
                    task: task.cast_unsigned(),
                    number: number.cast_unsigned(),
                },
                kind: kind(task, row.get(3)),
                job: jobs::id(row.get(5))?,
                recipe: row.get(6),
                recipe_digest: jobs::digest(row.get(7))?,
            })
        });
        leased.collect()
    }

    pub(super) fn renew_leases(&self, leases: &[(Lease, u64)]) -> Result<Vec<Result<(), StaleLease>>, StoreError> {
        let mut answers = vec![Err(StaleLease); leases.len()];
        if leases.is_empty() {
            return Ok(answers);
        }
        let (submissions, tasks, numbers): (Vec<_>, Vec<_>, Vec<_>) =
            leases.iter().map(|(lease, _)| Self::fence(lease)).collect();
        let entries: Vec<_> = leases.iter().map(|(_, entries)| entries.cast_signed()).collect();
        let seconds = self.limits.lease_ttl.as_secs_f64();
        let renewed = self.database.run(async |client| {
            let statement = client.prepare_cached(RENEW).await?;
            Ok(client.query(&statement, &[&submissions, &tasks, &numbers, &entries, &seconds]).await?)
        })?;
        for row in &renewed {
            answers[row.get::<_, i64>(0) as usize] = Ok(());
        }
        Ok(answers)
    }

    /// Sets tasks back to waiting if their lease has expired, for all processes. Fails jobs whose task was leased too
    /// often.
    pub(super) fn put_back_expired(&self) -> Result<(), StoreError> {
        let expired = self.database.run(async |client| {
            let blocked = client.query(&client.prepare_cached(BLOCKED).await?, &[]).await?;
            let blocked: Vec<i64> = blocked.iter().map(|row| row.get(0)).collect();
            if !blocked.is_empty() {
                Self::unblock(&*client, &blocked).await?;
            }
            Ok(client.query(&client.prepare_cached(EXPIRE).await?, &[]).await?)
        })?;
        self.expired.fetch_add(expired.len() as u64, Ordering::Relaxed);
        for row in &expired {
            let (submission, task, leases): (i64, i32, i32) = (row.get(0), row.get(1), row.get(3));
            tracing::warn!(submission, task, leases, "a lease expired");
            if leases.cast_unsigned() >= MOST_LEASES {
                self.fail(submission, None, &leased_often(kind(task, row.get(2)), leases.cast_unsigned()))?;
            }
        }
        Ok(())
    }

    /// Sets a leased task back to waiting, with the error that its worker reports. After too many leases or failures,
    /// the job fails.
    pub(super) fn put_back(&self, lease: &Lease, error: Option<&str>) -> Result<(), LeaseError> {
        let (submission, task, number) = Self::fence(lease);
        let is_failure = error.is_some();
        let is_put_back = self.database.run(async |client| {
            let transaction = client.transaction().await?;
            if jobs::lock_open(&transaction, submission).await?.is_none() {
                return Ok(false);
            }
            let statement = transaction.prepare_cached(PUT_BACK).await?;
            let row = transaction.query_opt(&statement, &[&submission, &task, &number, &is_failure]).await?;
            let Some(row) = row else { return Ok(false) };
            let [leases, failures] = [1, 2].map(|column| row.get::<_, i32>(column).cast_unsigned());
            let kind = kind(task, row.get(0));
            let failure = match error {
                Some(error) if failures >= MOST_FAILURES => Some(failed_often(kind, failures, error)),
                Some(_) if leases >= MOST_LEASES => Some(leased_often(kind, leases)),
                _ => None,
            };
            if let Some(error) = failure {
                tracing::error!(submission, ?error, "the job failed");
                jobs::end(&transaction, submission, &JobState::Failed { error }, None).await?;
            }
            transaction.commit().await?;
            Ok(true)
        })?;
        if is_put_back { Ok(()) } else { Err(StaleLease.into()) }
    }

    /// Whether a lease is for the assembly. `None` if the lease is not current.
    pub(super) async fn current(
        client: &impl GenericClient,
        lease: &Lease,
    ) -> Result<Option<bool>, tokio_postgres::Error> {
        let (submission, task, number) = Self::fence(lease);
        let current = client.prepare_cached(CURRENT).await?;
        Ok(client.query_opt(&current, &[&submission, &task, &number]).await?.map(|row| row.get(0)))
    }

    /// Fails the job of a lease, if the lease is current.
    pub(super) fn abort(&self, lease: &Lease, failure: &Failure) -> Result<(), LeaseError> {
        let (submission, ..) = Self::fence(lease);
        if self.fail(submission, Some(lease), failure)? { Ok(()) } else { Err(StaleLease.into()) }
    }

    /// Fails an unfinished job, unless `lease` is given and is not current. Returns whether the job failed.
    fn fail(&self, submission: i64, lease: Option<&Lease>, failure: &Failure) -> Result<bool, StoreError> {
        let is_failed = self.database.run(async |client| {
            let transaction = client.transaction().await?;
            if jobs::lock_open(&transaction, submission).await?.is_none() {
                return Ok(false);
            }
            if let Some(lease) = lease
                && Self::current(&transaction, lease).await?.is_none()
            {
                return Ok(false);
            }
            jobs::end(&transaction, submission, &JobState::Failed { error: failure.clone() }, None).await?;
            transaction.commit().await?;
            Ok(true)
        })?;
        if is_failed {
            tracing::error!(submission, ?failure, "the job failed");
        }
        Ok(is_failed)
    }
}
