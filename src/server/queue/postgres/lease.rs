//! Leasing tasks.

use std::{
    num::NonZeroUsize,
    sync::{
        LazyLock,
        atomic::{AtomicBool, Ordering},
    },
    time::Duration,
};

use tokio_postgres::Row;

use super::{
    PostgresQueue,
    blocks::make_rows,
    jobs::{digest, job_id},
};
use crate::{
    queue::{Demand, Lease, LeasedTask, SUSPECT_DEATHS, TURN, TaskKind},
    store::StoreError,
};

/// Tasks leased in one statement, at most.
const AT_ONCE: usize = 256;

/// If other leases have locked all tasks, a lease looks again after a pause, so many times at most.
const LOOKS: u32 = 20;
const PAUSE: Duration = Duration::from_millis(5);

/// `$1` the fitter, `$2` tasks at most, `$3` seconds, `$4` the worker, `$5` whether [`Demand::Unserved`] is asked for, `$6`
/// expired leases that make a task suspect.
///
/// `jobs` are of each team the jobs of the highest priority with the fewest leased tasks that have tasks to lease; of equals,
/// the one served longest ago comes first. `places` puts the tasks of a team in the order in which they are leased, each of the job
/// that has the fewest by then, and `places_of_all` gives them out one by one, each to the team that has the fewest whole
/// shares by then, by [`crate::queue::Queue::lease`]. `taken` locks so many rows of each job, and skips those that another
/// lease has locked. Of the suspect tasks one is leased at a time. A team whose row another lease has locked keeps its turn: it
/// decides between teams that have equally much, and where many lease, they have what they should by that.
///
/// The answer has no row if there is no such job, and one row of NULLs if other leases have locked all tasks.
/// Concurrent leases choose the same jobs and take different tasks of them; the next leases even this out.
pub(super) static LEASE: LazyLock<String> = LazyLock::new(|| {
    let lease = "
    WITH suspect AS MATERIALIZED (
        SELECT EXISTS (SELECT FROM ltcforge.tasks WHERE state = 'leased' AND deaths > 0 AND deaths >= $6) AS is_leased
    ), open AS MATERIALIZED (
        SELECT submission, count(*) - 1 AS leased, max(last_served) AS last_served, max(team) AS team,
            max(priority) AS priority
        FROM (
            SELECT submission, last_served, team, priority FROM ltcforge.serving WHERE fitter = $1
            UNION ALL SELECT submission, NULL, NULL, NULL FROM ltcforge.tasks WHERE state = 'leased'
        ) AS u GROUP BY submission HAVING max(last_served) IS NOT NULL
    ), teams AS MATERIALIZED (
        SELECT t.team, t.share, t.turn, sum(o.leased)::bigint AS leased
        FROM open AS o JOIN ltcforge.teams AS t ON t.team = o.team GROUP BY t.team, t.share, t.turn
    ), jobs AS MATERIALIZED (
        SELECT t.team, t.share, t.turn, t.leased AS team_leased, j.*
        FROM teams AS t CROSS JOIN LATERAL (
            SELECT o.submission, o.priority, o.leased, o.last_served, w.waiting
            FROM (
                SELECT * FROM open WHERE team = t.team
                    AND (NOT $5 OR leased = 0 AND priority = (SELECT max(priority) FROM open))
                ORDER BY priority DESC, leased, last_served, submission
            ) AS o CROSS JOIN LATERAL (
                SELECT count(*) AS waiting FROM (
                    SELECT FROM ltcforge.tasks AS t WHERE t.submission = o.submission AND is_ready LIMIT $2
                ) AS t
            ) AS w
            WHERE w.waiting > 0 ORDER BY o.priority DESC, o.leased, o.last_served, o.submission LIMIT $2
        ) AS j
        WHERE NOT $5 OR t.leased * (SELECT sum(share) FROM teams) <= t.share * (SELECT sum(leased) FROM teams)
    ), places AS (
        SELECT team, share, turn, team_leased, submission, priority, row_number() OVER (
            PARTITION BY team ORDER BY priority DESC, leased + n, last_served, submission
        ) - 1 AS before
        FROM jobs CROSS JOIN LATERAL generate_series(1, waiting) AS n
    ), shares AS MATERIALIZED (
        SELECT submission, count(*) AS share FROM (
            SELECT submission FROM places
            ORDER BY priority DESC, (team_leased + before) / share, turn + before * (one_turn / share), team, before LIMIT $2
        ) AS places_of_all GROUP BY submission
    ), taken AS MATERIALIZED (
        SELECT t.submission, t.task, t.deaths >= $6 AS is_suspect,
            row_number() OVER (PARTITION BY t.deaths >= $6 ORDER BY t.submission, t.task) AS n
        FROM shares AS s CROSS JOIN LATERAL (
            SELECT t.submission, t.task, t.deaths FROM ltcforge.tasks AS t
            WHERE t.submission = s.submission AND is_ready
            ORDER BY t.is_assembly, t.task LIMIT s.share FOR UPDATE SKIP LOCKED
        ) AS t
    ), leased AS (
        UPDATE ltcforge.tasks AS t
        SET state = 'leased', attempt = t.attempt + 1, worker = $4, entries_reported = 0,
            lease_until = (SELECT ltcforge.clock()) + make_interval(secs => $3)
        FROM taken AS p WHERE t.submission = p.submission AND t.task = p.task AND (NOT p.is_suspect OR p.n = 1)
        RETURNING t.submission, t.task, t.is_assembly
    ), served AS (
        UPDATE ltcforge.serving SET last_served = nextval('ltcforge.servings') WHERE submission IN (
            SELECT submission FROM ltcforge.serving WHERE submission IN (SELECT submission FROM leased)
            FOR UPDATE SKIP LOCKED
        )
    ), turns AS (
        UPDATE ltcforge.teams AS t SET turn = turn + p.tasks * (one_turn / t.share)
        FROM (
            SELECT team, count(*) AS tasks FROM leased JOIN open USING (submission)
            WHERE (SELECT count(*) FROM teams) > 1 GROUP BY team
        ) AS p
        WHERE t.team = p.team AND t.team IN (
            SELECT team FROM ltcforge.teams WHERE team IN (SELECT team FROM teams) FOR UPDATE SKIP LOCKED
        )
    )
    SELECT l.submission, l.task, l.is_assembly, j.id, j.recipe, j.recipe_digest, j.state, j.entries_total
    FROM (SELECT FROM jobs LIMIT 1) AS any_job
    LEFT JOIN (leased AS l JOIN ltcforge.jobs AS j ON j.submission = l.submission) ON true
    ORDER BY l.submission, l.task";
    lease.replace("is_ready", READY).replace("one_turn", &TURN.to_string())
});

/// Whether a task `t` can be leased: the assembly when nothing else of its job is left. A subquery with LIMIT 1
/// uses an index for each row; the planner may make NOT EXISTS a join with all leased tasks.
const READY: &str = "t.state = 'waiting' AND (t.deaths < $6 OR NOT (SELECT is_leased FROM suspect)) AND (
        NOT t.is_assembly OR (
            SELECT true FROM ltcforge.tasks AS u
            WHERE u.submission = t.submission AND u.state = 'waiting' AND NOT u.is_assembly LIMIT 1
        ) IS NULL AND (
            SELECT true FROM ltcforge.tasks AS u WHERE u.submission = t.submission AND u.state = 'leased' LIMIT 1
        ) IS NULL AND (
            SELECT true FROM ltcforge.blocks AS b WHERE b.submission = t.submission LIMIT 1
        ) IS NULL
    )";

/// The tasks of a lease whose answer was lost: `$1` its name.
const LEASED_BEFORE: &str = "
    SELECT t.submission, t.task, t.is_assembly, j.id, j.recipe, j.recipe_digest, j.state, j.entries_total
    FROM ltcforge.tasks AS t JOIN ltcforge.jobs AS j ON j.submission = t.submission
    WHERE t.state = 'leased' AND t.worker = $1 AND t.lease_until > (SELECT ltcforge.clock())
    ORDER BY t.submission, t.task";

/// A row if there is an unfinished job.
pub(super) const OPEN: &str = "SELECT FROM ltcforge.serving ORDER BY submission LIMIT 1";

const START: &str = "
    UPDATE ltcforge.jobs SET state = 'running', started_at = (SELECT ltcforge.clock())
    WHERE submission = ANY ($1) AND state = 'queued'";

impl PostgresQueue {
    pub(super) fn lease_tasks(&self, demand: Demand, most: NonZeroUsize) -> Result<Vec<LeasedTask>, StoreError> {
        if self.sweep.is_due() {
            let open = self
                .database
                .run(async |client| Ok(client.query_opt(&client.prepare_cached(OPEN).await?, &[]).await?))?;
            // At rest a worker asks this alone.
            if open.is_none() {
                return Ok(vec![]);
            }
            self.take_back_expired()?;
            self.database.run(async |client| Ok(make_rows(client).await?))?;
        }
        let name = self.lease_names.fetch_add(1, Ordering::Relaxed);
        let worker = self.process.lease_name(name);
        for _ in 0..LOOKS {
            let rows = self.lease_rows(&worker, demand == Demand::Unserved, most.get().min(AT_ONCE))?;
            if rows.is_empty() {
                return Ok(vec![]);
            }
            let tasks: Vec<LeasedTask> =
                rows.iter().filter_map(|row| task(row, name).transpose()).collect::<Result<_, _>>()?;
            if !tasks.is_empty() {
                self.held.add(tasks.iter().map(|task| task.lease));
                self.start_jobs(&rows);
                return Ok(tasks);
            }
            self.changes.pause(PAUSE);
        }
        Ok(vec![])
    }

    fn lease_rows(&self, worker: &str, is_unserved: bool, most: usize) -> Result<Vec<Row>, StoreError> {
        let (fitter, most) = (self.process.fitter.cast_signed(), i64::try_from(most).unwrap_or(i64::MAX));
        let (seconds, suspect) = (self.limits.lease_ttl.as_secs_f64(), SUSPECT_DEATHS.cast_signed());
        let tried = AtomicBool::new(false);
        self.database.run(async |client| {
            if tried.swap(true, Ordering::Relaxed) {
                let before = client.query(&client.prepare_cached(LEASED_BEFORE).await?, &[&worker]).await?;
                if !before.is_empty() {
                    return Ok(before);
                }
            }
            let statement = client.prepare_cached(&LEASE).await?;
            Ok(client.query(&statement, &[&fitter, &most, &seconds, &worker, &is_unserved, &suspect]).await?)
        })
    }

    /// Records that jobs have been started. The transaction of the lease cannot, because it would lock a job after its
    /// tasks. If this process ends in between, the next lease records it.
    fn start_jobs(&self, leased: &[Row]) {
        let is_queued = |row: &&Row| row.get::<_, Option<&str>>("state") == Some("queued");
        let queued: Vec<i64> = leased.iter().filter(is_queued).map(|row| row.get("submission")).collect();
        if queued.is_empty() {
            return;
        }
        let started = self.database.run(async |client| Ok(client.execute(START, &[&queued]).await?));
        started.inspect_err(|error| tracing::warn!(%error, "the start of a job could not be recorded")).ok();
    }
}

/// The task of a row of [`LEASE`], if it has one.
fn task(row: &Row, name: u64) -> Result<Option<LeasedTask>, StoreError> {
    let Some(submission) = row.get::<_, Option<i64>>("submission") else { return Ok(None) };
    let task = row.get::<_, i32>("task").cast_unsigned();
    let kind = if row.get("is_assembly") { TaskKind::Assemble } else { TaskKind::Shard(task) };
    Ok(Some(LeasedTask {
        lease: Lease { submission: submission.cast_unsigned(), task, name },
        kind,
        job: job_id(row)?,
        recipe: row.get("recipe"),
        recipe_digest: digest(row, "recipe_digest")?,
        entries_total: row.get::<_, i64>("entries_total").cast_unsigned(),
    }))
}
