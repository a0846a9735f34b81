//! Leasing tasks.

use std::num::NonZeroUsize;

use super::{failing, shared::Shared};
use crate::{
    files::digest::Digest,
    server::{
        queue::{Demand, JobId, Lease, LeasedTask, Offer, TaskKind},
        store::StoreError,
    },
};

/// Tasks leased in one statement, at most.
const AT_ONCE: usize = 256;

/// `$1` the fitter, `$2` tasks at most, `$3` seconds, `$4` the worker, `$5` whether only jobs that nobody works for count.
///
/// Each job offers its first waiting tasks; the assembly only when no shard waits or is leased. A place in the queue is the number of the job's leased tasks if it gets the
/// task; the lowest places are taken. Tasks that another transaction is leasing now are passed over.
pub(super) const LEASE: &str = "
    WITH load AS MATERIALIZED (
        SELECT submission, count(*) AS leased FROM ltcforge.tasks WHERE state = 'leased' GROUP BY submission
    ), open AS MATERIALIZED (
        SELECT j.submission, coalesce(l.leased, 0) AS leased, s.last_served, w.waiting
        FROM ltcforge.jobs AS j
        JOIN ltcforge.serving AS s ON s.submission = j.submission
        LEFT JOIN load AS l ON l.submission = j.submission
        CROSS JOIN LATERAL (
            SELECT CASE WHEN count(*) = 0 THEN 0 ELSE greatest(count(*) FILTER (WHERE NOT f.is_assembly), 1) END AS waiting
            FROM (
                SELECT t.is_assembly FROM ltcforge.tasks AS t WHERE t.submission = j.submission AND t.state = 'waiting'
                    AND (NOT t.is_assembly OR l.leased IS NULL) ORDER BY t.is_assembly, t.task LIMIT $2
            ) AS f
        ) AS w
        WHERE j.state IN ('queued', 'running') AND j.fitter = $1 AND w.waiting > 0 AND (NOT $5 OR l.leased IS NULL)
    ), shares AS (
        SELECT submission, count(*) AS share FROM (
            SELECT submission FROM open CROSS JOIN LATERAL generate_series(1, waiting) AS n
            ORDER BY leased + n, n > 1, last_served, submission LIMIT $2
        ) AS places GROUP BY submission
    ), picked AS MATERIALIZED (
        SELECT t.place FROM shares CROSS JOIN LATERAL (
            SELECT t.ctid AS place FROM ltcforge.tasks AS t
            WHERE t.submission = shares.submission AND t.state = 'waiting' AND (
                NOT t.is_assembly OR NOT EXISTS (
                    SELECT FROM ltcforge.tasks AS u
                    WHERE u.submission = t.submission AND u.state = 'waiting' AND NOT u.is_assembly
                ) AND NOT EXISTS (
                    SELECT FROM ltcforge.tasks AS u WHERE u.submission = t.submission AND u.state = 'leased'
                )
            )
            ORDER BY t.is_assembly, t.task LIMIT shares.share FOR UPDATE OF t SKIP LOCKED
        ) AS t
    ), leased AS (
        UPDATE ltcforge.tasks AS t
        SET state = 'leased', attempt = t.attempt + 1, worker = $4, entries_reported = 0,
            lease_until = (SELECT ltcforge.clock()) + make_interval(secs => $3)
        WHERE t.ctid = ANY (ARRAY (SELECT place FROM picked))
        RETURNING t.submission, t.task, t.attempt, t.is_assembly
    ), served AS (
        UPDATE ltcforge.serving SET last_served = nextval('ltcforge.servings') WHERE submission IN (
            SELECT submission FROM ltcforge.serving WHERE submission IN (SELECT submission FROM leased)
            FOR UPDATE SKIP LOCKED
        )
    )
    SELECT l.submission, l.task, l.attempt, l.is_assembly, j.id, j.recipe, j.recipe_digest, j.state, j.entries_total
    FROM leased AS l JOIN ltcforge.jobs AS j ON j.submission = l.submission
    ORDER BY l.submission, l.task";

const START: &str = "
    UPDATE ltcforge.jobs SET state = 'running', started_at = (SELECT ltcforge.clock())
    WHERE submission = ANY ($1) AND state = 'queued'";

impl Shared {
    pub(super) fn lease(&self, worker: u32, demand: Demand, most: NonZeroUsize) -> Offer {
        let Some(seen) = self.generation() else { return Offer::Closed };
        match self.lease_tasks(worker, demand, most.get().min(AT_ONCE)) {
            Ok(tasks) if tasks.is_empty() => Offer::Nothing { seen },
            Ok(tasks) => Offer::Tasks(tasks),
            Err(error) => {
                tracing::warn!(%error, "no task could be leased");
                Offer::Nothing { seen }
            }
        }
    }

    fn lease_tasks(&self, worker: u32, demand: Demand, most: usize) -> Result<Vec<LeasedTask>, StoreError> {
        if self.sweep_is_due() {
            failing::take_back_expired(self)?;
        }
        let fitter = self.process.fitter.cast_signed();
        let most = i64::try_from(most).unwrap_or(i64::MAX);
        let worker = format!("{}/{worker}", self.process.name);
        let is_unserved = demand == Demand::Unserved;
        let rows = self.database.run(async |client| {
            let statement = client.prepare_cached(LEASE).await?;
            client.query(&statement, &[&fitter, &most, &self.lease_seconds(), &worker, &is_unserved]).await
        })?;
        let mut first = Vec::new();
        let mut tasks = Vec::with_capacity(rows.len());
        for row in &rows {
            let (submission, task, attempt): (i64, i32, i32) = (row.get(0), row.get(1), row.get(2));
            let (id, digest): (&[u8], &[u8]) = (row.get(4), row.get(6));
            let recipe_digest = <[u8; 32]>::try_from(digest).ok().map(Digest::from_bytes);
            let (Some(job), Some(recipe_digest)) = (JobId::from_slice(id), recipe_digest) else {
                return Err(StoreError::Database("a job's id or digest has a wrong length".to_owned()));
            };
            let task = task.cast_unsigned();
            let lease = Lease { submission: submission.cast_unsigned(), task, attempt: attempt.cast_unsigned() };
            let kind = if row.get(3) { TaskKind::Assemble } else { TaskKind::Shard(task) };
            if row.get::<_, &str>(7) == "queued" {
                first.push(submission);
            }
            let entries_total = row.get::<_, i64>(8).cast_unsigned();
            tasks.push(LeasedTask { lease, kind, job, recipe: row.get(5), recipe_digest, entries_total });
        }
        self.held.add(tasks.iter().map(|task| task.lease));
        if !first.is_empty() {
            // Not in the same transaction, which would lock a job after its tasks. If this process ends in between, the next
            // lease makes up for it.
            let started = self.database.run(async |client| client.execute(START, &[&first]).await);
            started.inspect_err(|error| tracing::warn!(%error, "the start of a job could not be recorded")).ok();
        }
        Ok(tasks)
    }
}
