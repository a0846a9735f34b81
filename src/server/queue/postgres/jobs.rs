//! Reads the rows of jobs, and ends jobs.

use deadpool_postgres::{GenericClient, Transaction};
use jiff::Timestamp;
use tokio_postgres::{
    Row,
    types::{FromSql, ToSql},
};

use super::PostgresQueue;
use crate::{
    queue::{Job, JobId, JobState},
    store::StoreError,
};
use ltcforge_files::digest::Digest;

/// Selects jobs. Entries and attempts of an unfinished job are computed from its tasks.
const SELECT: &str = "
    SELECT submission, id, recipe, recipe_digest, state, table_digest, failure, entries_total, created_at, started_at,
        finished_at, submitted_by, cancelled_by,
        coalesce(entries_done, (
            SELECT sum(CASE t.state WHEN 'finished' THEN t.entries ELSE least(t.entries_reported, t.entries) END)
            FROM ltcforge.tasks AS t WHERE t.submission = jobs.submission AND NOT t.is_assembly
        )::bigint, 0) AS entries_done,
        coalesce(attempts, (SELECT max(leases) FROM ltcforge.tasks AS t WHERE t.submission = jobs.submission), 0)
            AS attempts
    FROM ltcforge.jobs WHERE ";

/// Ends a job. `$1` submission, `$2` state, `$3` table, `$4` failure, `$5` the name of the token that cancels the job.
const END: &str = "
    UPDATE ltcforge.jobs AS j SET state = $2, table_digest = $3, failure = $4, cancelled_by = $5,
        finished_at = ltcforge.clock(),
        entries_done = CASE $2 WHEN 'done' THEN j.entries_total ELSE (
            SELECT coalesce(sum(t.entries) FILTER (WHERE t.state = 'finished'), 0)
            FROM ltcforge.tasks AS t WHERE t.submission = $1 AND NOT t.is_assembly
        ) END,
        attempts = (SELECT coalesce(max(t.leases), 0) FROM ltcforge.tasks AS t WHERE t.submission = $1)
    WHERE j.submission = $1";

fn damaged(reason: &str) -> StoreError {
    StoreError::Database(format!("a job's row cannot be read: {reason}"))
}

/// Reads a column of a row. An unexpected value is an error.
fn column<'a, T: FromSql<'a>>(row: &'a Row, name: &str) -> Result<T, StoreError> {
    row.try_get(name).map_err(|error| damaged(&error.to_string()))
}

/// Reads a digest from a column.
pub(super) fn digest(bytes: &[u8]) -> Result<Digest, StoreError> {
    bytes.try_into().map(Digest::from_bytes).map_err(|_| damaged("a digest has 32 bytes"))
}

/// Reads a job's id from a column.
pub(super) fn id(bytes: &[u8]) -> Result<JobId, StoreError> {
    JobId::from_slice(bytes).ok_or_else(|| damaged("an id has 16 bytes"))
}

fn job(row: &Row) -> Result<(u64, Job), StoreError> {
    let state = match column(row, "state")? {
        "queued" => JobState::Queued,
        "running" => JobState::Running,
        "done" => JobState::Done { table: digest(column(row, "table_digest")?)? },
        "failed" => {
            let error = serde_json::from_str(column(row, "failure")?);
            JobState::Failed { error: error.map_err(|error| damaged(&error.to_string()))? }
        }
        "cancelled" => JobState::Cancelled,
        other => return Err(damaged(other)),
    };
    let job = Job {
        id: id(column(row, "id")?)?,
        recipe: column(row, "recipe")?,
        recipe_digest: digest(column(row, "recipe_digest")?)?,
        state,
        entries_total: column::<i64>(row, "entries_total")?.cast_unsigned(),
        entries_done: column::<i64>(row, "entries_done")?.cast_unsigned(),
        attempts: column::<i32>(row, "attempts")?.cast_unsigned(),
        created_at: column::<Timestamp>(row, "created_at")?,
        started_at: column(row, "started_at")?,
        finished_at: column(row, "finished_at")?,
        submitted_by: column(row, "submitted_by")?,
        cancelled_by: column(row, "cancelled_by")?,
    };
    Ok((column::<i64>(row, "submission")?.cast_unsigned(), job))
}

/// The jobs that meet the condition `filter`.
pub(super) async fn select(
    client: &impl GenericClient,
    filter: &str,
    parameters: &[&(dyn ToSql + Sync)],
) -> Result<Vec<(u64, Job)>, StoreError> {
    let statement = client.prepare_cached(&format!("{SELECT}{filter}")).await?;
    client.query(&statement, parameters).await?.iter().map(job).collect()
}

/// Locks the row of an unfinished job. `None` if the job has ended.
pub(super) async fn lock_open(client: &Transaction<'_>, submission: i64) -> Result<Option<()>, tokio_postgres::Error> {
    let open = "SELECT FROM ltcforge.jobs WHERE submission = $1 AND state IN ('queued', 'running') FOR UPDATE";
    Ok(client.query_opt(&client.prepare_cached(open).await?, &[&submission]).await?.map(drop))
}

/// Ends a locked job. Only a failed job keeps its finished shards.
pub(super) async fn end(
    client: &Transaction<'_>,
    submission: i64,
    state: &JobState,
    by: Option<&str>,
) -> Result<(), StoreError> {
    let (table, failure) = match state {
        JobState::Done { table } => (Some(table.as_bytes().as_slice()), None),
        JobState::Failed { error } => {
            // PostgreSQL does not allow NUL characters in a text. JSON escapes them, so the error is stored as JSON.
            (None, Some(serde_json::to_string(error).map_err(|error| damaged(&error.to_string()))?))
        }
        _ => (None, None),
    };
    let statement = client.prepare_cached(END).await?;
    client.execute(&statement, &[&submission, &state.name().text(), &table, &failure, &by]).await?;
    let tasks = "DELETE FROM ltcforge.tasks WHERE submission = $1 AND NOT ($2 AND state = 'finished')";
    let keeps = matches!(state, JobState::Failed { .. });
    client.execute(&client.prepare_cached(tasks).await?, &[&submission, &keeps]).await?;
    Ok(())
}

impl PostgresQueue {
    /// The jobs that meet the condition `filter`, with their submissions.
    pub(super) fn jobs(&self, filter: &str, parameters: &[&(dyn ToSql + Sync)]) -> Result<Vec<(u64, Job)>, StoreError> {
        self.database.run(async |client| select(&*client, filter, parameters).await)
    }

    pub(super) fn cancel_job(&self, id: JobId, by: Option<&str>) -> Result<(), StoreError> {
        self.database.run(async |client| {
            let transaction = client.transaction().await?;
            let open =
                "SELECT submission FROM ltcforge.jobs WHERE id = $1 AND state IN ('queued', 'running') FOR UPDATE";
            let open = transaction.prepare_cached(open).await?;
            let Some(row) = transaction.query_opt(&open, &[&id.as_bytes().as_slice()]).await? else { return Ok(()) };
            end(&transaction, row.get(0), &JobState::Cancelled, by).await?;
            Ok(transaction.commit().await?)
        })
    }
}
