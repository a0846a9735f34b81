//! Data folders that are damaged, newer, full, in use, or from earlier versions.

use std::{
    fs::{self, File},
    os::unix::fs::FileExt as _,
    path::Path,
    thread,
    time::{Duration, Instant},
};

use super::small_disk::SmallDisk;
use crate::store::{self, Batch, OpenError, Store, StoreError, Tree, migrations, sled_rows::wait_for_release};
use ltcforge_files::digest::Digest;

const BLOB: &[u8] = b"table";

/// Opens a folder. Other tests start processes, and a new process keeps the lock of a closed store for a moment.
fn open(dir: &Path) -> Result<Store, OpenError> {
    let end = Instant::now() + Duration::from_secs(10);
    loop {
        match store::open(dir) {
            Err(OpenError::Locked) if Instant::now() < end => thread::yield_now(),
            opened => return opened,
        }
    }
}

fn batch(tree: Tree, key: &str, value: &[u8]) -> Batch {
    let mut batch = Batch::default();
    batch.put(tree, key, value);
    batch
}

/// A folder with a blob and some rows.
fn fill(dir: &Path) {
    let store = open(dir).unwrap();
    store.blobs.put(BLOB).unwrap();
    for n in 0..20_u8 {
        store.rows.commit(&batch(Tree::Jobs, &format!("job {n}"), &[n; 4000])).unwrap();
    }
}

fn has_blob(store: &Store) -> bool {
    store.blobs.get(Digest::of(BLOB)).unwrap().is_some()
}

/// The number of databases in quarantine.
fn moved(dir: &Path) -> usize {
    let Ok(entries) = fs::read_dir(dir.join("quarantine")) else { return 0 };
    entries.filter(|entry| entry.as_ref().unwrap().file_name().to_string_lossy().starts_with("db-")).count()
}

#[test]
fn a_folder_has_one_user_at_a_time() {
    let dir = tempfile::tempdir().unwrap();
    let store = open(dir.path()).unwrap();
    assert!(matches!(store::open(dir.path()), Err(OpenError::Locked)));
    drop(store);
    assert!(open(dir.path()).unwrap().is_clean);
}

/// Checks that a damaged database is moved to quarantine, or that all its rows are correct.
#[test]
fn flipped_bits_move_the_database_aside_or_change_no_value_and_lose_no_blob() {
    let dir = tempfile::tempdir().unwrap();
    fill(dir.path());
    let whole = fs::read(dir.path().join("db/db")).unwrap();
    let used = whole.iter().rposition(|byte| *byte != 0).unwrap();
    let mut replaced = 0;
    for n in 0..40 {
        let folder = dir.path().join(n.to_string());
        fill(&folder);
        let file = File::options().write(true).open(folder.join("db/db")).unwrap();
        file.write_all_at(&whole, 0).unwrap();
        let at = used * n / 40;
        file.write_all_at(&[whole[at] ^ (1 << (n % 8))], at as u64).unwrap();
        drop(file);
        let store = open(&folder).unwrap();
        assert!(has_blob(&store));
        assert_eq!(moved(&folder), usize::from(!store.is_clean));
        replaced += moved(&folder);
        for (key, value) in store.rows.scan(Tree::Jobs, b"").unwrap() {
            let n: u8 = String::from_utf8(key).unwrap().strip_prefix("job ").unwrap().parse().unwrap();
            assert_eq!(value, [n; 4000]);
        }
        store.rows.commit(&batch(Tree::Jobs, "new", b"job")).unwrap();
    }
    // sled takes some damage for the end of its log. Rows are then missing.
    assert!(replaced > 0);
}

#[test]
fn a_truncated_or_strange_database_is_moved_aside() {
    type Damage = fn(&Path);
    let damages: [Damage; 4] = [
        |db| File::options().write(true).open(db.join("db")).unwrap().set_len(0).unwrap(),
        |db| fs::write(db.join("db"), vec![7; 100_000]).unwrap(),
        |db| fs::remove_file(db.join("db")).unwrap(),
        |db| {
            fs::remove_file(db.join("db")).unwrap();
            fs::create_dir(db.join("db")).unwrap();
        },
    ];
    for (n, damage) in damages.into_iter().enumerate() {
        let dir = tempfile::tempdir().unwrap();
        fill(dir.path());
        damage(&dir.path().join("db"));
        let store = open(dir.path()).unwrap();
        assert!(!store.is_clean && has_blob(&store), "{n}");
        assert_eq!(moved(dir.path()), 1);
        assert_eq!(store.rows.scan(Tree::Jobs, b"").unwrap(), []);
        store.rows.commit(&batch(Tree::Jobs, "new", b"job")).unwrap();
        drop(store);
        let store = open(dir.path()).unwrap();
        assert!(store.is_clean);
        assert_eq!(store.rows.get(Tree::Jobs, b"new").unwrap().unwrap(), b"job");
    }
}

#[test]
fn a_newer_schema_is_refused_and_stays() {
    let dir = tempfile::tempdir().unwrap();
    fill(dir.path());
    wait_for_release(&dir.path().join("db/db"));
    let db = sled::open(dir.path().join("db")).unwrap();
    let next = [migrations::ALL, &[r#"{"about": "x", "steps": []}"#]].concat();
    migrations::apply(&db, false, &next).unwrap();
    drop(db);
    let known = migrations::ALL.len() as u32;
    match open(dir.path()) {
        Err(OpenError::FromTheFuture { found, known: ours }) => assert_eq!((found, ours), (known + 1, known)),
        other => panic!("{other:?}"),
    }
    assert_eq!(moved(dir.path()), 0);
}

#[test]
fn a_database_of_an_unreleased_version_is_moved_aside() {
    let dir = tempfile::tempdir().unwrap();
    fill(dir.path());
    fs::remove_dir_all(dir.path().join("db")).unwrap();
    let db = sled::open(dir.path().join("db")).unwrap();
    migrations::apply(&db, true, &[r#"{"about": "old", "steps": [{"create": "numbered_jobs"}]}"#]).unwrap();
    drop(db);
    let store = open(dir.path()).unwrap();
    assert!(!store.is_clean && has_blob(&store));
    assert_eq!(moved(dir.path()), 1);
}

#[test]
fn from_a_full_disk_blobs_are_read_and_deleted_and_jobs_are_refused() {
    let dir = tempfile::tempdir().unwrap();
    let Some(disk) = SmallDisk::mount(dir.path().join("disk")) else { return };
    let folder = disk.0.join("data");
    fill(&folder);
    disk.fill();
    let store = open(&folder).unwrap();
    assert!(!store.is_clean && store.rows.fault().is_some() && has_blob(&store));
    assert!(matches!(store.blobs.put(&vec![1; 100_000]), Err(StoreError::DiskFull)));
    assert!(matches!(store.rows.commit(&batch(Tree::Jobs, "job", b"new")), Err(StoreError::DiskFull)));
    store.rows.commit(&batch(Tree::Tables, "table", b"row")).unwrap();
    assert_eq!(store.rows.scan(Tree::Tables, b"").unwrap().len(), 1);
    store.blobs.delete(Digest::of(BLOB)).unwrap();
    assert!(!has_blob(&store));
    drop(store);
    disk.make_room();
    let store = open(&folder).unwrap();
    assert!(store.is_clean);
    assert_eq!(store.rows.scan(Tree::Jobs, b"").unwrap().len(), 20);
}
