//! Stores results of shards, and ends jobs.

use deadpool_postgres::GenericClient;

use super::{PostgresQueue, jobs};
use crate::{
    queue::{JobState, Lease, LeaseError, StaleLease},
    store::{Batch, StoreError, apply, seal_result, unseal_result},
};
use ltcforge_files::digest::Digest;

/// Number of results that are read at a time.
const PAGE: i32 = 256;

/// Stores results. A result that is already stored under the same lease is accepted again, because the response to the
/// first attempt may have been lost.
const COMPLETE: &str = "
    UPDATE ltcforge.tasks AS t SET state = 'finished', result = g.result, lease_until = NULL
    FROM (
        SELECT DISTINCT ON (submission, task, lease) *
        FROM unnest($1::bigint[], $2::integer[], $3::bigint[], $4::bytea[]) WITH ORDINALITY
            AS g (submission, task, lease, result, n)
        ORDER BY submission, task, lease, n
    ) AS g
    WHERE t.submission = g.submission AND t.task = g.task AND t.lease = g.lease AND NOT t.is_assembly
        AND (t.state = 'leased' OR t.state = 'finished' AND t.result = g.result)
    RETURNING g.n - 1";

/// Sets assemblies to waiting. This runs after shards are committed, so the worker that finishes the last shard sees
/// that all shards are finished.
const UNBLOCK: &str = "
    UPDATE ltcforge.tasks AS t SET state = 'waiting' WHERE t.submission = ANY ($1) AND t.state = 'blocked' AND NOT EXISTS (
        SELECT FROM ltcforge.tasks AS s
        WHERE s.submission = t.submission AND s.state IN ('waiting', 'leased') AND NOT s.is_assembly
    )";

const RESULTS: &str = "
    SELECT task, result FROM ltcforge.tasks
    WHERE submission = $1 AND task >= $2 AND task < $3 AND state = 'finished' AND result IS NOT NULL ORDER BY task";

/// Sets lost shards back to waiting, and the assembly to blocked. `$1` submission, `$2` lost shards, `$3` the assembly.
const LOSE: &str = "
    UPDATE ltcforge.tasks SET state = CASE WHEN is_assembly THEN 'blocked' ELSE 'waiting' END, result = NULL,
        lease_until = NULL, lease = NULL
    WHERE submission = $1 AND (task = ANY ($2) AND state = 'finished' OR task = $3)";

impl PostgresQueue {
    /// Sets the assembly of each job to waiting if all its shards are finished.
    pub(super) async fn unblock(client: &impl GenericClient, submissions: &[i64]) -> Result<(), tokio_postgres::Error> {
        client.execute(&client.prepare_cached(UNBLOCK).await?, &[&submissions]).await.map(drop)
    }

    pub(super) fn store_results(&self, done: &[(Lease, Vec<u8>)]) -> Result<Vec<Result<(), StaleLease>>, StoreError> {
        let (submissions, tasks, numbers): (Vec<_>, Vec<_>, Vec<_>) =
            done.iter().map(|(lease, _)| Self::fence(lease)).collect();
        let results: Vec<_> = done.iter().map(|(_, result)| seal_result(result)).collect();
        let rows = self.database.run(async |client| {
            let statement = client.prepare_cached(COMPLETE).await?;
            let rows = client.query(&statement, &[&submissions, &tasks, &numbers, &results]).await?;
            Self::unblock(&*client, &submissions).await?;
            Ok(rows)
        })?;
        let mut answers = vec![Err(StaleLease); done.len()];
        for row in &rows {
            answers[row.get::<_, i64>(0) as usize] = Ok(());
        }
        Ok(answers)
    }

    pub(super) fn read_results(&self, lease: &Lease) -> Result<Vec<Vec<u8>>, LeaseError> {
        let (submission, shards, _) = Self::fence(lease);
        if self.database.run(async |client| Ok(Self::current(&*client, lease).await?))? != Some(true) {
            return Err(StaleLease.into());
        }
        let (mut results, mut lost) = (vec![], vec![]);
        for from in (0..shards).step_by(PAGE as usize) {
            let to = shards.min(from + PAGE);
            let page = self.database.run(async |client| {
                Ok(client.query(&client.prepare_cached(RESULTS).await?, &[&submission, &from, &to]).await?)
            })?;
            let mut rows = page.iter().peekable();
            for shard in from..to {
                let row = rows.next_if(|row| row.get::<_, i32>(0) == shard);
                match row.and_then(|row| unseal_result(row.get(1))) {
                    Some(result) => results.push(result),
                    None => lost.push(shard),
                }
            }
        }
        if lost.is_empty() {
            return Ok(results);
        }
        let is_put_back = self.database.run(async |client| {
            let transaction = client.transaction().await?;
            if jobs::lock_open(&transaction, submission).await?.is_none()
                || Self::current(&transaction, lease).await?.is_none()
            {
                return Ok(false);
            }
            let lose = transaction.prepare_cached(LOSE).await?;
            transaction.execute(&lose, &[&submission, &lost, &shards]).await?;
            transaction.commit().await?;
            Ok(true)
        })?;
        if !is_put_back {
            return Err(StaleLease.into());
        }
        tracing::warn!(submission, ?lost, "results of shards are lost or damaged; they are fitted again");
        Err(LeaseError::Lost(lost.len()))
    }

    pub(super) fn finish_job(&self, lease: &Lease, table: Digest, rows: &Batch) -> Result<(), LeaseError> {
        let (submission, ..) = Self::fence(lease);
        let is_done = self.database.run(async |client| {
            let transaction = client.transaction().await?;
            if jobs::lock_open(&transaction, submission).await?.is_none() {
                // The response to an earlier attempt may have been lost.
                let done = "SELECT FROM ltcforge.jobs WHERE submission = $1 AND table_digest = $2";
                let done = transaction.prepare_cached(done).await?;
                return Ok(transaction.query_opt(&done, &[&submission, &table.as_bytes().as_slice()]).await?.is_some());
            }
            if Self::current(&transaction, lease).await? != Some(true) {
                return Ok(false);
            }
            apply(&transaction, rows).await?;
            jobs::end(&transaction, submission, &JobState::Done { table }, None).await?;
            transaction.commit().await?;
            Ok(true)
        })?;
        if is_done { Ok(()) } else { Err(StaleLease.into()) }
    }
}
