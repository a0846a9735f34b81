//! Leasing tasks.

use std::{
    num::NonZeroUsize,
    sync::{
        LazyLock,
        atomic::{AtomicBool, Ordering},
    },
    thread,
    time::Duration,
};

use tokio_postgres::types::ToSql;

use super::{failing, gate, shared::Shared};
use crate::{
    queue::{Demand, JobId, Lease, LeasedTask, Offer, SUSPECT_DEATHS, TaskKind},
    store::StoreError,
};
use ltcforge_files::digest::Digest;

/// Tasks leased in one statement, at most.
const AT_ONCE: usize = 256;

/// How long a lease that found only what others were leasing waits until it looks again, at most.
const CONTENDED: Duration = Duration::from_millis(8);

/// How often it looks.
const LOOKS: u32 = 20;

/// `$1` the fitter, `$2` tasks at most, `$3` seconds, `$4` the worker, `$5` whether only jobs that nobody works for count,
/// `$6` expired leases that make a task suspect.
///
/// Each job offers its waiting shards, then those of its blocks; the assembly only when no shard waits or is leased. A place
/// in the queue is the number of the job's leased tasks if it gets the task; the lowest places are taken. Those are of jobs
/// that nobody works for (`idle`), served longest ago first; only if they are too few is counted what each job has
/// (`standing`). No more jobs are asked for their offers than tasks are wanted, those with the lowest places (`nearest`).
///
/// Leases at the same time would look at the same jobs, so each locks the rows of `serving` of the jobs it serves, and
/// passes over those that another has locked or has served since this statement began. Among the jobs that are counted it
/// does so while there are enough others (`apart`) with at most one leased task more than those that would be next: what
/// it passes over has one more by then too. Else it shares the next ones with the others. It locks what a subquery has found,
/// because a row that has changed is checked once more with all that is below the lock in the plan.
///
/// Tasks and blocks that another transaction is leasing now are passed over. A subquery with LIMIT 1 is asked for each row
/// by an index, where NOT EXISTS may be joined to all leased tasks. Of the suspect tasks, one is leased at a time. Tells
/// with each task, or alone, whether any job had something to offer.
pub(super) static LEASE: LazyLock<String> = LazyLock::new(|| LEASE_TEXT.replace("ltcforge_offer", OFFER));

/// What the job `s.submission` offers: its waiting shards, at most `$2`; and as `waiting` also those of its blocks, or its
/// assembly if nothing else is left.
const OFFER: &str = "
    SELECT r.shards, CASE WHEN r.shards + b.shards > 0 THEN least(r.shards + b.shards, $2) ELSE a.assemblies END AS waiting
    FROM (
        SELECT count(*) AS shards FROM (
            SELECT FROM ltcforge.tasks AS t WHERE t.submission = s.submission AND t.state = 'waiting'
                AND NOT t.is_assembly AND (t.deaths < $6 OR NOT (SELECT leased FROM suspect)) LIMIT $2
        ) AS f
    ) AS r CROSS JOIN (
        SELECT coalesce(sum(f.past - f.next), 0) AS shards FROM (
            SELECT u.past, u.next FROM ltcforge.blocks AS u WHERE u.submission = s.submission
            ORDER BY u.first LIMIT $2 / 64 + 2
        ) AS f
    ) AS b CROSS JOIN LATERAL (
        SELECT count(*) AS assemblies FROM (
            SELECT FROM ltcforge.tasks AS t WHERE r.shards + b.shards = 0 AND t.submission = s.submission AND t.state = 'waiting'
                AND t.is_assembly AND (t.deaths < $6 OR NOT (SELECT leased FROM suspect))
                AND (
                    SELECT true FROM ltcforge.tasks AS u WHERE u.submission = s.submission AND u.state = 'leased' LIMIT 1
                ) IS NULL AND (
                    SELECT true FROM ltcforge.tasks AS u
                    WHERE u.submission = s.submission AND u.state = 'waiting' AND NOT u.is_assembly LIMIT 1
                ) IS NULL
        ) AS f
    ) AS a";

const LEASE_TEXT: &str = "
    WITH suspect AS MATERIALIZED (
        SELECT EXISTS (SELECT FROM ltcforge.tasks WHERE state = 'leased' AND deaths > 0 AND deaths >= $6) AS leased
    ), idle AS MATERIALIZED (
        SELECT n.submission, 0::bigint AS leased, n.last_served, n.shards, n.waiting
        FROM (
            SELECT s.submission, s.last_served, w.shards, w.waiting
            FROM ltcforge.serving AS s CROSS JOIN LATERAL (ltcforge_offer) AS w
            WHERE s.fitter = $1 AND w.waiting > 0 AND (
                SELECT true FROM ltcforge.tasks AS u WHERE u.submission = s.submission AND u.state = 'leased' LIMIT 1
            ) IS NULL
            ORDER BY s.last_served, s.submission
        ) AS n JOIN ltcforge.serving AS s ON s.submission = n.submission AND s.last_served = n.last_served
        ORDER BY n.last_served, n.submission LIMIT $2 FOR UPDATE OF s SKIP LOCKED
    ), standing AS MATERIALIZED (
        SELECT submission, count(*) - 1 AS leased, max(last_served) AS last_served FROM (
            SELECT submission, last_served FROM ltcforge.serving WHERE fitter = $1
            UNION ALL SELECT submission, NULL FROM ltcforge.tasks WHERE state = 'leased'
        ) AS u
        WHERE NOT $5 AND (SELECT count(*) FROM idle) < $2 GROUP BY submission HAVING max(last_served) IS NOT NULL
    ), nearest AS MATERIALIZED (
        SELECT s.submission, s.leased, s.last_served, w.shards, w.waiting
        FROM (SELECT * FROM standing ORDER BY leased, last_served, submission) AS s CROSS JOIN LATERAL (ltcforge_offer) AS w
        WHERE w.waiting > 0
        ORDER BY s.leased, s.last_served, s.submission LIMIT $2
    ), apart AS MATERIALIZED (
        SELECT n.submission, n.leased, n.last_served, n.shards, n.waiting
        FROM (
            SELECT s.submission, s.leased, s.last_served, w.shards, w.waiting
            FROM (SELECT * FROM standing ORDER BY leased, last_served, submission) AS s
            CROSS JOIN LATERAL (ltcforge_offer) AS w
            WHERE w.waiting > 0 AND s.leased <= (SELECT max(leased) + 1 FROM nearest) AND (SELECT count(*) FROM nearest) = $2
            ORDER BY s.leased, s.last_served, s.submission
        ) AS n JOIN ltcforge.serving AS s ON s.submission = n.submission AND s.last_served = n.last_served
        ORDER BY n.leased, n.last_served, n.submission LIMIT $2 FOR UPDATE OF s SKIP LOCKED
    ), open AS MATERIALIZED (
        SELECT * FROM idle WHERE $5 OR (SELECT count(*) FROM idle) = $2
        UNION ALL SELECT * FROM apart WHERE (SELECT count(*) FROM apart) = $2
        UNION ALL SELECT * FROM nearest WHERE (SELECT count(*) FROM apart) < $2
    ), shares AS MATERIALIZED (
        SELECT submission, count(*) AS share, min(shards) AS shards FROM (
            SELECT submission, shards FROM open CROSS JOIN LATERAL generate_series(1, CASE
                WHEN (SELECT count(*) FROM open) < $2 THEN waiting
                ELSE least(waiting, (SELECT max(leased) FROM open) - leased + 1)
            END) AS n
            ORDER BY leased + n, n > 1, last_served, submission LIMIT $2
        ) AS places GROUP BY submission
    ), picked AS MATERIALIZED (
        SELECT t.submission, t.task, t.is_suspect FROM shares CROSS JOIN LATERAL (
            SELECT t.submission, t.task, t.deaths >= $6 AS is_suspect FROM ltcforge.tasks AS t
            WHERE t.submission = shares.submission AND t.state = 'waiting'
                AND (t.deaths < $6 OR NOT (SELECT leased FROM suspect))
                AND (
                    NOT t.is_assembly OR (
                        SELECT true FROM ltcforge.tasks AS u
                        WHERE u.submission = t.submission AND u.state = 'waiting' AND NOT u.is_assembly LIMIT 1
                    ) IS NULL AND (
                        SELECT true FROM ltcforge.tasks AS u
                        WHERE u.submission = t.submission AND u.state = 'leased' LIMIT 1
                    ) IS NULL AND (
                        SELECT true FROM ltcforge.blocks AS u WHERE u.submission = t.submission LIMIT 1
                    ) IS NULL
                )
            ORDER BY t.is_assembly, t.task LIMIT shares.share FOR UPDATE OF t SKIP LOCKED
        ) AS t
    ), again AS (
        UPDATE ltcforge.tasks AS t
        SET state = 'leased', attempt = t.attempt + 1, worker = $4, entries_reported = 0,
            lease_until = (SELECT ltcforge.clock()) + make_interval(secs => $3)
        FROM (
            SELECT submission, task, is_suspect, row_number() OVER (PARTITION BY is_suspect ORDER BY submission, task) AS place
            FROM picked
        ) AS p
        WHERE t.submission = p.submission AND t.task = p.task AND (NOT p.is_suspect OR p.place = 1)
        RETURNING t.submission, t.task, t.attempt, t.is_assembly
    ), locked AS MATERIALIZED (
        SELECT b.submission, b.first, b.next, b.past, b.entries, shares.share - least(shares.shards, shares.share) AS share
        FROM shares CROSS JOIN LATERAL (
            SELECT b.* FROM ltcforge.blocks AS b WHERE b.submission = shares.submission AND shares.shards < shares.share
            ORDER BY b.first LIMIT (shares.share - shares.shards + 63) / 64 FOR UPDATE OF b SKIP LOCKED
        ) AS b
    ), taken AS MATERIALIZED (
        SELECT submission, first, next, past, entries, least(past - next, greatest(share - coalesce(sum(past - next) OVER (
            PARTITION BY submission ORDER BY first ROWS BETWEEN UNBOUNDED PRECEDING AND 1 PRECEDING), 0), 0))::integer AS taken
        FROM locked
    ), moved AS (
        UPDATE ltcforge.blocks AS b SET next = b.next + t.taken FROM taken AS t
        WHERE b.submission = t.submission AND b.first = t.first AND t.taken > 0 AND t.next + t.taken < t.past
    ), emptied AS (
        DELETE FROM ltcforge.blocks AS b USING taken AS t
        WHERE b.submission = t.submission AND b.first = t.first AND t.next + t.taken = t.past
    ), begun AS (
        INSERT INTO ltcforge.tasks (submission, task, is_assembly, entries, state, attempt, worker, lease_until)
        SELECT t.submission, n, false, t.entries, 'leased', 1, $4,
            (SELECT ltcforge.clock()) + make_interval(secs => $3)
        FROM taken AS t CROSS JOIN LATERAL generate_series(t.next, t.next + t.taken - 1) AS n
        RETURNING submission, task, attempt, is_assembly
    ), leased AS (
        SELECT * FROM again UNION ALL SELECT * FROM begun
    ), served AS (
        UPDATE ltcforge.serving SET last_served = nextval('ltcforge.servings') WHERE submission IN (
            SELECT submission FROM ltcforge.serving WHERE submission IN (SELECT submission FROM leased)
            FOR UPDATE SKIP LOCKED
        )
    )
    SELECT o.jobs > 0 AS is_offered, l.submission, l.task, l.attempt, l.is_assembly, j.id, j.recipe, j.recipe_digest, j.state,
        j.entries_total
    FROM (SELECT count(*) AS jobs FROM open) AS o
    LEFT JOIN (leased AS l JOIN ltcforge.jobs AS j ON j.submission = l.submission) ON true
    ORDER BY l.submission, l.task";

/// The tasks of a lease whose answer was lost: `$1` its name.
const LEASED_BEFORE: &str = "
    SELECT true AS is_offered, t.submission, t.task, t.attempt, t.is_assembly, j.id, j.recipe, j.recipe_digest, j.state,
        j.entries_total
    FROM ltcforge.tasks AS t JOIN ltcforge.jobs AS j ON j.submission = t.submission
    WHERE t.state = 'leased' AND t.worker = $1 AND t.lease_until > (SELECT ltcforge.clock())
    ORDER BY t.submission, t.task";

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
        // No other lease has this name, of whatever process.
        let worker = format!("{}/{worker}/{}", self.process.name, self.leases_asked.fetch_add(1, Ordering::Relaxed));
        let tried = AtomicBool::new(false);
        let is_unserved = demand == Demand::Unserved;
        let suspect = SUSPECT_DEATHS.cast_signed();
        let mut looks = 0;
        let rows = loop {
            let rows = self.database.run(async |client| {
                if tried.swap(true, Ordering::Relaxed) {
                    let before = client.query(&client.prepare_cached(LEASED_BEFORE).await?, &[&worker]).await?;
                    if !before.is_empty() {
                        return Ok(before);
                    }
                }
                let statement = client.prepare_cached(&LEASE).await?;
                let parameters: [&(dyn ToSql + Sync); 6] =
                    [&fitter, &most, &self.lease_seconds(), &worker, &is_unserved, &suspect];
                if most < gate::MANY {
                    return client.query(&statement, &parameters).await;
                }
                gate::query(client, &statement, &parameters).await
            })?;
            let (is_offered, is_empty) = rows.first().map_or((false, true), |row| {
                (row.get::<_, bool>("is_offered"), row.get::<_, Option<i64>>("submission").is_none())
            });
            looks += 1;
            if !is_empty {
                break rows;
            }
            if !is_offered || looks == LOOKS {
                return Ok(vec![]);
            }
            // Others are taking what there is; they may leave something.
            thread::sleep(CONTENDED.min(Duration::from_millis(1) * looks));
        };
        let mut first = Vec::new();
        let mut tasks = Vec::with_capacity(rows.len());
        for row in &rows {
            let (submission, task, attempt): (i64, i32, i32) =
                (row.get("submission"), row.get("task"), row.get("attempt"));
            let (id, digest): (&[u8], &[u8]) = (row.get("id"), row.get("recipe_digest"));
            let recipe_digest = <[u8; 32]>::try_from(digest).ok().map(Digest::from_bytes);
            let (Some(job), Some(recipe_digest)) = (JobId::from_slice(id), recipe_digest) else {
                return Err(StoreError::Database("a job's id or digest has a wrong length".to_owned()));
            };
            let task = task.cast_unsigned();
            let lease = Lease { submission: submission.cast_unsigned(), task, attempt: attempt.cast_unsigned() };
            let kind = if row.get("is_assembly") { TaskKind::Assemble } else { TaskKind::Shard(task) };
            if row.get::<_, &str>("state") == "queued" {
                first.push(submission);
            }
            let entries_total = row.get::<_, i64>("entries_total").cast_unsigned();
            tasks.push(LeasedTask { lease, kind, job, recipe: row.get("recipe"), recipe_digest, entries_total });
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
