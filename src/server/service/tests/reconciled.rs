//! The catalogue compared with the blobs, both ways.

use std::{fs, num::NonZeroU32, sync::Arc, time::Duration};

use jiff::Timestamp;

use super::{
    super::{Reconciled, TableRow, check, reconcile::reconcile},
    fake_backend::FakeBackend,
};
use crate::{
    queue::{
        Limits, NewJob, Queue as _,
        embedded::{Clock, EmbeddedQueue},
    },
    store::{Batch, Catalogue, Store, Tree},
};
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
    assert_eq!(reconciled(&store), Reconciled { added: vec![row.digest], ..Reconciled::default() });
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
    assert_eq!(reconciled(&store), Reconciled { lost: vec![row.digest], ..Reconciled::default() });
    for tree in [Tree::Tables, Tree::TablesByAge, Tree::Recipes] {
        assert!(store.rows.scan(tree, &[]).unwrap().is_empty(), "{tree:?}");
    }
}

/// A table's recipe and one of a job.
#[test]
fn a_tabulated_brdf_that_recipes_name_and_that_is_missing_is_told() {
    let (dir, store, row) = store();
    let brdfs = [b"of a table".as_slice(), b"of a job"].map(|brdf| store.blobs.put(brdf).unwrap());
    let recipes = brdfs.map(|brdf| format!(r#"{{"tabulated":"{brdf}"}}"#));
    store.rows.commit(&Catalogue::entry(&row, &recipes[0]).unwrap()).unwrap();
    let limits = Limits {
        jobs: 9,
        lease_ttl: Duration::from_secs(60),
        max_attempts: NonZeroU32::MIN,
        keep_ended: None,
        most_ended: None,
    };
    let queue = EmbeddedQueue::open(Arc::clone(&store.rows), limits, Clock::system()).unwrap();
    let recipe_digest = Digest::of(recipes[1].as_bytes());
    let new = NewJob { recipe: recipes[1].clone(), recipe_digest, shard_entries: vec![1], by: None };
    queue.submit(new, &|_| false).unwrap();
    drop(queue);
    assert_eq!(reconciled(&store), Reconciled::default());
    for brdf in brdfs {
        let hex = brdf.hex();
        fs::remove_file(dir.path().join("blobs").join(&hex[..2]).join(&hex)).unwrap();
    }
    let mut missing = brdfs.to_vec();
    missing.sort();
    assert_eq!(reconciled(&store).missing_brdfs, missing);
    drop(store);
    let report = check(dir.path()).unwrap();
    assert_eq!(report.catalogue.missing_brdfs, missing);
    assert!(!report.is_clean());
}

#[test]
fn a_fifo_in_the_place_of_a_table_is_a_missing_table() {
    let (dir, store, row) = store();
    store.rows.commit(&Catalogue::entry(&row, "gold 1").unwrap()).unwrap();
    let hex = row.digest.hex();
    let path = dir.path().join("blobs").join(&hex[..2]).join(&hex);
    fs::remove_file(&path).unwrap();
    rustix::fs::mknodat(rustix::fs::CWD, &path, rustix::fs::FileType::Fifo, rustix::fs::Mode::RUSR, 0).unwrap();
    drop(store);
    assert_eq!(check(dir.path()).unwrap().catalogue.lost, [row.digest]);
    assert_eq!(reconciled(&Store::open(dir.path()).unwrap()).lost, [row.digest]);
}

#[test]
fn a_damaged_table_is_not_added() {
    let (dir, store, row) = store();
    let hex = row.digest.hex();
    fs::write(dir.path().join("blobs").join(&hex[..2]).join(&hex), "noise").unwrap();
    assert_eq!(reconciled(&store), Reconciled::default());
    assert!(listed(&store).is_empty());
}
