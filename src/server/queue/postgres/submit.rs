//! Submitting and cancelling jobs.

use std::collections::HashSet;

use deadpool_postgres::{GenericClient, Transaction};
use tokio_postgres::{Error, Row};

use super::{
    blocks::Blocks,
    failing,
    lookup::{COLUMNS, job},
    shared::Shared,
};
use crate::{
    queue::{Job, JobId, JobState, NewJob, QueueError, Submitted},
    store::StoreError,
};
use ltcforge_files::digest::Digest;

/// Number of the advisory lock under which jobs are submitted: «submit» in ASCII. It makes the limit of jobs exact.
const LOCK: i64 = 0x7375_626d_6974;

const INSERT: &str = "
    INSERT INTO ltcforge.jobs (submission, id, recipe_digest, recipe, fitter, shards, shards_digest, entries_total, state, created_at)
    VALUES ($1, $2, $3, $4, $5, $6, $7, $8, 'queued', (SELECT ltcforge.clock()))";

pub(super) const INSERT_BLOCKS: &str = "
    INSERT INTO ltcforge.blocks (submission, first, next, past, entries)
    SELECT $1, first, first, past, entries FROM unnest($2::integer[], $3::integer[], $4::integer[]) AS b (first, past, entries)";

pub(super) const INSERT_REST: &str = "
    WITH assembly AS (
        INSERT INTO ltcforge.tasks (submission, task, is_assembly, entries, state) VALUES ($1, $2, true, 0, 'waiting')
    ), serving AS (
        INSERT INTO ltcforge.serving (submission, fitter) SELECT submission, fitter FROM ltcforge.jobs WHERE submission = $1
    ), kept AS (
        INSERT INTO ltcforge.finished_entries (submission, slot, entries)
        SELECT $1, 0, coalesce(sum(entries), 0) FROM ltcforge.tasks WHERE submission = $1 AND state = 'finished'
    )
    SELECT pg_notify('ltcforge', $3)";

const KEEP: &str = "
    UPDATE ltcforge.tasks SET submission = $2, attempt = 0, failures = 0, deaths = 0
    WHERE submission = $1 AND state = 'finished' AND NOT is_assembly RETURNING task";

/// The digest of the entries of each shard.
pub(super) fn shards_digest(shard_entries: &[u32]) -> Digest {
    let bytes: Vec<u8> = shard_entries.iter().flat_map(|entries| entries.to_le_bytes()).collect();
    Digest::of(&bytes)
}

/// The job of a recipe as it was before a submission.
enum Former {
    None,
    /// It is unfinished.
    Open(Row),
    /// It ended; its state as stored.
    Ended(Row),
}

impl Former {
    async fn lock(client: &impl GenericClient, id: JobId) -> Result<Self, Error> {
        let row =
            client.query_opt(&format!("{COLUMNS} WHERE id = $1 FOR UPDATE"), &[&id.as_bytes().as_slice()]).await?;
        Ok(match row {
            None => Self::None,
            Some(row) if matches!(row.get("state"), "queued" | "running") => Self::Open(row),
            Some(row) => Self::Ended(row),
        })
    }
}

/// What a transaction has come to.
enum Outcome {
    Queued(Row),
    Joined(Row),
    /// Another process has made its table meanwhile.
    Done,
    Full,
}

impl Shared {
    pub(super) fn submit(&self, new: &NewJob, has_table: &dyn Fn(Digest) -> bool) -> Result<Submitted, QueueError> {
        self.keep_house();
        let id = JobId::of_recipe(&new.recipe_digest);
        loop {
            // Whether the table is stored is asked outside of the transaction, which holds a lock.
            let mut without_table = None;
            if let Some(former) = self.job(id)?
                && let JobState::Done { table } = former.state
            {
                if has_table(table) {
                    return Ok(Submitted::Done(former, table));
                }
                without_table = Some(table);
            }
            let submitted = self.database.run(async |client| {
                let transaction = client.transaction().await?;
                let outcome = self.submit_in(&transaction, id, new, without_table).await?;
                transaction.commit().await?;
                Ok(outcome)
            })?;
            return match submitted {
                Outcome::Queued(row) => {
                    self.note_change(Some(id));
                    Ok(Submitted::Queued(job(&row)?))
                }
                Outcome::Joined(row) => Ok(Submitted::Joined(job(&row)?)),
                Outcome::Full => Err(QueueError::Full { limit: self.limits.jobs }),
                Outcome::Done => continue,
            };
        }
    }

    async fn submit_in(
        &self,
        transaction: &Transaction<'_>,
        id: JobId,
        new: &NewJob,
        without_table: Option<Digest>,
    ) -> Result<Outcome, Error> {
        transaction.execute("SELECT pg_advisory_xact_lock($1)", &[&LOCK]).await?;
        let former = Former::lock(transaction, id).await?;
        match &former {
            Former::Open(row) => return Ok(Outcome::Joined(row.clone())),
            Former::Ended(row) => {
                let table: Option<&[u8]> = row.get("table_digest");
                if table.is_some_and(|table| without_table.is_none_or(|gone| gone.as_bytes() != table)) {
                    return Ok(Outcome::Done);
                }
            }
            Former::None => {}
        }
        let count = "SELECT count(*) FROM ltcforge.jobs WHERE state IN ('queued', 'running')";
        let open: i64 = transaction.query_one(count, &[]).await?.get(0);
        if usize::try_from(open).is_ok_and(|open| open >= self.limits.jobs) {
            return Ok(Outcome::Full);
        }
        let shards_digest = shards_digest(&new.shard_entries);
        let total: i64 = new.shard_entries.iter().copied().map(i64::from).sum();
        let shards = i32::try_from(new.shard_entries.len()).unwrap_or(i32::MAX);
        let mut finished = HashSet::new();
        let submission: i64 = transaction.query_one("SELECT nextval('ltcforge.submissions')", &[]).await?.get(0);
        if let Former::Ended(row) = &former {
            let before: i64 = row.get("submission");
            let removed = "DELETE FROM ltcforge.jobs WHERE submission = $1 RETURNING shards_digest";
            let row = transaction.query_one(removed, &[&before]).await?;
            if row.get::<_, &[u8]>(0) == shards_digest.as_bytes() {
                let kept = transaction.query(KEEP, &[&before, &submission]).await?;
                finished.extend(kept.iter().map(|row| row.get::<_, i32>(0).cast_unsigned()));
            }
            failing::remove_tasks(transaction, before, false).await?;
        }
        let (id_bytes, digest, recipe) =
            (id.as_bytes().as_slice(), new.recipe_digest.as_bytes().as_slice(), &new.recipe);
        let (fitter, shards_digest) = (self.process.fitter.cast_signed(), shards_digest.as_bytes().as_slice());
        transaction
            .execute(INSERT, &[&submission, &id_bytes, &digest, recipe, &fitter, &shards, &shards_digest, &total])
            .await?;
        let Blocks { first, past, entries } = Blocks::of(&new.shard_entries, &finished);
        transaction.execute(INSERT_BLOCKS, &[&submission, &first, &past, &entries]).await?;
        transaction.execute(INSERT_REST, &[&submission, &shards, &format!("begin {id}")]).await?;
        let row = transaction.query_one(&format!("{COLUMNS} WHERE submission = $1"), &[&submission]).await?;
        Ok(Outcome::Queued(row))
    }

    pub(super) fn adopt(&self, done: &Job) -> Result<Job, StoreError> {
        let JobState::Done { table } = done.state else {
            return Err(StoreError::Database("only a done job can be adopted".to_owned()));
        };
        let row = self.database.run(async |client| {
            let transaction = client.transaction().await?;
            transaction.execute("SELECT pg_advisory_xact_lock($1)", &[&LOCK]).await?;
            match Former::lock(&transaction, done.id).await? {
                Former::Open(row) => return Ok(row),
                Former::Ended(row) if row.get::<_, Option<&[u8]>>("table_digest") == Some(table.as_bytes()) => return Ok(row),
                Former::Ended(row) => {
                    let before: i64 = row.get("submission");
                    transaction.execute("DELETE FROM ltcforge.jobs WHERE submission = $1", &[&before]).await?;
                    failing::remove_tasks(&transaction, before, false).await?;
                }
                Former::None => {}
            }
            let adopt = "
                INSERT INTO ltcforge.jobs (submission, id, recipe_digest, recipe, fitter, shards, shards_digest, entries_total,
                    state, table_digest, entries_done, attempts, created_at, started_at, finished_at)
                VALUES (nextval('ltcforge.submissions'), $1, $2, $3, $4, 0, '', $5, 'done', $6, $7, $8, $9, $10, $11)
                RETURNING submission";
            let (id, digest) = (done.id.as_bytes().as_slice(), done.recipe_digest.as_bytes().as_slice());
            let (total, entries_done) = (done.entries_total.cast_signed(), done.entries_done.cast_signed());
            let (fitter, attempts) = (self.process.fitter.cast_signed(), done.attempts.cast_signed());
            let table = table.as_bytes().as_slice();
            let adopted = transaction
                .query_one(adopt, &[
                    &id, &digest, &done.recipe, &fitter, &total, &table, &entries_done, &attempts, &done.created_at,
                    &done.started_at, &done.finished_at,
                ])
                .await?;
            let submission: i64 = adopted.get(0);
            let row = transaction.query_one(&format!("{COLUMNS} WHERE submission = $1"), &[&submission]).await?;
            transaction.commit().await?;
            Ok(row)
        })?;
        self.note_change(Some(done.id));
        job(&row)
    }

    pub(super) fn cancel(&self, id: JobId) -> Result<Option<Job>, StoreError> {
        let cancelled = self.database.run(async |client| {
            let transaction = client.transaction().await?;
            let Former::Open(row) = Former::lock(&transaction, id).await? else { return Ok(None) };
            let submission: i64 = row.get("submission");
            let cancel = format!(
                "UPDATE ltcforge.jobs SET state = 'cancelled', finished_at = (SELECT ltcforge.clock()),
                    attempts = {}, entries_done = (
                        SELECT coalesce(sum(entries), 0) FROM ltcforge.finished_entries AS f
                        WHERE f.submission = jobs.submission)
                WHERE submission = $1",
                failing::ATTEMPTS
            );
            transaction.execute(&cancel, &[&submission]).await?;
            failing::remove_tasks(&transaction, submission, false).await?;
            failing::notify_end(&transaction, submission, &id).await?;
            transaction.commit().await?;
            Ok(Some(submission))
        })?;
        if let Some(submission) = cancelled {
            self.held.lose(submission.cast_unsigned());
            self.note_change(Some(id));
        }
        self.job(id)
    }
}
