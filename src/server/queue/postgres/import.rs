//! Importing the jobs of another queue.

use std::collections::HashSet;

use super::{PostgresQueue, deliver::seal, jobs, submit};
use crate::{
    queue::{Job, JobState},
    store::StoreError,
};

const INSERT_FINISHED: &str = "
    INSERT INTO ltcforge.tasks (submission, task, is_assembly, entries, state, attempt, result)
    SELECT $1, task, false, entries, 'finished', 1, result
    FROM unnest($2::integer[], $3::integer[], $4::bytea[]) AS g (task, entries, result)";

impl PostgresQueue {
    /// Imports a job for the workers of a fitter version, with its finished shards, in one transaction. Returns whether
    /// the job is new. The limit of jobs does not apply.
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
        let entries_of = |shard: &u32| shard_entries.get(*shard as usize).map(|entries| entries.cast_signed());
        let kept =
            finished.iter().filter_map(|(shard, result)| Some((shard.cast_signed(), entries_of(shard)?, seal(result))));
        let (tasks, entries, results): (Vec<i32>, Vec<i32>, Vec<Vec<u8>>) = kept.collect();
        let finished: HashSet<i32> = tasks.iter().copied().collect();
        self.database.run(async |client| {
            let transaction = client.transaction().await?;
            let inserted = jobs::insert(&transaction, job, fitter, shard_entries).await?;
            let Some(submission) = inserted else { return Ok(false) };
            if keeps_tasks {
                transaction.execute(INSERT_FINISHED, &[&submission, &tasks, &entries, &results]).await?;
            }
            if is_open {
                submit::insert_tasks(&transaction, submission, job.id, shard_entries, &finished).await?;
            }
            transaction.commit().await?;
            Ok(true)
        })
    }
}
