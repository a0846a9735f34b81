//! Taking over the jobs of another queue.

use super::{
    deliver::seal,
    failing,
    open::PostgresQueue,
    submit::{INSERT_REST, INSERT_TASKS, shards_of},
};
use crate::server::{
    queue::{Job, JobState},
    store::StoreError,
};

const IMPORT: &str = "
    INSERT INTO ltcforge.jobs (submission, id, recipe_digest, recipe, fitter, shards, shards_digest, entries_total,
        state, table_digest, failure, entries_done, attempts, created_at, started_at, finished_at)
    VALUES (nextval('ltcforge.submissions'), $1, $2, $3, $4, $5, $6, $7, $8, $9, $10, $11, $12, $13, $14, $15)
    ON CONFLICT (recipe_digest) DO NOTHING RETURNING submission";

const FINISHED: &str = "
    UPDATE ltcforge.tasks AS t SET state = 'finished', result = g.result
    FROM unnest($2::integer[], $3::bytea[]) AS g (task, result)
    WHERE t.submission = $1 AND t.task = g.task AND NOT t.is_assembly";

impl PostgresQueue {
    /// Takes a job over with its finished shards, in one transaction. Returns whether it was not known before. The limit of
    /// jobs does not count.
    ///
    /// # Errors
    /// When the database fails.
    pub fn import(&self, job: &Job, shard_entries: &[u32], finished: &[(u32, Vec<u8>)]) -> Result<bool, StoreError> {
        let is_open = !job.state.name().is_final();
        let keeps_tasks = is_open || matches!(job.state, JobState::Failed { .. });
        let (entries, shards_digest) = shards_of(shard_entries);
        let (table, failure) = match &job.state {
            JobState::Done { table } => (Some(table.as_bytes().to_vec()), None),
            JobState::Failed { error } => {
                (None, Some(serde_json::to_string(error).map_err(|error| StoreError::Database(error.to_string()))?))
            }
            JobState::Queued | JobState::Running | JobState::Cancelled => (None, None),
        };
        let state = match &job.state {
            // Nobody works on it here.
            JobState::Queued | JobState::Running => "queued",
            JobState::Done { .. } => "done",
            JobState::Failed { .. } => "failed",
            JobState::Cancelled => "cancelled",
        };
        let (id, digest) = (job.id.as_bytes().as_slice(), job.recipe_digest.as_bytes().as_slice());
        let (fitter, shards) =
            (self.shared.process.fitter.cast_signed(), i32::try_from(entries.len()).unwrap_or(i32::MAX));
        let (total, entries_done) =
            (job.entries_total.cast_signed(), (!is_open).then_some(job.entries_done.cast_signed()));
        let attempts = (!is_open).then_some(job.attempts.cast_signed());
        let started_at = job.started_at.filter(|_| !is_open);
        let tasks: Vec<i32> = finished.iter().map(|(task, _)| task.cast_signed()).collect();
        let results: Vec<Vec<u8>> = finished.iter().map(|(_, result)| seal(result)).collect();
        let is_new = self.shared.database.run(async |client| {
            let transaction = client.transaction().await?;
            let row = transaction
                .query_opt(
                    IMPORT,
                    &[
                        &id,
                        &digest,
                        &job.recipe,
                        &fitter,
                        &shards,
                        &shards_digest.as_bytes().as_slice(),
                        &total,
                        &state,
                        &table,
                        &failure,
                        &entries_done,
                        &attempts,
                        &job.created_at,
                        &started_at,
                        &job.finished_at,
                    ],
                )
                .await?;
            let Some(row) = row else { return Ok(false) };
            let submission: i64 = row.get(0);
            if keeps_tasks {
                transaction.execute(INSERT_TASKS, &[&submission, &entries]).await?;
                transaction.execute(FINISHED, &[&submission, &tasks, &results]).await?;
                transaction.execute(INSERT_REST, &[&submission, &shards, &format!("begin {}", job.id)]).await?;
                if !is_open {
                    failing::remove_tasks(&transaction, submission, true).await?;
                }
            }
            transaction.commit().await?;
            Ok(true)
        })?;
        Ok(is_new)
    }
}
