//! Submitting and cancelling jobs.

use std::collections::HashSet;

use deadpool_postgres::Transaction;
use tokio_postgres::Error;

use super::{
    PostgresQueue, blocks,
    jobs::{self, COLUMNS, job},
};
use crate::{
    queue::{Job, JobId, JobState, NewJob, QueueError, Submitted},
    store::StoreError,
};
use ltcforge_files::digest::Digest;

/// Number of the advisory lock under which jobs are submitted: «submit» in ASCII. It makes the limit of jobs exact.
const LOCK: i64 = 0x7375_626d_6974;

/// `$1` the submission, `$2` its number of shards.
const INSERT_REST: &str = "
    WITH assembly AS (
        INSERT INTO ltcforge.tasks (submission, task, is_assembly, entries, state) VALUES ($1, $2, true, 0, 'waiting')
    )
    INSERT INTO ltcforge.finished_entries (submission, slot, entries)
    SELECT $1, 0, coalesce(sum(entries), 0) FROM ltcforge.tasks WHERE submission = $1 AND state = 'finished'";

/// Lets a job, `$1` its submission, be served as its row says. A team that has no other begins where the one begins that is next.
const SERVE: &str = "
    WITH job AS (
        SELECT submission, fitter, team, share, priority FROM ltcforge.jobs WHERE submission = $1
    ), team AS (
        INSERT INTO ltcforge.teams AS t (team, share, turn)
        SELECT team, share, (
            SELECT coalesce(min(u.turn), 0) FROM ltcforge.teams AS u
            WHERE u.team IN (SELECT team FROM ltcforge.serving WHERE submission <> $1)
        ) FROM job
        ON CONFLICT (team) DO UPDATE SET share = excluded.share, turn = CASE
            WHEN EXISTS (SELECT FROM ltcforge.serving AS s WHERE s.team = t.team AND s.submission <> $1) THEN t.turn
            ELSE greatest(t.turn, excluded.turn)
        END
    )
    INSERT INTO ltcforge.serving (submission, fitter, team, priority) SELECT submission, fitter, team, priority FROM job
    ON CONFLICT (submission) DO UPDATE SET team = excluded.team, priority = excluded.priority";

/// A claim for a submission: `$1` it, `$2` the team, `$3` its share, `$4` the priority.
const CLAIM: &str = "UPDATE ltcforge.jobs SET team = $2, share = $3, priority = $4 WHERE submission = $1";

const DELETE: &str = "DELETE FROM ltcforge.jobs WHERE submission = $1 RETURNING submission, shards_digest";

/// Keeps the finished shards of a submission for another with equal shards.
const KEEP: &str = "
    UPDATE ltcforge.tasks AS t SET submission = j.submission, attempt = 0, failures = 0, deaths = 0
    FROM ltcforge.jobs AS j WHERE j.submission = $2 AND j.shards_digest = $3
        AND t.submission = $1 AND t.state = 'finished' AND NOT t.is_assembly
    RETURNING t.task";

/// Inserts the tasks of an unfinished job, all but its `finished` ones, and tells all processes.
pub(super) async fn insert_tasks(
    client: &Transaction<'_>,
    submission: i64,
    id: JobId,
    shard_entries: &[u32],
    finished: &HashSet<i32>,
) -> Result<(), Error> {
    let shards = i32::try_from(shard_entries.len()).unwrap_or(i32::MAX);
    client.execute(INSERT_REST, &[&submission, &shards]).await?;
    client.execute(SERVE, &[&submission]).await?;
    blocks::insert(client, submission, shard_entries, finished).await?;
    jobs::notify(client, &format!("begin {id}")).await
}

async fn lock_submissions(client: &Transaction<'_>) -> Result<(), Error> {
    client.execute("SELECT pg_advisory_xact_lock($1)", &[&LOCK]).await.map(drop)
}

/// Locks a job. Returns its submission and the job.
async fn lock(client: &Transaction<'_>, id: JobId) -> Result<Option<(i64, Job)>, StoreError> {
    let row = client.query_opt(&format!("{COLUMNS} WHERE id = $1 FOR UPDATE"), &[&id.as_bytes().as_slice()]).await?;
    row.map(|row| Ok((row.get("submission"), job(&row)?))).transpose()
}

async fn read(client: &Transaction<'_>, submission: i64) -> Result<Job, StoreError> {
    job(&client.query_one(&format!("{COLUMNS} WHERE submission = $1"), &[&submission]).await?)
}

impl PostgresQueue {
    pub(super) fn submit_job(&self, new: &NewJob, has_table: &dyn Fn(Digest) -> bool) -> Result<Submitted, QueueError> {
        self.forget_old_jobs();
        let id = JobId::of_recipe(&new.recipe_digest);
        loop {
            // The blob store is asked before the transaction, which holds a lock.
            let mut without_table = None;
            if let Some(former) = self.job_by_id(id)?
                && let JobState::Done { table } = former.state
            {
                if has_table(table) {
                    return Ok(Submitted::Done(former, table));
                }
                without_table = Some(table);
            }
            let submitted = self.database.run(async |client| {
                let transaction = client.transaction().await?;
                let submitted = self.submit_in(&transaction, id, new, without_table).await?;
                transaction.commit().await?;
                Ok(submitted)
            })?;
            if let Some(submitted) = submitted {
                if let Ok(Submitted::Queued(_)) = submitted {
                    self.changes.note(Some(id));
                }
                return submitted;
            }
        }
    }

    /// `None` if another process has made the job's table meanwhile.
    async fn submit_in(
        &self,
        transaction: &Transaction<'_>,
        id: JobId,
        new: &NewJob,
        without_table: Option<Digest>,
    ) -> Result<Option<Result<Submitted, QueueError>>, StoreError> {
        lock_submissions(transaction).await?;
        let former = lock(transaction, id).await?;
        match &former {
            Some((submission, job)) if !job.state.name().is_final() => {
                let claim = new.claim();
                if claim.priority <= job.claim.priority {
                    return Ok(Some(Ok(Submitted::Joined(job.clone()))));
                }
                let (share, priority) = jobs::claim_columns(&claim);
                transaction.execute(CLAIM, &[submission, &claim.team, &share, &priority]).await?;
                transaction.execute(SERVE, &[submission]).await?;
                return Ok(Some(Ok(Submitted::Joined(Job { claim, ..job.clone() }))));
            }
            Some((_, Job { state: JobState::Done { table }, .. })) if without_table != Some(*table) => {
                return Ok(None);
            }
            _ => {}
        }
        let count = "
            SELECT count(*), count(*) FILTER (WHERE team = $1), (SELECT ltcforge.clock()) FROM ltcforge.jobs
            WHERE state IN ('queued', 'running')";
        let claim = new.claim();
        let now = transaction.query_one(count, &[&claim.team]).await?;
        let is_full = |column, limit| usize::try_from(now.get::<_, i64>(column)).is_ok_and(|open| limit <= open);
        let limit = self.limits.jobs_of(&claim.team);
        if is_full(0, self.limits.jobs) {
            return Ok(Some(Err(QueueError::Full { limit: self.limits.jobs, team: None })));
        }
        if is_full(1, limit) {
            return Ok(Some(Err(QueueError::Full { limit, team: Some(claim.team) })));
        }
        let job = Job {
            id,
            recipe: new.recipe.clone(),
            recipe_digest: new.recipe_digest,
            state: JobState::Queued,
            entries_total: new.entries(),
            entries_done: 0,
            attempts: 0,
            created_at: now.get(2),
            started_at: None,
            finished_at: None,
            submitted_by: new.submitted_by(),
            cancelled_by: None,
            claim,
        };
        let mut before = None;
        if let Some((submission, _)) = former {
            before = Some(transaction.query_one(DELETE, &[&submission]).await?);
        }
        let inserted = jobs::insert(transaction, &job, self.process.fitter, &new.shard_entries).await?;
        // Not expected: only `import` inserts jobs without the lock.
        let submission = inserted.ok_or_else(|| StoreError::Unavailable(format!("job {id} is being imported")))?;
        let mut finished = HashSet::new();
        if let Some(before) = before {
            let (before, shards_digest): (i64, &[u8]) = (before.get(0), before.get(1));
            let kept = transaction.query(KEEP, &[&before, &submission, &shards_digest]).await?;
            finished.extend(kept.iter().map(|row| row.get::<_, i32>(0)));
            jobs::remove_tasks(transaction, before, false).await?;
        }
        insert_tasks(transaction, submission, id, &new.shard_entries, &finished).await?;
        Ok(Some(Ok(Submitted::Queued(read(transaction, submission).await?))))
    }

    pub(super) fn adopt_job(&self, done: &Job) -> Result<Job, StoreError> {
        let adopted = self.database.run(async |client| {
            let transaction = client.transaction().await?;
            lock_submissions(&transaction).await?;
            if let Some((submission, former)) = lock(&transaction, done.id).await? {
                if !former.state.name().is_final() || former.state == done.state {
                    return Ok(former);
                }
                transaction.execute(DELETE, &[&submission]).await?;
                jobs::remove_tasks(&transaction, submission, false).await?;
            }
            jobs::insert(&transaction, done, self.process.fitter, &[]).await?;
            transaction.commit().await?;
            Ok(done.clone())
        })?;
        self.changes.note(Some(done.id));
        Ok(adopted)
    }

    pub(super) fn cancel_job(&self, id: JobId, by: Option<&str>) -> Result<Option<Job>, StoreError> {
        let cancelled = self.database.run(async |client| {
            let transaction = client.transaction().await?;
            let Some((submission, job)) = lock(&transaction, id).await? else { return Ok(None) };
            if job.state.name().is_final() {
                return Ok(None);
            }
            jobs::end(&transaction, submission, id, &JobState::Cancelled).await?;
            let who = "UPDATE ltcforge.jobs SET cancelled_by = $2 WHERE submission = $1";
            transaction.execute(who, &[&submission, &by]).await?;
            transaction.commit().await?;
            Ok(Some(submission))
        })?;
        if let Some(submission) = cancelled {
            self.held.remove_all(submission.cast_unsigned());
            self.changes.note(Some(id));
        }
        self.job_by_id(id)
    }
}
