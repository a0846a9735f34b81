//! [`Rows`] in PostgreSQL: the catalogue, as keys and values in one table.

use std::sync::Arc;

use deadpool_postgres::GenericClient;

use super::Database;
use crate::store::{Batch, Condition, Row, Rows, Staged, StoreError, Tree};

/// Number of the advisory lock under which conditions hold: «retain» in ASCII.
const LOCK: i64 = 0x7265_7461_696e;

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

    /// Whether the totals, which a trigger keeps, count the tables that there are.
    ///
    /// # Errors
    /// When the database fails.
    pub fn totals_agree(&self) -> Result<bool, StoreError> {
        self.database.run(async |client| {
            let agree = "SELECT (SELECT coalesce(sum(tables), 0) FROM ltcforge.totals)
                = (SELECT count(*) FROM ltcforge.rows WHERE tree = $1)";
            Ok(client.query_one(&client.prepare_cached(agree).await?, &[&Tree::Tables.name()]).await?.get(0))
        })
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
    // In order: the last change of a key counts.
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

impl Rows for PostgresRows {
    fn get(&self, tree: Tree, key: &[u8]) -> Result<Option<Vec<u8>>, StoreError> {
        let statement = "SELECT key, value FROM ltcforge.rows WHERE tree = $1 AND key = $2 LIMIT $3";
        Ok(self.rows(statement, tree, key, 1)?.pop().and_then(|row| row.value))
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

    fn totals(&self) -> Result<Option<(u64, u64)>, StoreError> {
        let row = self.database.run(async |client| {
            let sums = "SELECT coalesce(sum(tables), 0)::bigint, coalesce(sum(bytes), 0)::bigint FROM ltcforge.totals";
            Ok(client.query_one(&client.prepare_cached(sums).await?, &[]).await?)
        })?;
        let [tables, bytes] = [0, 1].map(|column| u64::try_from(row.get::<_, i64>(column)).unwrap_or(0));
        Ok(Some((tables, bytes)))
    }

    fn commit(&self, batch: &Batch) -> Result<(), StoreError> {
        self.database.run(async |client| {
            let transaction = client.transaction().await?;
            apply(&transaction, batch).await?;
            Ok(transaction.commit().await?)
        })
    }

    fn commit_if(&self, conditions: &[Condition], batch: &Batch) -> Result<bool, StoreError> {
        self.database.run(async |client| {
            let transaction = client.transaction().await?;
            transaction.execute("SELECT pg_advisory_xact_lock($1)", &[&LOCK]).await?;
            for condition in conditions {
                let (Condition::There(tree, key) | Condition::NoneBelow(tree, key)) = condition;
                let next = "SELECT key FROM ltcforge.rows WHERE tree = $1 AND key >= $2 ORDER BY key LIMIT 1";
                let next =
                    transaction.query_opt(&transaction.prepare_cached(next).await?, &[&tree.name(), key]).await?;
                let next: Option<&[u8]> = next.as_ref().map(|row| row.get(0));
                let holds = match condition {
                    Condition::There(..) => next == Some(key),
                    Condition::NoneBelow(..) => !next.is_some_and(|next| next.starts_with(key)),
                };
                if !holds {
                    return Ok(false);
                }
            }
            apply(&transaction, batch).await?;
            transaction.commit().await?;
            Ok(true)
        })
    }

    fn stage(&self, batch: &Batch) -> Result<Staged, StoreError> {
        self.commit(batch)?;
        Ok(Staged(0))
    }

    fn settle(&self, _staged: Staged) -> Result<(), StoreError> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::{super::tests::database, *};
    use crate::store::{Catalogue, TableRow};
    use ltcforge_files::digest::Digest;

    #[test]
    fn rows_are_found_by_key_by_prefix_and_in_order() {
        let Some(database) = database() else { return };
        let rows = PostgresRows::new(database);
        let mut batch = Batch::default();
        for key in [b"a\xff".as_slice(), b"a\xff\xff", b"b", b""] {
            batch.put(Tree::Manifests, key, key);
        }
        batch.put(Tree::Recipes, "a", "another tree's");
        rows.commit(&batch).unwrap();
        let keys = |rows: Vec<Row>| rows.into_iter().map(|row| row.key).collect::<Vec<_>>();
        assert_eq!(rows.get(Tree::Manifests, b"b").unwrap().unwrap(), b"b");
        assert_eq!(rows.get(Tree::Manifests, b"a").unwrap(), None);
        assert_eq!(keys(rows.scan(Tree::Manifests, b"a\xff").unwrap()), [b"a\xff".as_slice(), b"a\xff\xff"]);
        assert_eq!(keys(rows.scan(Tree::Manifests, b"").unwrap()).len(), 4);
        assert_eq!(keys(rows.page(Tree::Manifests, None, 2).unwrap()), [b"b".as_slice(), b"a\xff\xff"]);
        assert_eq!(keys(rows.page(Tree::Manifests, Some(b"a\xff\xff"), 9).unwrap()), [b"a\xff".as_slice(), b""]);
        let mut batch = Batch::default();
        batch.put(Tree::Manifests, "b", "once");
        batch.put(Tree::Manifests, "b", "twice");
        batch.remove(Tree::Manifests, "");
        rows.commit(&batch).unwrap();
        assert_eq!(rows.get(Tree::Manifests, b"b").unwrap().unwrap(), b"twice");
        assert_eq!(rows.get(Tree::Manifests, b"").unwrap(), None);
    }

    #[test]
    fn tables_are_counted_as_they_come_change_and_go() {
        let Some(database) = database() else { return };
        let rows: Arc<dyn Rows> = Arc::new(PostgresRows::new(database));
        let catalogue = Catalogue::new(Arc::clone(&rows));
        assert_eq!(catalogue.totals().unwrap(), (0, 0));
        let row = |name: &str, bytes| TableRow {
            digest: Digest::of(name.as_bytes()),
            recipe_digest: Digest::of(name.as_bytes()),
            bytes,
            created_at: jiff::Timestamp::UNIX_EPOCH,
        };
        for (name, bytes) in [("a", 10), ("b", 5), ("b", 7)] {
            rows.commit(&Catalogue::entry(&row(name, bytes), "recipe").unwrap()).unwrap();
        }
        assert_eq!(catalogue.totals().unwrap(), (2, 17));
        assert!(catalogue.forget(Digest::of(b"a")).unwrap());
        assert_eq!(catalogue.totals().unwrap(), (1, 7));
    }
}
