//! Changes of the schema in PostgreSQL, each applied once, in order.
//!
//! Invariant: an applied migration never changes; its digest is stored and compared at every start. Each is applied in
//! one transaction under an advisory lock: if many processes start at once, one of them applies it.

use deadpool_postgres::{Client, GenericClient};

use super::failure::DatabaseOpenError;
use ltcforge_files::digest::Digest;

/// All migrations, oldest first: number N is at index N - 1.
pub(super) const ALL: &[&str] = &[
    include_str!("../../migrations/postgres/0001_initial.sql"),
    include_str!("../../migrations/postgres/0002_callers.sql"),
    include_str!("../../migrations/postgres/0003_teams.sql"),
];

/// Number of the advisory lock: «ltcforge» in ASCII.
const LOCK: i64 = 0x6c74_6366_6f72_6765;

const PREPARE: &str = "
    CREATE SCHEMA IF NOT EXISTS ltcforge;
    CREATE TABLE IF NOT EXISTS ltcforge.migrations (
        number integer PRIMARY KEY,
        digest bytea NOT NULL,
        applied_at timestamptz NOT NULL DEFAULT now()
    )";

/// The digests of the migrations that have been applied, in order.
async fn applied(client: &impl GenericClient) -> Result<Vec<Vec<u8>>, tokio_postgres::Error> {
    let is_there = client.query_one("SELECT to_regclass('ltcforge.migrations') IS NOT NULL", &[]).await?;
    if !is_there.get::<_, bool>(0) {
        return Ok(vec![]);
    }
    let rows = client.query("SELECT digest FROM ltcforge.migrations ORDER BY number", &[]).await?;
    Ok(rows.iter().map(|row| row.get(0)).collect())
}

/// How many of `migrations` have been applied.
fn compare(applied: &[Vec<u8>], migrations: &[&str]) -> Result<usize, DatabaseOpenError> {
    if applied.len() > migrations.len() {
        return Err(DatabaseOpenError::FromTheFuture { found: applied.len(), known: migrations.len() });
    }
    let changed =
        applied.iter().zip(migrations).position(|(digest, text)| digest != Digest::of(text.as_bytes()).as_bytes());
    changed.map_or(Ok(applied.len()), |at| Err(DatabaseOpenError::Changed(at + 1)))
}

/// Checks that all `migrations` were applied, and applies none.
pub(super) async fn require(client: &Client, migrations: &[&str]) -> Result<(), DatabaseOpenError> {
    match compare(&applied(client).await?, migrations)? {
        found if found < migrations.len() => Err(DatabaseOpenError::Older { found, needed: migrations.len() }),
        _ => Ok(()),
    }
}

/// Applies those of `migrations` that were not applied yet. If there are none, the role needs no right to change the
/// schema.
pub(super) async fn apply(client: &mut Client, migrations: &[&str]) -> Result<(), DatabaseOpenError> {
    if compare(&applied(&*client).await?, migrations)? == migrations.len() {
        return Ok(());
    }
    let transaction = client.transaction().await?;
    // A migration takes as long as it takes, and so does waiting for another process's.
    transaction.batch_execute("SET LOCAL statement_timeout = 0").await?;
    transaction.execute("SELECT pg_advisory_xact_lock($1)", &[&LOCK]).await?;
    transaction.batch_execute(PREPARE).await?;
    // Another process may have applied some while this one waited.
    let before = compare(&applied(&transaction).await?, migrations)?;
    for (number, text) in (1_i32..).zip(migrations).skip(before) {
        transaction.batch_execute(text).await?;
        let digest = Digest::of(text.as_bytes());
        transaction
            .execute(
                "INSERT INTO ltcforge.migrations (number, digest) VALUES ($1, $2)",
                &[&number, &digest.as_bytes().as_slice()],
            )
            .await?;
        tracing::info!(number, "a migration was applied to the database");
    }
    transaction.commit().await?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::{
        super::tests::{database, throwaway},
        *,
    };

    #[test]
    fn a_newer_database_and_a_changed_migration_are_refused() {
        let Some(database) = database() else { return };
        let refused = |migrations: &[&str]| {
            let done = database.block_on(async {
                let mut client = database.client().await.unwrap();
                apply(&mut client, migrations).await
            });
            done.unwrap_err().to_string()
        };
        let newest = format!("schema {}; this program knows schemas up to 0", ALL.len());
        assert!(refused(&[]).contains(&newest));
        assert!(refused(&[&["SELECT 1"], &ALL[1..]].concat()).contains("migration 1 differs"));
        let half = "CREATE TABLE ltcforge.half (a integer); SELECT 1 / 0";
        refused(&[ALL, &[half]].concat());
        let is_there = database.block_on(async {
            let client = database.client().await.unwrap();
            client.query_one("SELECT to_regclass('ltcforge.half') IS NOT NULL", &[]).await.unwrap().get::<_, bool>(0)
        });
        assert!(!is_there, "a migration that fails leaves nothing");
    }

    #[test]
    fn of_many_that_start_at_once_one_applies_it() {
        let Some(url) = throwaway::empty_database() else { return };
        std::thread::scope(|scope| {
            let open = || super::super::Database::open(&url).map(drop).unwrap();
            let threads: Vec<_> = (0..8).map(|_| scope.spawn(open)).collect();
            for thread in threads {
                thread.join().unwrap();
            }
        });
    }

    /// An applied migration never changes. Add a new file instead, and its digest here.
    #[test]
    fn released_migrations_have_not_changed() {
        let digests: Vec<_> = ALL.iter().map(|text| Digest::of(text.as_bytes()).hex()).collect();
        let released = [
            "92dbb1eea85c1e9dfc071072d229acd134281f56690f58f52d36d165efca78e8",
            "ef89a0c0b09c94d0d0bd292df7c39bb472c7868a88b0f0af40874612f8c7c78b",
            "5321877e9dda5f571eeea98dd3719d2b130aafb3f61e40e1018afdc4ed717ca6",
        ];
        assert_eq!(digests, released);
    }
}
