//! Submits jobs, and removes jobs that ended long ago.

use deadpool_postgres::Transaction;

use super::{PostgresQueue, jobs};
use crate::{
    queue::{Job, JobId, JobState, NewJob, QueueError, Submitted, order},
    store::StoreError,
};
use ltcforge_files::digest::Digest;

/// Maximum number of ended jobs that one submission removes.
const MOST_FORGOTTEN: i64 = 256;

const INSERT: &str = "
    INSERT INTO ltcforge.jobs (id, recipe_digest, recipe, fitter, shards_digest, entries_total, state, created_at,
        submitted_by)
    VALUES ($1, $2, $3, $4, $5, $6, 'queued', ltcforge.clock(), $7)
    ON CONFLICT (id) DO NOTHING RETURNING submission";

/// Queues an ended job again. `$1` the old submission. The foreign key updates the submission of its finished shards.
const AGAIN: &str = "
    UPDATE ltcforge.jobs SET submission = nextval('ltcforge.submissions'), fitter = $2, shards_digest = $3,
        entries_total = $4, submitted_by = $5, state = 'queued', created_at = ltcforge.clock(), table_digest = NULL,
        failure = NULL, entries_done = NULL, attempts = NULL, started_at = NULL, finished_at = NULL, cancelled_by = NULL
    WHERE submission = $1 RETURNING submission";

const TASKS: &str = "
    INSERT INTO ltcforge.tasks (submission, task, is_assembly, fitter, tag, entries, seconds, state)
    SELECT $1, t.task, t.state = 'blocked', $2, t.tag, t.entries, t.seconds, t.state
    FROM unnest($3::integer[], $4::bigint[], $5::integer[], $6::double precision[], $7::text[])
        AS t (task, tag, entries, seconds, state)";

/// Selects the time and the virtual time, in microseconds. The base of a job is the start of its first shard.
const TIMES: &str = "
    SELECT (extract(epoch FROM ltcforge.clock()) * 1e6)::bigint, greatest(coalesce(
        (SELECT max(tag - (seconds * 1e6)::bigint) FROM ltcforge.tasks WHERE state = 'leased' AND fitter = $1),
        (SELECT tag - (seconds * 1e6)::bigint FROM ltcforge.tasks WHERE state = 'waiting' AND fitter = $1
            ORDER BY tag, submission, task LIMIT 1)
    ), (SELECT max(t.tag - (t.seconds * 1e6)::bigint) FROM ltcforge.jobs AS j
        JOIN ltcforge.tasks AS t ON t.submission = j.submission AND t.task = 0
        WHERE j.state IN ('queued', 'running') AND j.fitter = $1))";

/// Removes ended jobs. `$1` seconds to keep them or NULL, `$2` number of jobs to keep or NULL, `$3` maximum number to
/// remove by each rule.
const FORGET: &str = "
    DELETE FROM ltcforge.jobs WHERE submission IN (
        (SELECT submission FROM ltcforge.jobs WHERE finished_at < ltcforge.clock() - make_interval(secs => $1)
            ORDER BY finished_at LIMIT $3)
        UNION ALL
        (SELECT submission FROM ltcforge.jobs WHERE finished_at IS NOT NULL AND $2::bigint IS NOT NULL
            ORDER BY finished_at DESC OFFSET coalesce($2, 0) LIMIT $3)
    )";

/// The digest of the numbers of entries of all shards.
fn shards_digest(new: &NewJob) -> Digest {
    let entries: Vec<u8> = new.shards.iter().flat_map(|shard| shard.entries.to_be_bytes()).collect();
    Digest::of(&entries)
}

/// The result of a submission.
enum Outcome {
    New,
    Joined,
    Full,
}

impl PostgresQueue {
    /// Removes jobs that ended long ago.
    pub(super) fn forget(&self) -> Result<(), StoreError> {
        let keep = self.limits.keep_ended.map(|keep| keep.as_secs_f64());
        let most = self.limits.most_ended.map(|most| i64::try_from(most).unwrap_or(i64::MAX));
        if keep.is_none() && most.is_none() {
            return Ok(());
        }
        self.database.run(async |client| {
            client.execute(&client.prepare_cached(FORGET).await?, &[&keep, &most, &MOST_FORGOTTEN]).await?;
            Ok(())
        })
    }

    /// Stores a job that is unknown or has ended. A job that is done is queued again if its table is `missing`.
    pub(super) fn store_new(&self, new: &NewJob, missing: Option<Digest>) -> Result<Submitted, QueueError> {
        let id = JobId::of_recipe(&new.recipe_digest);
        let key = id.as_bytes().as_slice();
        let (outcome, job) = self.database.run(async |client| {
            let transaction = client.transaction().await?;
            let open = "SELECT count(*) FROM ltcforge.jobs WHERE state IN ('queued', 'running')";
            let open: i64 = transaction.query_one(&transaction.prepare_cached(open).await?, &[]).await?.get(0);
            let is_full = usize::try_from(open).is_ok_and(|open| open >= self.limits.jobs);
            let lock = transaction.prepare_cached("SELECT FROM ltcforge.jobs WHERE id = $1 FOR UPDATE").await?;
            transaction.query_opt(&lock, &[&key]).await?;
            let known = jobs::select(&transaction, "id = $1", &[&key]).await?.pop();
            let outcome = match known {
                Some((_, job)) if !job.state.name().is_final() => Outcome::Joined,
                // Another process has finished the job since its table was looked up.
                Some((_, Job { state: JobState::Done { table }, .. })) if Some(table) != missing => Outcome::Joined,
                _ if is_full => Outcome::Full,
                Some((submission, _)) => {
                    self.insert(&transaction, new, Some(submission.cast_signed())).await?;
                    Outcome::New
                }
                None if self.insert(&transaction, new, None).await? => Outcome::New,
                // Another process has just submitted the job.
                None => Outcome::Joined,
            };
            let job = jobs::select(&transaction, "id = $1", &[&key]).await?.pop();
            transaction.commit().await?;
            Ok((outcome, job))
        })?;
        let gone = || StoreError::Unavailable("the job was removed while it was submitted".to_owned());
        match outcome {
            Outcome::Full => Err(QueueError::Full(self.limits.jobs)),
            Outcome::New => Ok(Submitted::Queued(job.ok_or_else(gone)?.1)),
            Outcome::Joined => Ok(match job.ok_or_else(gone)?.1 {
                job @ Job { state: JobState::Done { table }, .. } => Submitted::Done(job, table),
                job => Submitted::Joined(job),
            }),
        }
    }

    /// Inserts a job and its tasks, or queues the submission `old` again. Returns `false` if the job exists already.
    async fn insert(&self, transaction: &Transaction<'_>, new: &NewJob, old: Option<i64>) -> Result<bool, StoreError> {
        let (recipe_digest, shards_digest) = (new.recipe_digest.as_bytes().as_slice(), shards_digest(new));
        let shards_digest = shards_digest.as_bytes().as_slice();
        let (fitter, entries) = (new.fitter.cast_signed(), new.entries().cast_signed());
        let submission: i64 = if let Some(old) = old {
            let others = "DELETE FROM ltcforge.tasks AS t USING ltcforge.jobs AS j
                WHERE t.submission = $1 AND j.submission = $1 AND (j.fitter <> $2 OR j.shards_digest <> $3)";
            let others = transaction.prepare_cached(others).await?;
            transaction.execute(&others, &[&old, &fitter, &shards_digest]).await?;
            let again = transaction.prepare_cached(AGAIN).await?;
            transaction.query_one(&again, &[&old, &fitter, &shards_digest, &entries, &new.submitted_by]).await?.get(0)
        } else {
            let id = JobId::of_recipe(&new.recipe_digest);
            let key = id.as_bytes().as_slice();
            let insert = transaction.prepare_cached(INSERT).await?;
            let row = transaction
                .query_opt(
                    &insert,
                    &[&key, &recipe_digest, &new.recipe, &fitter, &shards_digest, &entries, &new.submitted_by],
                )
                .await?;
            let Some(row) = row else { return Ok(false) };
            row.get(0)
        };
        let finished = "SELECT task FROM ltcforge.tasks WHERE submission = $1 ORDER BY task";
        let finished = transaction.query(&transaction.prepare_cached(finished).await?, &[&submission]).await?;
        let finished: Vec<i32> = finished.iter().map(|row| row.get(0)).collect();
        let is_finished = |number: u32| finished.binary_search(&number.cast_signed()).is_ok();
        let row = transaction.query_one(&transaction.prepare_cached(TIMES).await?, &[&fitter]).await?;
        let tags = order::tags(order::base(row.get(0), row.get(1)), &new.shards, is_finished);
        let (mut tasks, mut entries, mut seconds, mut tag, mut states) = (vec![], vec![], vec![], vec![], vec![]);
        for (number, shard) in (0_u32..).zip(&new.shards).filter(|(number, _)| !is_finished(*number)) {
            tasks.push(number.cast_signed());
            entries.push(i32::try_from(shard.entries).unwrap_or(i32::MAX));
            seconds.push(order::microseconds(shard) as f64 * 1e-6);
            tag.push(tags[number as usize]);
            states.push("waiting");
        }
        tasks.push(i32::try_from(new.shards.len()).unwrap_or(i32::MAX));
        entries.push(0);
        seconds.push(0.0);
        tag.push(tags[new.shards.len()]);
        states.push("blocked");
        let insert = transaction.prepare_cached(TASKS).await?;
        transaction.execute(&insert, &[&submission, &fitter, &tasks, &tag, &entries, &seconds, &states]).await?;
        Self::unblock(transaction, &[submission]).await?;
        Ok(true)
    }
}
