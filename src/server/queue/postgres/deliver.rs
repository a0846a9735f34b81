//! Results of shards, and the table that is assembled from them.

use super::{PostgresQueue, jobs};
use crate::{
    queue::{JobState, Lease, LeaseError, StaleLease},
    store::{Batch, StoreError, apply},
};
use ltcforge_files::digest::Digest;

/// Rows to which a job's finished entries are added. A connection adds to one of them.
const SLOTS: i32 = 8;

/// Results read at a time.
const PAGE: i32 = 256;

/// Bytes of the hash in front of a stored result.
const SEAL_BYTES: usize = 8;

/// If a lease is there twice, its first result counts.
pub(super) const COMPLETE: &str = "
    WITH done AS (
        UPDATE ltcforge.tasks AS t
        SET state = 'finished', result = g.result, lease_until = NULL, worker = NULL, last_error = NULL
        FROM (
            SELECT DISTINCT ON (submission, task, worker) *
            FROM unnest($1::bigint[], $2::integer[], $3::text[], $4::bytea[]) WITH ORDINALITY
                AS g (submission, task, worker, result, n)
            ORDER BY submission, task, worker, n
        ) AS g
        WHERE t.submission = g.submission AND t.task = g.task AND t.worker = g.worker AND NOT t.is_assembly
            AND t.lease_until > (SELECT ltcforge.clock())
        RETURNING g.n, t.submission, t.entries
    ), counted AS (
        INSERT INTO ltcforge.finished_entries AS f (submission, slot, entries)
        SELECT submission, pg_backend_pid() % $5, sum(entries) FROM done GROUP BY submission ORDER BY submission
        ON CONFLICT (submission, slot) DO UPDATE SET entries = f.entries + excluded.entries
    )
    SELECT n - 1 FROM done";

const RESULTS: &str = "
    SELECT task, result FROM ltcforge.tasks
    WHERE submission = $1 AND task >= $2 AND task < $3 AND state = 'finished' AND result IS NOT NULL ORDER BY task";

pub(super) fn seal(result: &[u8]) -> Vec<u8> {
    [&Digest::of(result).as_bytes()[..SEAL_BYTES], result].concat()
}

fn unseal(sealed: &[u8]) -> Option<&[u8]> {
    let (hash, result) = sealed.split_at_checked(SEAL_BYTES)?;
    (hash == &Digest::of(result).as_bytes()[..SEAL_BYTES]).then_some(result)
}

impl PostgresQueue {
    pub(super) fn store_results(&self, done: &[(Lease, &[u8])]) -> Result<Vec<Result<(), StaleLease>>, StoreError> {
        let (submissions, tasks, names): (Vec<_>, Vec<_>, Vec<_>) =
            done.iter().map(|(lease, _)| self.process.fence(lease)).collect();
        let results: Vec<Vec<u8>> = done.iter().map(|(_, result)| seal(result)).collect();
        let rows = self.database.run(async |client| {
            let statement = client.prepare_cached(COMPLETE).await?;
            Ok(client.query(&statement, &[&submissions, &tasks, &names, &results, &SLOTS]).await?)
        })?;
        let mut answers = vec![Err(StaleLease); done.len()];
        for row in &rows {
            if let Some(answer) = usize::try_from(row.get::<_, i64>(0)).ok().and_then(|n| answers.get_mut(n)) {
                *answer = Ok(());
            }
        }
        for (lease, _) in done {
            self.held.remove(lease);
        }
        // An assembly may be available now.
        self.changes.note(None);
        Ok(answers)
    }

    pub(super) fn read_results(&self, lease: &Lease, take: &mut dyn FnMut(&[u8])) -> Result<bool, LeaseError> {
        let (submission, shards, _) = self.process.fence(lease);
        let mut lost = vec![];
        for from in (0..shards).step_by(PAGE as usize) {
            let to = shards.min(from + PAGE);
            let page = self.database.run(async |client| {
                if self.process.is_of_assembly(client, lease).await? != Some(true) {
                    return Ok(None);
                }
                let statement = client.prepare_cached(RESULTS).await?;
                Ok(Some(client.query(&statement, &[&submission, &from, &to]).await?))
            })?;
            let page = page.ok_or(StaleLease)?;
            let mut rows = page.iter().peekable();
            for shard in from..to {
                let row = rows.next_if(|row| row.get::<_, i32>(0) == shard);
                match row.and_then(|row| unseal(row.get(1))) {
                    Some(result) => take(result),
                    None => lost.push(shard),
                }
            }
        }
        if !lost.is_empty() {
            self.put_back(lease, Some(&format!("the results of shards {lost:?} are lost or damaged")), &lost)?;
        }
        Ok(lost.is_empty())
    }

    pub(super) fn finish_job(&self, lease: &Lease, table: Digest, with: &Batch) -> Result<(), LeaseError> {
        let (submission, ..) = self.process.fence(lease);
        let done = self.database.run(async |client| {
            let transaction = client.transaction().await?;
            let Some(job) = jobs::lock_open(&transaction, submission).await? else { return Ok(None) };
            if self.process.is_of_assembly(&transaction, lease).await? != Some(true) {
                return Ok(None);
            }
            apply(&transaction, with).await?;
            jobs::end(&transaction, submission, job, &JobState::Done { table }).await?;
            transaction.commit().await?;
            Ok(Some(job))
        })?;
        self.held.remove(lease);
        self.changes.note(Some(done.ok_or(StaleLease)?));
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_damaged_result_is_told_from_a_whole_one() {
        let sealed = seal(b"result");
        assert_eq!(unseal(&sealed).unwrap(), b"result");
        for at in 0..sealed.len() {
            let mut damaged = sealed.clone();
            damaged[at] ^= 1;
            assert_eq!(unseal(&damaged), None);
        }
        assert_eq!(unseal(b"short"), None);
    }
}
