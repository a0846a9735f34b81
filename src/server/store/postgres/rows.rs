//! [`Rows`] in PostgreSQL: the catalogue, which small tables of sled's kind suffice for.

use std::sync::Arc;

use deadpool_postgres::GenericClient;

use super::Database;
use crate::server::store::{Batch, Row, Rows, StoreError, Tree};

/// Rows in a table of PostgreSQL.
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
            Ok(rows.iter().map(|row| Row { key: row.get(0), value: Some(row.get(1)) }).collect())
        })
    }
}

/// Applies a batch in the transaction of `client`.
pub(crate) async fn apply(client: &impl GenericClient, batch: &Batch) -> Result<(), tokio_postgres::Error> {
    // The last change of a key is the one that counts.
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

/// The first key after all that begin with `prefix`; `None` if there is none.
fn end_of(prefix: &[u8]) -> Option<Vec<u8>> {
    let last = prefix.iter().rposition(|byte| *byte < u8::MAX)?;
    let mut end = prefix[..=last].to_vec();
    end[last] += 1;
    Some(end)
}

impl Rows for PostgresRows {
    fn get(&self, tree: Tree, key: &[u8]) -> Result<Option<Vec<u8>>, StoreError> {
        let statement = "SELECT key, value FROM ltcforge.rows WHERE tree = $1 AND key = $2 LIMIT $3";
        Ok(self.rows(statement, tree, key, 1)?.pop().and_then(|row| row.value))
    }

    fn scan(&self, tree: Tree, prefix: &[u8]) -> Result<Vec<Row>, StoreError> {
        let from = "SELECT key, value FROM ltcforge.rows WHERE tree = $1 AND key >= $2 ORDER BY key LIMIT $3";
        let mut rows = self.rows(from, tree, prefix, i64::MAX)?;
        if let Some(end) = end_of(prefix) {
            rows.retain(|row| row.key < end);
        }
        Ok(rows)
    }

    fn page(&self, tree: Tree, before: Option<&[u8]>, limit: usize) -> Result<Vec<Row>, StoreError> {
        let limit = i64::try_from(limit).unwrap_or(i64::MAX);
        match before {
            Some(before) => {
                let below =
                    "SELECT key, value FROM ltcforge.rows WHERE tree = $1 AND key < $2 ORDER BY key DESC LIMIT $3";
                self.rows(below, tree, before, limit)
            }
            None => {
                let all = "SELECT key, value FROM ltcforge.rows WHERE tree = $1 AND $2::bytea IS NOT NULL
                    ORDER BY key DESC LIMIT $3";
                self.rows(all, tree, &[], limit)
            }
        }
    }

    fn commit(&self, batch: &Batch) -> Result<(), StoreError> {
        self.database.run(async |client| {
            let transaction = client.transaction().await?;
            apply(&transaction, batch).await?;
            transaction.commit().await
        })
    }

    fn stage(&self, batch: &Batch) -> Result<(), StoreError> {
        self.commit(batch)
    }
}

#[cfg(test)]
mod tests {
    use super::{super::test_database, *};

    #[test]
    fn rows_are_found_by_key_by_prefix_and_in_order() {
        let Some(database) = test_database::database() else { return };
        let rows = PostgresRows::new(database);
        let mut batch = Batch::default();
        for key in [b"a\xff".as_slice(), b"a\xff\xff", b"b", b""] {
            batch.put(Tree::Tables, key, key);
        }
        batch.put(Tree::Recipes, "a", "another tree's");
        rows.commit(&batch).unwrap();
        let keys = |rows: Vec<Row>| rows.into_iter().map(|row| row.key).collect::<Vec<_>>();
        assert_eq!(rows.get(Tree::Tables, b"b").unwrap().unwrap(), b"b");
        assert_eq!(rows.get(Tree::Tables, b"a").unwrap(), None);
        assert_eq!(keys(rows.scan(Tree::Tables, b"a\xff").unwrap()), [b"a\xff".as_slice(), b"a\xff\xff"]);
        assert_eq!(keys(rows.scan(Tree::Tables, b"").unwrap()).len(), 4);
        assert_eq!(keys(rows.page(Tree::Tables, None, 2).unwrap()), [b"b".as_slice(), b"a\xff\xff"]);
        assert_eq!(keys(rows.page(Tree::Tables, Some(b"a\xff\xff"), 9).unwrap()), [b"a\xff".as_slice(), b""]);
        let mut batch = Batch::default();
        batch.put(Tree::Tables, "b", "once");
        batch.put(Tree::Tables, "b", "twice");
        batch.remove(Tree::Tables, "");
        rows.commit(&batch).unwrap();
        assert_eq!(rows.get(Tree::Tables, b"b").unwrap().unwrap(), b"twice");
        assert_eq!(rows.get(Tree::Tables, b"").unwrap(), None);
    }
}
