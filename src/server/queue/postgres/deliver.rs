//! What a worker delivers under a lease: results, the table, a task unfinished.

use std::collections::HashMap;

use tokio_postgres::Row;

use super::{
    failing,
    fence::{Fences, IS_CURRENT, fence},
    shared::Shared,
};
use crate::{
    queue::{Lease, LeaseError, StaleLease},
    store::{Batch, StoreError, apply},
};
use ltcforge_files::digest::Digest;

/// Rows to which a job's finished entries are added. A connection adds to one of them.
const SLOTS: i32 = 8;

/// Results read at a time.
const RESULTS: i64 = 256;

/// Bytes of the hash in front of a stored result.
const SEAL_BYTES: usize = 8;

pub(super) const COMPLETE: &str = "
    WITH done AS (
        UPDATE ltcforge.tasks AS t
        SET state = 'finished', result = g.result, lease_until = NULL, worker = NULL, last_error = NULL
        FROM unnest($1::bigint[], $2::integer[], $3::integer[], $4::bytea[]) WITH ORDINALITY
            AS g (submission, task, attempt, result, place)
        WHERE t.submission = g.submission AND t.task = g.task AND t.attempt = g.attempt AND NOT t.is_assembly
            AND t.lease_until > (SELECT ltcforge.clock())
        RETURNING g.place, t.submission, t.entries
    ), counted AS (
        INSERT INTO ltcforge.finished_entries AS f (submission, slot, entries)
        SELECT submission, pg_backend_pid() % $5, sum(entries) FROM done GROUP BY submission ORDER BY submission
        ON CONFLICT (submission, slot) DO UPDATE SET entries = f.entries + excluded.entries
    )
    SELECT place FROM done";

const FINISH: &str = "
    UPDATE ltcforge.jobs SET state = 'done', table_digest = $2, finished_at = (SELECT ltcforge.clock()),
        started_at = coalesce(started_at, (SELECT ltcforge.clock())), entries_done = entries_total,
        attempts = ltcforge_attempts
    WHERE submission = $1";

pub(super) fn seal(result: &[u8]) -> Vec<u8> {
    [&Digest::of(result).as_bytes()[..SEAL_BYTES], result].concat()
}

fn unseal(sealed: &[u8]) -> Option<Vec<u8>> {
    let (hash, result) = sealed.split_at_checked(SEAL_BYTES)?;
    (hash == &Digest::of(result).as_bytes()[..SEAL_BYTES]).then(|| result.to_vec())
}

impl Shared {
    pub(super) fn complete(&self, done: &[(Lease, &[u8])]) -> Result<Vec<Result<(), StaleLease>>, StoreError> {
        let mut places = HashMap::new();
        let mut once: Vec<(Lease, Vec<u8>)> = Vec::with_capacity(done.len());
        for (at, (lease, result)) in done.iter().enumerate() {
            places.entry(*lease).or_insert_with(|| {
                once.push((*lease, seal(result)));
                at
            });
        }
        let fences = Fences::of(once.iter().map(|(lease, _)| lease));
        let results: Vec<&[u8]> = once.iter().map(|(_, result)| result.as_slice()).collect();
        let rows = self.database.run(async |client| {
            let statement = client.prepare_cached(COMPLETE).await?;
            let Fences { submissions, tasks, attempts } = &fences;
            client.query(&statement, &[submissions, tasks, attempts, &results, &SLOTS]).await
        })?;
        let mut answers = vec![Err(StaleLease); done.len()];
        for row in &rows {
            let at = usize::try_from(row.get::<_, i64>(0) - 1).ok().and_then(|at| once.get(at));
            if let Some(answer) = at.and_then(|(lease, _)| answers.get_mut(*places.get(lease)?)) {
                *answer = Ok(());
            }
        }
        for (lease, _) in &once {
            self.held.remove(lease);
        }
        // An assembly may be available now.
        self.note_change(None);
        Ok(answers)
    }

    pub(super) fn results(&self, lease: &Lease, take: &mut dyn FnMut(&[u8])) -> Result<bool, LeaseError> {
        let (submission, task, attempt) = fence(lease);
        let (mut from, mut lost) = (0, Vec::new());
        while from < task {
            let page: Option<Vec<Row>> = self.database.run(async |client| {
                if client
                    .query_opt(IS_CURRENT, &[&submission, &task, &attempt])
                    .await?
                    .is_none_or(|row| !row.get::<_, bool>(0))
                {
                    return Ok(None);
                }
                let read = "SELECT task, state = 'finished', result FROM ltcforge.tasks
                    WHERE submission = $1 AND task >= $2 AND NOT is_assembly ORDER BY task LIMIT $3";
                Ok(Some(client.query(&client.prepare_cached(read).await?, &[&submission, &from, &RESULTS]).await?))
            })?;
            let page = page.ok_or(StaleLease)?;
            if page.is_empty() {
                return Err(StoreError::Database(format!("tasks of submission {submission} are missing")).into());
            }
            for row in page {
                if row.get::<_, i32>(0) != from {
                    return Err(
                        StoreError::Database(format!("task {from} of submission {submission} is missing")).into()
                    );
                }
                let sealed = row.get::<_, bool>(1).then(|| row.get::<_, Option<&[u8]>>(2)).flatten();
                match sealed.and_then(unseal) {
                    Some(result) => take(&result),
                    None => lost.push(from),
                }
                from += 1;
            }
        }
        if lost.is_empty() {
            return Ok(true);
        }
        failing::lose_results(self, lease, &lost)?;
        Ok(false)
    }

    pub(super) fn finish(&self, lease: &Lease, table: Digest, with: &Batch) -> Result<(), LeaseError> {
        let (submission, task, attempt) = fence(lease);
        let done = self.database.run(async |client| {
            let transaction = client.transaction().await?;
            let Some(id) = failing::lock_open_job(&transaction, submission).await? else { return Ok(None) };
            let current = transaction.query_opt(IS_CURRENT, &[&submission, &task, &attempt]).await?;
            if current.is_none_or(|row| !row.get::<_, bool>(0)) {
                return Ok(None);
            }
            apply(&transaction, with).await?;
            let finish = FINISH.replace("ltcforge_attempts", failing::ATTEMPTS);
            transaction.execute(&finish, &[&submission, &table.as_bytes().as_slice()]).await?;
            failing::remove_tasks(&transaction, submission, false).await?;
            failing::notify_end(&transaction, submission, &id).await?;
            transaction.commit().await?;
            Ok(Some(id))
        })?;
        self.held.remove(lease);
        self.note_change(Some(done.ok_or(StaleLease)?));
        Ok(())
    }

    pub(super) fn give_back(&self, lease: &Lease) -> Result<(), StaleLease> {
        let (submission, task, attempt) = fence(lease);
        let given = self.database.run(async |client| {
            let give_back = "
                WITH given AS (
                    UPDATE ltcforge.tasks SET state = 'waiting', lease_until = NULL, worker = NULL, entries_reported = 0
                    WHERE submission = $1 AND task = $2 AND attempt = $3
                        AND lease_until > (SELECT ltcforge.clock())
                    RETURNING submission
                )
                SELECT pg_notify('ltcforge', 'work') FROM given";
            Ok(!client
                .query(&client.prepare_cached(give_back).await?, &[&submission, &task, &attempt])
                .await?
                .is_empty())
        });
        self.held.remove(lease);
        match given {
            Ok(true) => {
                self.note_change(None);
                Ok(())
            }
            Ok(false) => Err(StaleLease),
            Err(error) => {
                tracing::warn!(%error, "a task could not be given back; its lease will expire");
                Err(StaleLease)
            }
        }
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
