//! Looking jobs up, listing and counting them.

use jiff::Timestamp;
use tokio_postgres::Row;

use super::shared::Shared;
use crate::{
    queue::{Failure, FailureKind, Job, JobId, JobPage, JobState, StateName},
    store::StoreError,
};
use ltcforge_files::digest::Digest;

/// The columns of a job as [`job`] reads them.
pub(super) const COLUMNS: &str = "
    SELECT submission, id, recipe, recipe_digest, state, table_digest, failure, entries_total,
        coalesce(entries_done, least(entries_total, coalesce((
            SELECT sum(f.entries)::bigint FROM ltcforge.finished_entries AS f WHERE f.submission = jobs.submission), 0) + coalesce((
            SELECT sum(t.entries_reported)::bigint FROM ltcforge.tasks AS t
            WHERE t.submission = jobs.submission AND t.state = 'leased'), 0))) AS entries_now,
        coalesce(attempts, greatest(CASE WHEN started_at IS NULL THEN 0 ELSE 1 END, (
            SELECT max(t.attempt) FROM ltcforge.tasks AS t
            WHERE t.submission = jobs.submission AND t.attempt > 1))) AS attempts_now,
        created_at, started_at, finished_at, (SELECT ltcforge.clock()) AS now
    FROM ltcforge.jobs";

/// The job of a row of [`COLUMNS`].
pub(super) fn job(row: &Row) -> Result<Job, StoreError> {
    let wrong = |column: &str| StoreError::Database(format!("a job's {column} cannot be read"));
    let digest = |column: &str| -> Result<Digest, StoreError> {
        let bytes: Option<&[u8]> = row.get(column);
        let bytes: Option<[u8; 32]> = bytes.and_then(|bytes| bytes.try_into().ok());
        bytes.map(Digest::from_bytes).ok_or_else(|| wrong(column))
    };
    let state = match row.get("state") {
        "queued" => JobState::Queued,
        "running" => JobState::Running,
        "done" => JobState::Done { table: digest("table_digest")? },
        "failed" => {
            let text: Option<&str> = row.get("failure");
            let unknown = |text: &str| Failure { kind: FailureKind::Storage, detail: text.to_owned() };
            let text = text.unwrap_or_default();
            JobState::Failed { error: serde_json::from_str(text).unwrap_or_else(|_| unknown(text)) }
        }
        "cancelled" => JobState::Cancelled,
        _ => return Err(wrong("state")),
    };
    Ok(Job {
        id: JobId::from_slice(row.get("id")).ok_or_else(|| wrong("id"))?,
        recipe: row.get("recipe"),
        recipe_digest: digest("recipe_digest")?,
        state,
        entries_total: row.get::<_, i64>("entries_total").cast_unsigned(),
        entries_done: row.get::<_, i64>("entries_now").cast_unsigned(),
        attempts: row.get::<_, i32>("attempts_now").cast_unsigned(),
        created_at: row.get::<_, Timestamp>("created_at"),
        started_at: row.get("started_at"),
        finished_at: row.get("finished_at"),
    })
}

impl Shared {
    pub(super) fn job(&self, id: JobId) -> Result<Option<Job>, StoreError> {
        Ok(self.job_now(id)?.map(|(job, _)| job))
    }

    /// With the database's time, which is the same for all processes.
    pub(super) fn job_now(&self, id: JobId) -> Result<Option<(Job, Timestamp)>, StoreError> {
        let row = self.database.run(async |client| {
            let statement = client.prepare_cached(&format!("{COLUMNS} WHERE id = $1")).await?;
            client.query_opt(&statement, &[&id.as_bytes().as_slice()]).await
        })?;
        row.map(|row| Ok((job(&row)?, row.get("now")))).transpose()
    }

    pub(super) fn list(
        &self,
        wanted: Option<StateName>,
        before: Option<u64>,
        limit: usize,
    ) -> Result<JobPage, StoreError> {
        let before = before.map_or(i64::MAX, |before| i64::try_from(before).unwrap_or(i64::MAX));
        let rows_wanted = i64::try_from(limit.saturating_add(1)).unwrap_or(i64::MAX);
        let rows = self.database.run(async |client| {
            let Some(state) = wanted else {
                let all = format!("{COLUMNS} WHERE submission < $1 ORDER BY submission DESC LIMIT $2");
                return client.query(&client.prepare_cached(&all).await?, &[&before, &rows_wanted]).await;
            };
            let of_state = format!("{COLUMNS} WHERE state = $3 AND submission < $1 ORDER BY submission DESC LIMIT $2");
            client.query(&client.prepare_cached(&of_state).await?, &[&before, &rows_wanted, &state.text()]).await
        })?;
        let page = &rows[..limit.min(rows.len())];
        let next =
            page.last().filter(|_| rows.len() > limit).map(|row| row.get::<_, i64>("submission").cast_unsigned());
        Ok((page.iter().map(job).collect::<Result<_, _>>()?, next))
    }

    pub(super) fn counts(&self) -> Result<Vec<(StateName, u64)>, StoreError> {
        let rows = self.database.run(async |client| {
            let count = "SELECT state, count(*) FROM ltcforge.jobs GROUP BY state";
            client.query(&client.prepare_cached(count).await?, &[]).await
        })?;
        let count = |state: StateName| {
            let row = rows.iter().find(|row| row.get::<_, &str>(0) == state.text());
            (state, row.map_or(0, |row| row.get::<_, i64>(1).cast_unsigned()))
        };
        Ok(StateName::ALL.map(count).to_vec())
    }

    /// The database's time; this machine's if the database does not answer.
    pub(super) fn now(&self) -> Timestamp {
        let asked =
            self.database.run(async |client| Ok(client.query_one("SELECT ltcforge.clock()", &[]).await?.get(0)));
        asked.unwrap_or_else(|_| Timestamp::now())
    }

    pub(super) fn first_unfinished(&self) -> Result<Option<Job>, StoreError> {
        let row = self.database.run(async |client| {
            let first = format!("{COLUMNS} WHERE state IN ('queued', 'running') ORDER BY submission LIMIT 1");
            client.query_opt(&client.prepare_cached(&first).await?, &[]).await
        })?;
        row.as_ref().map(job).transpose()
    }
}
