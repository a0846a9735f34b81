//! Jobs as rows: how they are inserted, read and ended.

use std::num::NonZeroU32;

use deadpool_postgres::{GenericClient, Transaction};
use jiff::Timestamp;
use tokio_postgres::{Error, Row};

use crate::{
    queue::{Claim, Failure, FailureKind, Job, JobId, JobState, Priority},
    store::StoreError,
};
use ltcforge_files::digest::Digest;

/// Entries of the finished shards of the job in `jobs`.
macro_rules! finished_entries {
    () => {
        "coalesce((
            SELECT sum(f.entries)::bigint FROM ltcforge.finished_entries AS f WHERE f.submission = jobs.submission), 0)"
    };
}

/// The highest attempt number among the tasks of the unfinished job in `jobs`.
macro_rules! highest_attempt {
    () => {
        "greatest(CASE WHEN started_at IS NULL THEN 0 ELSE 1 END, (
            SELECT max(t.attempt) FROM ltcforge.tasks AS t WHERE t.submission = jobs.submission AND t.attempt > 1))"
    };
}

/// The columns of a job as [`job`] reads them.
pub(super) const COLUMNS: &str = concat!(
    "SELECT submission, id, recipe, recipe_digest, state, table_digest, failure, entries_total,
        coalesce(entries_done, least(entries_total, ",
    finished_entries!(),
    " + coalesce((
            SELECT sum(t.entries_reported)::bigint FROM ltcforge.tasks AS t
            WHERE t.submission = jobs.submission AND t.state = 'leased'), 0))) AS entries_now,
        coalesce(attempts, ",
    highest_attempt!(),
    ") AS attempts_now, created_at, started_at, finished_at, submitted_by, cancelled_by, team, share, priority, (SELECT ltcforge.clock()) AS now
    FROM ltcforge.jobs"
);

const INSERT: &str = "
    INSERT INTO ltcforge.jobs (submission, id, recipe_digest, recipe, fitter, shards, shards_digest, entries_total,
        state, table_digest, failure, entries_done, attempts, created_at, started_at, finished_at,
        submitted_by, cancelled_by, team, share, priority)
    VALUES (nextval('ltcforge.submissions'), $1, $2, $3, $4, $5, $6, $7, $8, $9, $10, $11, $12, $13, $14, $15,
        $16, $17, $18, $19, $20)
    ON CONFLICT (recipe_digest) DO NOTHING RETURNING submission";

const END: &str = concat!(
    "UPDATE ltcforge.jobs SET state = $2, table_digest = $3, failure = $4, finished_at = (SELECT ltcforge.clock()),
        started_at = CASE WHEN $2 = 'done' THEN coalesce(started_at, (SELECT ltcforge.clock())) ELSE started_at END,
        entries_done = ",
    finished_entries!(),
    ", attempts = ",
    highest_attempt!(),
    " WHERE submission = $1"
);

fn unreadable(column: &str) -> StoreError {
    StoreError::Database(format!("a job's {column} cannot be read"))
}

/// The digest in a column.
pub(super) fn digest(row: &Row, column: &str) -> Result<Digest, StoreError> {
    let bytes = row.get::<_, Option<&[u8]>>(column).and_then(|bytes| bytes.try_into().ok());
    bytes.map(Digest::from_bytes).ok_or_else(|| unreadable(column))
}

/// The job's id in the column `id`.
pub(super) fn job_id(row: &Row) -> Result<JobId, StoreError> {
    JobId::from_slice(row.get("id")).ok_or_else(|| unreadable("id"))
}

/// The job of a row of [`COLUMNS`].
pub(super) fn job(row: &Row) -> Result<Job, StoreError> {
    let state = match row.get("state") {
        "queued" => JobState::Queued,
        "running" => JobState::Running,
        "done" => JobState::Done { table: digest(row, "table_digest")? },
        "failed" => {
            let text: &str = row.get::<_, Option<&str>>("failure").unwrap_or_default();
            let unknown = |_| Failure { kind: FailureKind::Storage, detail: text.to_owned() };
            JobState::Failed { error: serde_json::from_str(text).unwrap_or_else(unknown) }
        }
        "cancelled" => JobState::Cancelled,
        _ => return Err(unreadable("state")),
    };
    Ok(Job {
        id: job_id(row)?,
        recipe: row.get("recipe"),
        recipe_digest: digest(row, "recipe_digest")?,
        state,
        entries_total: row.get::<_, i64>("entries_total").cast_unsigned(),
        entries_done: row.get::<_, i64>("entries_now").cast_unsigned(),
        attempts: row.get::<_, i32>("attempts_now").cast_unsigned(),
        created_at: row.get::<_, Timestamp>("created_at"),
        started_at: row.get("started_at"),
        finished_at: row.get("finished_at"),
        submitted_by: row.get("submitted_by"),
        cancelled_by: row.get("cancelled_by"),
        claim: claim(row)?,
    })
}

fn claim(row: &Row) -> Result<Claim, StoreError> {
    let share = row.get::<_, i32>("share").try_into().ok().and_then(NonZeroU32::new);
    let priority = match row.get::<_, i16>("priority") {
        0 => Priority::Normal,
        low if low < 0 => Priority::Low,
        _ => Priority::High,
    };
    Ok(Claim { team: row.get("team"), share: share.ok_or_else(|| unreadable("share"))?, priority })
}

/// A claim as columns: the share, and the priority.
pub(super) fn claim_columns(claim: &Claim) -> (i32, i16) {
    let priority = match claim.priority {
        Priority::Low => -1,
        Priority::Normal => 0,
        Priority::High => 1,
    };
    (claim.share.get().try_into().unwrap_or(i32::MAX), priority)
}

/// A state as columns: its name, the digest of its table, and its failure.
type StateColumns<'a> = (&'static str, Option<&'a [u8]>, Option<String>);

fn columns(state: &JobState) -> Result<StateColumns<'_>, StoreError> {
    Ok(match state {
        JobState::Done { table } => (state.name().text(), Some(table.as_bytes().as_slice()), None),
        JobState::Failed { error } => {
            let failure = serde_json::to_string(error).map_err(|error| StoreError::Database(error.to_string()))?;
            (state.name().text(), None, Some(failure))
        }
        JobState::Queued | JobState::Running | JobState::Cancelled => (state.name().text(), None, None),
    })
}

/// The digest of the entries of each shard.
pub(super) fn shards_digest(shard_entries: &[u32]) -> Digest {
    let bytes: Vec<u8> = shard_entries.iter().flat_map(|entries| entries.to_le_bytes()).collect();
    Digest::of(&bytes)
}

/// Inserts a job without its tasks, and returns its submission; `None` if there is a job of the same recipe.
pub(super) async fn insert(
    client: &impl GenericClient,
    job: &Job,
    fitter: u32,
    shard_entries: &[u32],
) -> Result<Option<i64>, StoreError> {
    let (state, table, failure) = columns(&job.state)?;
    // Until the job ends, they are computed from its tasks.
    let has_ended = job.state.name().is_final();
    let entries_done = has_ended.then_some(job.entries_done.cast_signed());
    let attempts = has_ended.then_some(job.attempts.cast_signed());
    let (id, digest) = (job.id.as_bytes().as_slice(), job.recipe_digest.as_bytes().as_slice());
    let (shards, shards_digest) =
        (i32::try_from(shard_entries.len()).unwrap_or(i32::MAX), shards_digest(shard_entries));
    let shards_digest = shards_digest.as_bytes().as_slice();
    let (share, priority) = claim_columns(&job.claim);
    let (fitter, entries_total) = (fitter.cast_signed(), job.entries_total.cast_signed());
    let row = client
        .query_opt(
            INSERT,
            &[
                &id,
                &digest,
                &job.recipe,
                &fitter,
                &shards,
                &shards_digest,
                &entries_total,
                &state,
                &table,
                &failure,
                &entries_done,
                &attempts,
                &job.created_at,
                &job.started_at,
                &job.finished_at,
                &job.submitted_by,
                &job.cancelled_by,
                &job.claim.team,
                &share,
                &priority,
            ],
        )
        .await?;
    Ok(row.map(|row| row.get(0)))
}

/// Locks an unfinished job; returns its id.
pub(super) async fn lock_open(client: &Transaction<'_>, submission: i64) -> Result<Option<JobId>, Error> {
    let lock = "SELECT id FROM ltcforge.jobs WHERE submission = $1 AND state IN ('queued', 'running') FOR UPDATE";
    let row = client.query_opt(lock, &[&submission]).await?;
    Ok(row.and_then(|row| JobId::from_slice(row.get(0))))
}

/// Ends a job that is locked, and tells all processes when the transaction is committed. A failed one keeps its
/// finished shards.
pub(super) async fn end(
    client: &Transaction<'_>,
    submission: i64,
    job: JobId,
    state: &JobState,
) -> Result<(), StoreError> {
    let (name, table, failure) = columns(state)?;
    client.execute(END, &[&submission, &name, &table, &failure]).await?;
    remove_tasks(client, submission, matches!(state, JobState::Failed { .. })).await?;
    Ok(notify(client, &format!("end {job} {submission}")).await?)
}

/// Removes the tasks of a job, but not its finished shards if they are to be kept.
pub(super) async fn remove_tasks(client: &Transaction<'_>, submission: i64, keep_finished: bool) -> Result<(), Error> {
    // First the blocks, which waits for transactions that make rows of them: no task comes after that.
    for table in ["blocks", "serving", "finished_entries"] {
        client.execute(&format!("DELETE FROM ltcforge.{table} WHERE submission = $1"), &[&submission]).await?;
    }
    let tasks = "DELETE FROM ltcforge.tasks WHERE submission = $1 AND NOT ($2 AND state = 'finished')";
    client.execute(tasks, &[&submission, &keep_finished]).await.map(drop)
}

/// Tells all processes when the transaction is committed.
pub(super) async fn notify(client: &impl GenericClient, message: &str) -> Result<(), Error> {
    client.execute("SELECT pg_notify('ltcforge', $1)", &[&message]).await.map(drop)
}
