//! Migrations of the schema in PostgreSQL. Each migration is applied once, in order.
//!
//! Invariant: an applied migration never changes. Its digest is stored and compared at every start. Migrations are
//! applied in one transaction under an advisory lock. If many processes start at once, one process applies them.

use deadpool_postgres::{Client, GenericClient};

use crate::store::ConnectError;
use ltcforge_files::digest::Digest;

/// All migrations, oldest first. Migration N has index N - 1.
pub(super) const ALL: &[&str] = &[include_str!("../../migrations/postgres/0001_initial.sql")];

/// The number of the advisory lock, which is `ltcforge` in ASCII.
const LOCK: i64 = 0x6c74_6366_6f72_6765;

/// The error if an unreleased version of this program, or another program, created the schema.
const OTHER: &str = "the schema `ltcforge` in the database is from an unreleased version: use an empty database, or \
    remove the schema with DROP SCHEMA ltcforge CASCADE; it contains no table files";

const PREPARE: &str = "
    CREATE SCHEMA IF NOT EXISTS ltcforge;
    CREATE TABLE IF NOT EXISTS ltcforge.migrations (
        number integer PRIMARY KEY,
        digest bytea NOT NULL,
        applied_at timestamptz NOT NULL DEFAULT now()
    )";

/// The number of applied migrations.
async fn applied(client: &impl GenericClient, migrations: &[&str]) -> Result<usize, ConnectError> {
    let is_there = client.query_one("SELECT to_regclass('ltcforge.migrations') IS NOT NULL", &[]).await?;
    if !is_there.get::<_, bool>(0) {
        return Ok(0);
    }
    let rows = client.query("SELECT digest FROM ltcforge.migrations ORDER BY number", &[]).await?;
    let is_ours =
        |row: &tokio_postgres::Row, text: &str| row.get::<_, &[u8]>(0) == Digest::of(text.as_bytes()).as_bytes();
    if !rows.iter().zip(migrations).all(|(row, text)| is_ours(row, text)) {
        return Err(ConnectError(OTHER.to_owned()));
    }
    if rows.len() > migrations.len() {
        let (found, known) = (rows.len(), migrations.len());
        return Err(ConnectError(format!("the database has schema {found}; this program knows schemas up to {known}")));
    }
    Ok(rows.len())
}

/// Applies the migrations that are not applied yet. If all are applied, the role does not need the right to change
/// the schema.
pub(super) async fn apply(client: &mut Client, migrations: &[&str]) -> Result<(), ConnectError> {
    if applied(&*client, migrations).await? == migrations.len() {
        return Ok(());
    }
    let transaction = client.transaction().await?;
    // A migration, or waiting for another process that applies it, may take longer than the statement timeout.
    transaction.batch_execute("SET LOCAL statement_timeout = 0").await?;
    transaction.execute("SELECT pg_advisory_xact_lock($1)", &[&LOCK]).await?;
    transaction.batch_execute(PREPARE).await?;
    // Another process may have applied migrations while this process waited.
    let before = applied(&transaction, migrations).await?;
    for (number, text) in (1_i32..).zip(migrations).skip(before) {
        transaction.batch_execute(text).await?;
        let digest = Digest::of(text.as_bytes());
        let insert = "INSERT INTO ltcforge.migrations (number, digest) VALUES ($1, $2)";
        transaction.execute(insert, &[&number, &digest.as_bytes().as_slice()]).await?;
        tracing::info!(number, "a migration was applied to the database");
    }
    Ok(transaction.commit().await?)
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
        assert!(refused(&[&["SELECT 1"], &ALL[1..]].concat()).contains("DROP SCHEMA ltcforge CASCADE"));
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
        assert_eq!(digests, ["a49b1fb7e02381919562010f110b1553aa034e583ad925138098ba69d61ea34c"]);
    }
}
