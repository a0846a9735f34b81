//! The catalogue compared with the blobs, both ways.

use std::{fs, sync::Arc};

use jiff::Timestamp;

use super::{
    super::{Reconciled, TableRow, reconcile::reconcile},
    fake_backend::FakeBackend,
};
use crate::store::{Batch, Catalogue, Store, Tree};
use ltcforge_files::digest::Digest;

const TABLE: &[u8] = b"TABLE gold 1 0";

/// A store with the table, and its row, which is not in the catalogue yet.
fn store() -> (tempfile::TempDir, Store, TableRow) {
    let dir = tempfile::tempdir().unwrap();
    let store = Store::open(dir.path()).unwrap();
    let digest = store.blobs.put(TABLE).unwrap();
    let created_at = Timestamp::from_second(1_000_000).unwrap();
    let row = TableRow { digest, recipe_digest: Digest::of(b"gold 1"), bytes: TABLE.len() as u64, created_at };
    (dir, store, row)
}

fn reconciled(store: &Store) -> Reconciled {
    reconcile(&store.rows, store.blobs.as_ref(), &FakeBackend(Arc::default())).unwrap()
}

fn listed(store: &Store) -> Vec<TableRow> {
    Catalogue::new(Arc::clone(&store.rows)).page(None, 9).unwrap().0
}

#[test]
fn a_table_that_the_catalogue_lacks_is_added() {
    let (_dir, store, row) = store();
    store.blobs.put(b"no table").unwrap();
    assert_eq!(reconciled(&store), Reconciled { added: vec![row.digest], lost: vec![] });
    let found = listed(&store);
    assert_eq!(found.iter().map(|found| (found.digest, found.bytes)).collect::<Vec<_>>(), [(row.digest, row.bytes)]);
    let recipe = Catalogue::new(Arc::clone(&store.rows)).recipe(row.recipe_digest).unwrap();
    assert_eq!(recipe, Some(("gold 1".to_owned(), row.digest)));
    assert_eq!(reconciled(&store), Reconciled::default(), "it is complete now");
}

#[test]
fn a_table_that_has_lost_one_of_its_rows_is_completed_with_its_age() {
    for tree in [Tree::Tables, Tree::TablesByAge, Tree::Recipes] {
        let (_dir, store, row) = store();
        store.rows.commit(&Catalogue::entry(&row, "gold 1").unwrap()).unwrap();
        assert_eq!(reconciled(&store), Reconciled::default());
        let mut batch = Batch::default();
        for found in store.rows.scan(tree, &[]).unwrap() {
            batch.remove(tree, found.key);
        }
        store.rows.commit(&batch).unwrap();
        assert_eq!(reconciled(&store).added, [row.digest], "{tree:?}");
        let found = listed(&store);
        assert_eq!(found.len(), 1, "{tree:?}: {found:?}");
        // Without its own row, the age is that of the file.
        assert_eq!(found[0].created_at == row.created_at, tree != Tree::Tables, "{tree:?}");
    }
}

#[test]
fn a_table_without_its_file_is_taken_out_of_the_catalogue() {
    let (dir, store, row) = store();
    store.rows.commit(&Catalogue::entry(&row, "gold 1").unwrap()).unwrap();
    let hex = row.digest.hex();
    fs::remove_file(dir.path().join("blobs").join(&hex[..2]).join(&hex)).unwrap();
    assert_eq!(reconciled(&store), Reconciled { added: vec![], lost: vec![row.digest] });
    for tree in [Tree::Tables, Tree::TablesByAge, Tree::Recipes] {
        assert!(store.rows.scan(tree, &[]).unwrap().is_empty(), "{tree:?}");
    }
}

#[test]
fn a_damaged_table_is_not_added() {
    let (dir, store, row) = store();
    let hex = row.digest.hex();
    fs::write(dir.path().join("blobs").join(&hex[..2]).join(&hex), "noise").unwrap();
    assert_eq!(reconciled(&store), Reconciled::default());
    assert!(listed(&store).is_empty());
}
