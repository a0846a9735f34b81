//! The catalogue: which table belongs to which recipe, and the manifests.

use std::{collections::BTreeSet, sync::Arc};

use jiff::Timestamp;
use serde::{Deserialize, Serialize};

use super::{Batch, Rows, StoreError, Tree};
use ltcforge_files::digest::Digest;

/// A table in the catalogue.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct TableRow {
    /// The table.
    pub digest: Digest,
    /// Its recipe.
    pub recipe_digest: Digest,
    /// Size of its file.
    pub bytes: u64,
    /// When it was stored.
    pub created_at: Timestamp,
}

/// A table's manifest, opaque here.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct ManifestRow {
    /// Its version. A manifest of another version than the current one is made again.
    pub version: u32,
    /// The document as it is served.
    pub text: String,
}

#[derive(Debug, Serialize, Deserialize)]
struct RecipeRow {
    recipe: String,
    table: Digest,
}

/// The catalogue of tables. A damaged row counts as absent, so that its table is fitted again.
#[derive(Debug, Clone)]
pub struct Catalogue {
    rows: Arc<dyn Rows>,
}

impl Catalogue {
    /// The catalogue in `rows`.
    #[must_use]
    pub fn new(rows: Arc<dyn Rows>) -> Self {
        Self { rows }
    }

    /// The changes that add a table, for the caller to commit.
    ///
    /// # Errors
    /// When the rows cannot be encoded.
    pub fn entry(row: &TableRow, recipe: &str) -> Result<Batch, StoreError> {
        let mut batch = Batch::default();
        batch.put(Tree::Tables, *row.digest.as_bytes(), encode(row)?);
        batch.put(Tree::TablesByAge, age_key(row.created_at, row.digest), []);
        let recipe = RecipeRow { recipe: recipe.to_owned(), table: row.digest };
        batch.put(Tree::Recipes, *row.recipe_digest.as_bytes(), encode(&recipe)?);
        Ok(batch)
    }

    /// The change that adds a table's manifest, for the caller to commit.
    ///
    /// # Errors
    /// When the row cannot be encoded.
    pub fn manifest_entry(table: Digest, manifest: &ManifestRow) -> Result<Batch, StoreError> {
        let mut batch = Batch::default();
        batch.put(Tree::Manifests, *table.as_bytes(), encode(manifest)?);
        Ok(batch)
    }

    /// The manifest of a table, if it has been made.
    ///
    /// # Errors
    /// When the database fails.
    pub fn manifest(&self, table: Digest) -> Result<Option<ManifestRow>, StoreError> {
        self.read(Tree::Manifests, table.as_bytes())
    }

    /// The canonical JSON and the table of a recipe.
    ///
    /// # Errors
    /// When the database fails.
    pub fn recipe(&self, recipe_digest: Digest) -> Result<Option<(String, Digest)>, StoreError> {
        let row: Option<RecipeRow> = self.read(Tree::Recipes, recipe_digest.as_bytes())?;
        Ok(row.map(|row| (row.recipe, row.table)))
    }

    /// The canonical JSON of all recipes that have a table.
    ///
    /// # Errors
    /// When the database fails.
    pub fn recipes(&self) -> Result<Vec<String>, StoreError> {
        let mut recipes = Vec::new();
        for row in self.rows.scan(Tree::Recipes, &[])? {
            recipes.extend(self.read::<RecipeRow>(Tree::Recipes, &row.key)?.map(|row| row.recipe));
        }
        Ok(recipes)
    }

    /// The row of a table.
    ///
    /// # Errors
    /// When the database fails.
    pub fn table(&self, digest: Digest) -> Result<Option<TableRow>, StoreError> {
        self.read(Tree::Tables, digest.as_bytes())
    }

    /// Up to `limit` tables after `cursor`, newest first; and the cursor of the next page.
    ///
    /// # Errors
    /// When the database fails.
    pub fn page(&self, cursor: Option<&[u8]>, limit: usize) -> Result<(Vec<TableRow>, Option<Vec<u8>>), StoreError> {
        let keys = self.rows.page(Tree::TablesByAge, cursor, limit.saturating_add(1))?;
        let next = (keys.len() > limit).then(|| keys[..limit].last().map(|row| row.key.clone())).flatten();
        let mut tables = Vec::with_capacity(limit.min(keys.len()));
        for row in keys.iter().take(limit) {
            let Some(digest) = row.key.get(8..) else { continue };
            // A table that was lost and found again has another age than it had.
            tables.extend(
                self.read::<TableRow>(Tree::Tables, digest)?
                    .filter(|table| age_key(table.created_at, table.digest) == row.key),
            );
        }
        Ok((tables, next))
    }

    /// The tables that are in the catalogue with all their rows: their own, the one by age, and their recipe's.
    ///
    /// # Errors
    /// When the database fails.
    pub fn complete(&self) -> Result<BTreeSet<Digest>, StoreError> {
        let mut complete = BTreeSet::new();
        for row in self.rows.scan(Tree::Tables, &[])? {
            let row = row.value.and_then(|value| serde_json::from_slice::<TableRow>(&value).ok());
            let Some(row) = row else { continue };
            let is_listed =
                matches!(self.rows.get(Tree::TablesByAge, &age_key(row.created_at, row.digest)), Ok(Some(_)));
            if is_listed && self.recipe(row.recipe_digest)?.is_some() {
                complete.insert(row.digest);
            }
        }
        Ok(complete)
    }

    /// The digests of all tables, as they stand in the database.
    ///
    /// # Errors
    /// When the database fails.
    pub fn keys(&self) -> Result<BTreeSet<Vec<u8>>, StoreError> {
        Ok(self.rows.scan(Tree::Tables, &[])?.into_iter().map(|row| row.key).collect())
    }

    /// Number of tables, and the size of all their files in bytes.
    ///
    /// # Errors
    /// When the database fails.
    pub fn totals(&self) -> Result<(u64, u64), StoreError> {
        if let Some(totals) = self.rows.totals()? {
            return Ok(totals);
        }
        let rows = self.rows.scan(Tree::Tables, &[])?;
        let sizes = rows.iter().filter_map(|row| serde_json::from_slice::<TableRow>(row.value.as_deref()?).ok());
        Ok(sizes.fold((0, 0), |(count, bytes), row| (count + 1, bytes + row.bytes)))
    }

    /// Removes a table, so that its recipe is fitted again. Returns whether it was there.
    ///
    /// # Errors
    /// When the database fails.
    pub fn forget(&self, digest: Digest) -> Result<bool, StoreError> {
        let Some(row) = self.table(digest)? else { return Ok(false) };
        self.rows.commit(&self.removal(&row)?)?;
        Ok(true)
    }

    /// The changes that remove a table, for the caller to commit.
    ///
    /// # Errors
    /// When the database fails.
    pub fn removal(&self, row: &TableRow) -> Result<Batch, StoreError> {
        let mut batch = Batch::default();
        batch.remove(Tree::Tables, *row.digest.as_bytes());
        batch.remove(Tree::TablesByAge, age_key(row.created_at, row.digest));
        if self.recipe(row.recipe_digest)?.is_none_or(|(_, table)| table == row.digest) {
            batch.remove(Tree::Recipes, *row.recipe_digest.as_bytes());
        }
        batch.remove(Tree::Manifests, *row.digest.as_bytes());
        Ok(batch)
    }

    fn read<T: serde::de::DeserializeOwned>(&self, tree: Tree, key: &[u8]) -> Result<Option<T>, StoreError> {
        let value = match self.rows.get(tree, key) {
            Ok(value) => value,
            Err(error @ StoreError::DamagedRow { .. }) => {
                tracing::error!(%error, "the row counts as absent");
                None
            }
            Err(error) => return Err(error),
        };
        Ok(value.and_then(|value| serde_json::from_slice(&value).ok()))
    }
}

fn encode(row: &impl Serialize) -> Result<Vec<u8>, StoreError> {
    serde_json::to_vec(row).map_err(|error| StoreError::Database(error.to_string()))
}

/// The place of a file in a list by age.
#[must_use]
pub fn age_key(stored_at: Timestamp, digest: Digest) -> Vec<u8> {
    let age = u64::try_from(stored_at.as_microsecond()).unwrap_or(0);
    [age.to_be_bytes().as_slice(), digest.as_bytes()].concat()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::store::memory::MemoryRows;

    fn row(n: u8) -> TableRow {
        TableRow {
            digest: Digest::of(&[n]),
            recipe_digest: Digest::of(&[n, n]),
            bytes: 10,
            created_at: Timestamp::from_second(i64::from(n)).unwrap(),
        }
    }

    #[test]
    fn tables_are_listed_newest_first_page_by_page() {
        let rows = Arc::new(MemoryRows::default());
        let catalogue = Catalogue::new(rows.clone());
        for n in 1..=5 {
            rows.commit(&Catalogue::entry(&row(n), "{}").unwrap()).unwrap();
        }
        let (first, next) = catalogue.page(None, 2).unwrap();
        assert_eq!(first, [row(5), row(4)]);
        let (second, next) = catalogue.page(next.as_deref(), 2).unwrap();
        assert_eq!(second, [row(3), row(2)]);
        let (third, next) = catalogue.page(next.as_deref(), 2).unwrap();
        assert_eq!((third.as_slice(), next), ([row(1)].as_slice(), None));
        assert_eq!(catalogue.totals().unwrap(), (5, 50));
    }

    #[test]
    fn a_removed_table_leaves_no_row() {
        let rows = Arc::new(MemoryRows::default());
        let catalogue = Catalogue::new(rows.clone());
        rows.commit(&Catalogue::entry(&row(1), "{}").unwrap()).unwrap();
        let manifest = ManifestRow { version: 3, text: "{}\n".to_owned() };
        assert_eq!(catalogue.manifest(row(1).digest).unwrap(), None);
        rows.commit(&Catalogue::manifest_entry(row(1).digest, &manifest).unwrap()).unwrap();
        assert_eq!(catalogue.manifest(row(1).digest).unwrap(), Some(manifest));
        assert_eq!(catalogue.recipe(row(1).recipe_digest).unwrap(), Some(("{}".to_owned(), row(1).digest)));
        assert!(catalogue.forget(row(1).digest).unwrap());
        assert!(!catalogue.forget(row(1).digest).unwrap());
        assert_eq!(catalogue.recipe(row(1).recipe_digest).unwrap(), None);
        assert_eq!(catalogue.page(None, 9).unwrap().0, []);
        for tree in [Tree::Tables, Tree::TablesByAge, Tree::Recipes, Tree::Manifests] {
            assert_eq!(rows.len(tree), 0);
        }
    }
}
