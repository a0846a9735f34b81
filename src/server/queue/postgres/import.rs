//! Taking over the jobs of another queue.

use super::{
    blocks::Blocks,
    deliver::seal,
    failing,
    open::PostgresQueue,
    submit::{INSERT_BLOCKS, INSERT_REST, shards_digest},
};
use crate::{
    queue::{Job, JobState},
    store::StoreError,
};

const IMPORT: &str = "
    INSERT INTO ltcforge.jobs (submission, id, recipe_digest, recipe, fitter, shards, shards_digest, entries_total,
        state, table_digest, failure, entries_done, attempts, created_at, started_at, finished_at)
    VALUES (nextval('ltcforge.submissions'), $1, $2, $3, $4, $5, $6, $7, $8, $9, $10, $11, $12, $13, $14, $15)
    ON CONFLICT (recipe_digest) DO NOTHING RETURNING submission";

const FINISHED: &str = "
    INSERT INTO ltcforge.tasks (submission, task, is_assembly, entries, state, attempt, result)
    SELECT $1, task, false, entries, 'finished', 1, result
    FROM unnest($2::integer[], $3::integer[], $4::bytea[]) AS g (task, entries, result)";

/// Finished shards, as columns for a statement.
#[derive(Debug, Default)]
struct Finished {
    tasks: Vec<i32>,
    entries: Vec<i32>,
    results: Vec<Vec<u8>>,
}

impl PostgresQueue {
    /// Takes a job of a version of the fitter over with its finished shards, in one transaction. Returns whether it was not known before. The limit of
    /// jobs does not count.
    ///
    /// # Errors
    /// When the database fails.
    pub fn import(
        &self,
        job: &Job,
        fitter: u32,
        shard_entries: &[u32],
        finished: &[(u32, Vec<u8>)],
    ) -> Result<bool, StoreError> {
        let is_open = !job.state.name().is_final();
        let keeps_tasks = is_open || matches!(job.state, JobState::Failed { .. });
        let shards_digest = shards_digest(shard_entries);
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
        let (fitter, shards) = (fitter.cast_signed(), i32::try_from(shard_entries.len()).unwrap_or(i32::MAX));
        let (total, entries_done) =
            (job.entries_total.cast_signed(), (!is_open).then_some(job.entries_done.cast_signed()));
        let attempts = (!is_open).then_some(job.attempts.cast_signed());
        let started_at = job.started_at.filter(|_| !is_open);
        let mut kept = Finished::default();
        for (task, result) in finished {
            let Some(entries) = shard_entries.get(*task as usize) else { continue };
            kept.tasks.push(task.cast_signed());
            kept.entries.push(entries.cast_signed());
            kept.results.push(seal(result));
        }
        let Finished { tasks, entries, results } = &kept;
        let blocks = Blocks::of(shard_entries, &finished.iter().map(|(task, _)| *task).collect());
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
                transaction.execute(FINISHED, &[&submission, tasks, entries, results]).await?;
                let Blocks { first, past, entries } = &blocks;
                transaction.execute(INSERT_BLOCKS, &[&submission, first, past, entries]).await?;
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
