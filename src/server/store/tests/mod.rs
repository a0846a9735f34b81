//! Tests of the data folder, and rows for tests of other modules.

mod folder;
pub(crate) mod power;
mod small_disk;

use super::{Batch, MemoryRows, Row, Rows, Tree};

/// Rows are found by key, by prefix and in order.
pub(crate) fn rows_behave(rows: &dyn Rows) {
    let mut batch = Batch::default();
    for key in [b"a\xff".as_slice(), b"a\xff\xff", b"b", b""] {
        batch.put(Tree::Manifests, key, key);
    }
    batch.put(Tree::Recipes, "a", "another tree's");
    rows.commit(&batch).unwrap();
    let keys = |rows: Vec<Row>| rows.into_iter().map(|(key, _)| key).collect::<Vec<_>>();
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
fn rows_in_memory_and_in_sled_behave() {
    rows_behave(&MemoryRows::default());
    let dir = tempfile::tempdir().unwrap();
    let store = super::open(dir.path()).unwrap();
    rows_behave(&*store.rows);
    drop(store);
    let store = super::open(dir.path()).unwrap();
    assert_eq!(store.rows.get(Tree::Manifests, b"b").unwrap().unwrap(), b"twice");
    assert_eq!(store.rows.scan(Tree::Manifests, b"").unwrap().len(), 3);
    assert!(store.is_clean && store.rows.fault().is_none());
}
