//! [`Rows`] in PostgreSQL. One table contains all keys and values.

use std::sync::Arc;

use deadpool_postgres::GenericClient;

use super::Database;
use crate::store::{Batch, Row, Rows, StoreError, Tree, seal};

/// Rows in a PostgreSQL table.
#[derive(Debug)]
pub struct PostgresRows {
    database: Arc<Database>,
}

impl PostgresRows {
    /// The rows in `database`.
    #[must_use]
    pub fn new(database: Arc<Database>) -> Self {
        Self { database }
    }

    fn rows(&self, statement: &str, tree: Tree, key: &[u8], limit: i64) -> Result<Vec<Row>, StoreError> {
        self.database.run(async |client| {
            let statement = client.prepare_cached(statement).await?;
            let rows = client.query(&statement, &[&tree.name(), &key, &limit]).await?;
            Ok(rows.iter().map(|row| (row.get(0), row.get(1))).collect())
        })
    }
}

/// Applies a batch in the transaction of `client`.
pub(crate) async fn apply(client: &impl GenericClient, batch: &Batch) -> Result<(), tokio_postgres::Error> {
    // The order matters, because the last change of a key wins.
    for (tree, key, value) in &batch.changes {
        if let Some(value) = value {
            let put = "INSERT INTO ltcforge.rows (tree, key, value) VALUES ($1, $2, $3)
                ON CONFLICT (tree, key) DO UPDATE SET value = excluded.value";
            client.execute(&client.prepare_cached(put).await?, &[&tree.name(), key, value]).await?;
        } else {
            let remove = "DELETE FROM ltcforge.rows WHERE tree = $1 AND key = $2";
            client.execute(&client.prepare_cached(remove).await?, &[&tree.name(), key]).await?;
        }
    }
    Ok(())
}

/// Puts a hash in front of a shard's result, as it is stored in a task.
pub(crate) fn seal_result(result: &[u8]) -> Vec<u8> {
    seal::seal(Tree::Results.name(), &[], result)
}

/// The inverse of [`seal_result`]. `None` if the hash does not match.
pub(crate) fn unseal_result(sealed: &[u8]) -> Option<Vec<u8>> {
    seal::unseal(Tree::Results.name(), &[], sealed)
}

impl Rows for PostgresRows {
    fn get(&self, tree: Tree, key: &[u8]) -> Result<Option<Vec<u8>>, StoreError> {
        let statement = "SELECT key, value FROM ltcforge.rows WHERE tree = $1 AND key = $2 LIMIT $3";
        Ok(self.rows(statement, tree, key, 1)?.pop().map(|(_, value)| value))
    }

    fn scan(&self, tree: Tree, prefix: &[u8]) -> Result<Vec<Row>, StoreError> {
        let scan = "SELECT key, value FROM ltcforge.rows
            WHERE tree = $1 AND key >= $2 AND substring(key FOR octet_length($2)) = $2 ORDER BY key LIMIT $3";
        self.rows(scan, tree, prefix, i64::MAX)
    }

    fn page(&self, tree: Tree, before: Option<&[u8]>, limit: usize) -> Result<Vec<Row>, StoreError> {
        let limit = i64::try_from(limit).unwrap_or(i64::MAX);
        let Some(before) = before else {
            let all = "SELECT key, value FROM ltcforge.rows WHERE tree = $1 AND $2::bytea IS NOT NULL
                ORDER BY key DESC LIMIT $3";
            return self.rows(all, tree, &[], limit);
        };
        let below = "SELECT key, value FROM ltcforge.rows WHERE tree = $1 AND key < $2 ORDER BY key DESC LIMIT $3";
        self.rows(below, tree, before, limit)
    }

    fn commit(&self, batch: &Batch) -> Result<(), StoreError> {
        self.database.run(async |client| {
            let transaction = client.transaction().await?;
            apply(&transaction, batch).await?;
            Ok(transaction.commit().await?)
        })
    }

    fn fault(&self) -> Option<String> {
        self.database.fault()
    }
}
