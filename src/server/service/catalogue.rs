//! The catalogue: the rows that describe stored files.
//!
//! The rows can be computed from the files. If a row is missing, a table may be fitted twice, but no table is lost.

use std::sync::Arc;

use jiff::Timestamp;
use serde::{Deserialize, Serialize, de::DeserializeOwned};

use crate::store::{Batch, Rows, StoreError, Tree};
use ltcforge_files::digest::Digest;

/// A table in the list of tables.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct TableRow {
    /// The digest of the table.
    pub digest: Digest,
    /// The digest of the table's recipe.
    pub recipe_digest: Digest,
    /// The size of its file.
    pub bytes: u64,
    /// When it was stored.
    pub created_at: Timestamp,
}

/// A BRDF in the list of BRDFs.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct FileRow {
    /// The digest of the BRDF.
    pub digest: Digest,
    /// The size of its file.
    pub bytes: u64,
    /// When it was stored.
    pub created_at: Timestamp,
}

#[derive(Debug, Serialize, Deserialize)]
struct RecipeRow {
    recipe: String,
    table: Digest,
}

/// A stored manifest. A manifest with another version is computed again.
#[derive(Debug, Serialize, Deserialize)]
struct ManifestRow {
    version: u32,
    text: String,
}

/// The catalogue, stored in a database.
#[derive(Debug, Clone)]
pub(super) struct Catalogue {
    pub(super) rows: Arc<dyn Rows>,
}

impl Catalogue {
    /// The changes that add a table.
    pub(super) fn table_entry(row: &TableRow, recipe: &str) -> Result<Batch, StoreError> {
        let mut batch = Batch::default();
        batch.put(Tree::Tables, *row.digest.as_bytes(), encode(row)?);
        batch.put(Tree::TablesByAge, age_key(row.created_at, row.digest), []);
        let recipe = RecipeRow { recipe: recipe.to_owned(), table: row.digest };
        batch.put(Tree::Recipes, *row.recipe_digest.as_bytes(), encode(&recipe)?);
        Ok(batch)
    }

    /// The change that adds a table's manifest.
    pub(super) fn manifest_entry(table: Digest, version: u32, text: &str) -> Result<Batch, StoreError> {
        let mut batch = Batch::default();
        let row = ManifestRow { version, text: text.to_owned() };
        batch.put(Tree::Manifests, *table.as_bytes(), encode(&row)?);
        Ok(batch)
    }

    /// The change that adds a BRDF.
    pub(super) fn brdf_entry(row: &FileRow) -> Result<Batch, StoreError> {
        let mut batch = Batch::default();
        batch.put(Tree::Brdfs, *row.digest.as_bytes(), encode(row)?);
        Ok(batch)
    }

    /// The manifest of a table, if a manifest with this version is stored.
    pub(super) fn manifest(&self, table: Digest, version: u32) -> Result<Option<String>, StoreError> {
        let row: Option<ManifestRow> = self.read(Tree::Manifests, table.as_bytes())?;
        Ok(row.filter(|row| row.version == version).map(|row| row.text))
    }

    /// The canonical JSON of a recipe, and the digest of its table.
    pub(super) fn recipe(&self, recipe_digest: Digest) -> Result<Option<(String, Digest)>, StoreError> {
        let row: Option<RecipeRow> = self.read(Tree::Recipes, recipe_digest.as_bytes())?;
        Ok(row.map(|row| (row.recipe, row.table)))
    }

    /// The canonical JSON of all recipes that have a table.
    pub(super) fn recipes(&self) -> Result<Vec<String>, StoreError> {
        Ok(self.all::<RecipeRow>(Tree::Recipes)?.into_iter().map(|row| row.recipe).collect())
    }

    /// The row of a table.
    pub(super) fn table(&self, digest: Digest) -> Result<Option<TableRow>, StoreError> {
        self.read(Tree::Tables, digest.as_bytes())
    }

    /// All tables, sorted by digest.
    pub(super) fn tables(&self) -> Result<Vec<TableRow>, StoreError> {
        self.all(Tree::Tables)
    }

    /// All BRDFs, sorted by digest.
    pub(super) fn brdfs(&self) -> Result<Vec<FileRow>, StoreError> {
        self.all(Tree::Brdfs)
    }

    /// Up to `limit` tables after `cursor`, newest first, and the cursor of the next page.
    pub(super) fn page(
        &self,
        cursor: Option<&[u8]>,
        limit: usize,
    ) -> Result<(Vec<TableRow>, Option<Vec<u8>>), StoreError> {
        let keys = self.rows.page(Tree::TablesByAge, cursor, limit.saturating_add(1))?;
        let next = (keys.len() > limit).then(|| keys[..limit].last().map(|(key, _)| key.clone())).flatten();
        let mut tables = Vec::with_capacity(limit.min(keys.len()));
        for (key, _) in keys.iter().take(limit) {
            let Some(digest) = key.get(8..) else { continue };
            let row: Option<TableRow> = self.read(Tree::Tables, digest)?;
            tables.extend(row.filter(|row| age_key(row.created_at, row.digest) == *key));
        }
        Ok((tables, next))
    }

    /// The changes that remove a table or a BRDF.
    pub(super) fn removal(&self, digest: Digest) -> Result<Batch, StoreError> {
        let mut batch = Batch::default();
        batch.remove(Tree::Brdfs, *digest.as_bytes());
        if let Some(row) = self.table(digest)? {
            batch.remove(Tree::Tables, *digest.as_bytes());
            batch.remove(Tree::TablesByAge, age_key(row.created_at, digest));
            batch.remove(Tree::Manifests, *digest.as_bytes());
            if self.recipe(row.recipe_digest)?.is_none_or(|(_, table)| table == digest) {
                batch.remove(Tree::Recipes, *row.recipe_digest.as_bytes());
            }
        }
        Ok(batch)
    }

    fn read<T: DeserializeOwned>(&self, tree: Tree, key: &[u8]) -> Result<Option<T>, StoreError> {
        Ok(self.rows.get(tree, key)?.and_then(|value| serde_json::from_slice(&value).ok()))
    }

    fn all<T: DeserializeOwned>(&self, tree: Tree) -> Result<Vec<T>, StoreError> {
        let rows = self.rows.scan(tree, &[])?;
        Ok(rows.into_iter().filter_map(|(_, value)| serde_json::from_slice(&value).ok()).collect())
    }
}

fn encode(row: &impl Serialize) -> Result<Vec<u8>, StoreError> {
    serde_json::to_vec(row).map_err(|error| StoreError::Database(error.to_string()))
}

/// The key that sorts files by age.
pub(super) fn age_key(stored_at: Timestamp, digest: Digest) -> Vec<u8> {
    let age = u64::try_from(stored_at.as_microsecond()).unwrap_or(0);
    [age.to_be_bytes().as_slice(), digest.as_bytes()].concat()
}
