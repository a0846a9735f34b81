use super::*;
use crate::store::{rows, sled_rows::open_sled, tests::small_disk::SmallDisk};
use ltcforge_files::{digest::Digest, hex::to_hex};

fn one_job(store: &Store) {
    let mut batch = Batch::default();
    batch.put(Tree::Jobs, "key", "job");
    store.rows.commit(&batch).unwrap();
}

#[test]
fn a_folder_is_opened_by_one_at_a_time() {
    let dir = tempfile::tempdir().unwrap();
    let store = Store::open(dir.path()).unwrap();
    assert!(matches!(Store::open(dir.path()), Err(StoreOpenError::Locked)));
    one_job(&store);
    drop(store);
    // A process that another test starts has the lock's file too until it runs its own program.
    let store = loop {
        match Store::open(dir.path()) {
            Err(StoreOpenError::Locked) => std::thread::yield_now(),
            opened => break opened.unwrap(),
        }
    };
    assert_eq!(store.damage, Damage::default());
    assert_eq!(store.rows.get(Tree::Jobs, b"key").unwrap().unwrap(), b"job");
}

#[test]
fn a_file_in_place_of_the_folder_is_unusable() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("file");
    fs::write(&path, "").unwrap();
    assert!(matches!(Store::open(&path), Err(StoreOpenError::Unusable(_))));
}

#[test]
fn a_later_schema_is_refused_and_left_alone() {
    let dir = tempfile::tempdir().unwrap();
    drop(Store::open(dir.path()).unwrap());
    let db = open_sled(&dir.path().join("db")).unwrap();
    db.open_tree("migrations").unwrap().insert(99_u32.to_be_bytes(), b"").unwrap();
    drop(db);
    assert!(matches!(Store::open(dir.path()), Err(StoreOpenError::FromTheFuture { found: 99, known: 6 })));
    assert!(!dir.path().join("quarantine").exists());
}

/// A damage of a file, at a byte.
type Change = fn(&mut Vec<u8>, usize);

/// Bits flipped, pages zeroed and ends cut off all over sled's file, after a clean close and in the state that
/// kill -9 leaves.
#[test]
fn no_damage_to_the_database_concerns_a_job() {
    const JOBS: u32 = 12;
    let dir = tempfile::tempdir().unwrap();
    let (open, killed) = (dir.path().join("open"), dir.path().join("killed"));
    let store = Store::open(&open).unwrap();
    for n in 0..JOBS {
        let mut batch = Batch::default();
        batch.put(Tree::Jobs, n.to_be_bytes(), n.to_string());
        batch.put(Tree::Results, n.to_be_bytes(), vec![n as u8; 600]);
        store.rows.commit(&batch).unwrap();
    }
    files::copy_folder(&open, &killed).unwrap();
    drop(store);
    // There is a snapshot after a second start.
    drop(Store::open(&open).unwrap());
    let (mut damaged, mut noticed) = (0, 0);
    for from in [&open, &killed] {
        let whole = fs::read(from.join("db/db")).unwrap();
        let used = whole.iter().rposition(|byte| *byte != 0).unwrap_or_default() + 1;
        let changes: [Change; 3] = [
            |bytes, at| bytes[at] ^= 0x10,
            |bytes, at| bytes.iter_mut().skip(at).take(4096).for_each(|byte| *byte = 0),
            |bytes, at| bytes.truncate(at),
        ];
        for (step, change) in (0..16).flat_map(|step| changes.map(|change| (step, change))) {
            let (mut bytes, at) = (whole.clone(), used * step / 16);
            change(&mut bytes, at);
            let copy = dir.path().join("copy");
            files::copy_folder(from, &copy).unwrap();
            fs::write(copy.join("db/db"), bytes).unwrap();
            let store = Store::open(&copy).unwrap();
            for n in 0..JOBS {
                let found = store.rows.get(Tree::Jobs, &n.to_be_bytes()).unwrap();
                assert_eq!(found.unwrap(), n.to_string().as_bytes(), "damage at {at}");
                // A shard's result is right or absent.
                let result = store.rows.get(Tree::Results, &n.to_be_bytes());
                assert!(result.is_ok_and(|found| found.is_none_or(|found| found == vec![n as u8; 600])));
            }
            damaged += 1;
            noticed += usize::from(store.damage != Damage::default());
            drop(store);
            fs::remove_dir_all(copy).unwrap();
        }
    }
    assert!(noticed > damaged / 4, "only {noticed} of {damaged} damages concerned a row");
}

/// The journal is right: a job that was cancelled or done does not come back as queued.
#[test]
fn an_older_database_beside_the_journal_reverts_nothing() {
    let dir = tempfile::tempdir().unwrap();
    let (folder, older) = (dir.path().join("data"), dir.path().join("older"));
    let store = Store::open(&folder).unwrap();
    one_job(&store);
    files::copy_folder(&folder.join("db"), &older).unwrap();
    let mut batch = Batch::default();
    batch.put(Tree::Jobs, "key", "cancelled");
    batch.put(Tree::Jobs, "new", "new");
    store.rows.commit(&batch).unwrap();
    drop(store);
    fs::remove_dir_all(folder.join("db")).unwrap();
    files::copy_folder(&older, &folder.join("db")).unwrap();
    let store = Store::open(&folder).unwrap();
    assert_eq!(store.rows.get(Tree::Jobs, b"key").unwrap().unwrap(), b"cancelled");
    assert_eq!(store.rows.get(Tree::Jobs, b"new").unwrap().unwrap(), b"new");
    assert_eq!(store.damage, Damage::default());
}

#[test]
fn damaged_rows_are_counted() {
    let dir = tempfile::tempdir().unwrap();
    drop(Store::open(dir.path()).unwrap());
    let db = open_sled(&dir.path().join("db")).unwrap();
    db.open_tree(Tree::Shards.name()).unwrap().insert("key", b"12345678another".as_slice()).unwrap();
    db.flush().unwrap();
    drop(db);
    let store = Store::open(dir.path()).unwrap();
    assert_eq!(store.damage, Damage { damaged_rows: 1, ..Damage::default() });
}

#[test]
fn a_lost_journal_is_told_once_and_a_fresh_store_lacks_nothing() {
    let dir = tempfile::tempdir().unwrap();
    let store = Store::open(dir.path()).unwrap();
    assert_eq!(store.damage, Damage::default());
    one_job(&store);
    drop(store);
    let journal = dir.path().join("jobs.log");
    for lose in [|path: &Path| fs::remove_file(path).unwrap(), |path: &Path| fs::write(path, "").unwrap()] {
        lose(&journal);
        let damage = Store::open(dir.path()).unwrap().damage;
        assert_eq!(damage, Damage { journal_is_incomplete: true, ..Damage::default() });
        assert_eq!(Store::open(dir.path()).unwrap().damage, Damage::default());
    }
}

#[test]
fn a_missing_database_beside_tables_counts_as_replaced_and_the_journal_as_lost() {
    let dir = tempfile::tempdir().unwrap();
    let store = Store::open(dir.path()).unwrap();
    store.blobs.put(b"table").unwrap();
    drop(store);
    fs::remove_dir_all(dir.path().join("db")).unwrap();
    fs::remove_file(dir.path().join("jobs.log")).unwrap();
    let lost = Damage { database_was_replaced: true, journal_is_incomplete: true, ..Damage::default() };
    assert_eq!(Store::open(dir.path()).unwrap().damage, lost);
    assert_eq!(Store::open(dir.path()).unwrap().damage, Damage::default());
}

/// Puts jobs into a tree of an earlier schema.
fn put_earlier(db: &sled::Db, tree: &str, jobs: &[(&str, &str)]) {
    for (key, value) in jobs {
        let sealed = rows::seal(tree, key.as_bytes(), value.as_bytes());
        db.open_tree(tree).unwrap().insert(key, sealed).unwrap();
    }
    db.flush().unwrap();
}

/// Opens the store in `dir` twice and compares its jobs.
fn assert_jobs(dir: &Path, jobs: &[(&str, &str)]) {
    for _ in 0..2 {
        let store = Store::open(dir).unwrap();
        assert_eq!(store.damage, Damage::default());
        let found = store.rows.scan(Tree::Jobs, &[]).unwrap();
        let found: Vec<_> = found.iter().map(|row| (row.key.as_slice(), row.value.as_deref().unwrap())).collect();
        let wanted: Vec<_> = jobs.iter().map(|(key, value)| (key.as_bytes(), value.as_bytes())).collect();
        assert_eq!(found, wanted);
    }
}

#[test]
fn jobs_of_a_store_from_before_there_was_a_journal_are_taken_over() {
    for schema in 1..migrations::WITH_JOURNAL {
        let dir = tempfile::tempdir().unwrap();
        let db = open_sled(&dir.path().join("db")).unwrap();
        migrations::apply(&db, &migrations::ALL[..schema]).unwrap();
        put_earlier(&db, "jobs", &[("a", "queued"), ("b", "done")]);
        drop(db);
        assert_jobs(dir.path(), &[("a", "queued"), ("b", "done")]);
    }
}

/// In the last of these schemas the database had revisions and the last line of the journal.
#[test]
fn jobs_of_a_store_with_database_and_journal_are_those_of_the_journal() {
    let line = |words: &str| format!("\n{}{words}\n", &Digest::of(words.as_bytes()).hex()[..16]);
    let job = |key: &str, state: &str| format!(" jobs {} {}", to_hex(key.as_bytes()), to_hex(state.as_bytes()));
    for (schema, tree, revision) in [(3, "jobs", ""), (4, "numbered_jobs", "\0\0\0\0\0\0\0\u{7}")] {
        let dir = tempfile::tempdir().unwrap();
        let db = open_sled(&dir.path().join("db")).unwrap();
        migrations::apply(&db, &migrations::ALL[..schema]).unwrap();
        // The database has a job whose line a crash came before, an older state, and a job that was forgotten
        // since.
        let in_database = [("a", "cancelled"), ("b", "running"), ("c", "done"), ("d", "queued")];
        let in_database = in_database.map(|(key, state)| (key, format!("{revision}{state}")));
        put_earlier(&db, tree, &in_database.each_ref().map(|(key, value)| (*key, value.as_str())));
        drop(db);
        let mut journal = line(if schema == 3 { "" } else { " head 0 0" });
        for (n, words) in [
            job("a", "queued"),
            job("b", "queued"),
            job("c", "done"),
            job("a", "cancelled"),
            job("b", "done"),
            format!(" jobs {} -", to_hex(b"c")),
        ]
        .into_iter()
        .enumerate()
        {
            journal += &line(&if schema == 3 { words } else { format!(" {}{words}", n + 1) });
        }
        fs::write(dir.path().join("jobs.log"), journal).unwrap();
        assert_jobs(dir.path(), &[("a", "cancelled"), ("b", "done"), ("d", "queued")]);
    }
}

#[test]
fn a_database_that_does_not_open_is_copied_to_quarantine_and_the_blobs_stay() {
    let dir = tempfile::tempdir().unwrap();
    let store = Store::open(dir.path()).unwrap();
    (0..50).for_each(|_| one_job(&store));
    let digest = store.blobs.put(b"table").unwrap();
    drop(store);
    // After a second start there is a snapshot, by which sled knows that the file had contents.
    drop(Store::open(dir.path()).unwrap());
    let db = dir.path().join("db/db");
    let length = fs::metadata(&db).unwrap().len();
    fs::write(&db, vec![0x5a; usize::try_from(length).unwrap()]).unwrap();
    let store = Store::open(dir.path()).unwrap();
    assert_eq!(store.damage, Damage { database_was_replaced: true, ..Damage::default() });
    assert_eq!(store.rows.get(Tree::Jobs, b"key").unwrap().unwrap(), b"job");
    assert_eq!(store.blobs.get(digest).unwrap().unwrap(), b"table");
    let aside = fs::read(dir.path().join("quarantine/db-1/db")).unwrap();
    assert_eq!((aside.len() as u64, aside[0]), (length, 0x5a));
}

/// sled takes what it does not know for an empty database.
#[test]
fn another_file_in_place_of_the_database_is_kept() {
    let dir = tempfile::tempdir().unwrap();
    one_job(&Store::open(dir.path()).unwrap());
    let other = b"the only copy of something else";
    fs::write(dir.path().join("db/db"), other).unwrap();
    let store = Store::open(dir.path()).unwrap();
    assert!(store.damage.database_was_replaced);
    assert_eq!(store.rows.get(Tree::Jobs, b"key").unwrap().unwrap(), b"job");
    assert_eq!(fs::read(dir.path().join("quarantine/db-1")).unwrap(), other);
}

#[test]
fn a_truncated_database_never_prevents_the_start_and_loses_no_job() {
    for cut in [0, 1, 100, 4096] {
        let dir = tempfile::tempdir().unwrap();
        let store = Store::open(dir.path()).unwrap();
        (0..50).for_each(|_| one_job(&store));
        drop(store);
        drop(Store::open(dir.path()).unwrap());
        let db = dir.path().join("db/db");
        fs::write(&db, &fs::read(&db).unwrap()[..cut]).unwrap();
        let store = Store::open(dir.path()).unwrap();
        assert_eq!(store.rows.get(Tree::Jobs, b"key").unwrap().unwrap(), b"job", "cut at {cut}");
        one_job(&store);
    }
}

#[test]
fn a_damaged_snapshot_costs_no_job() {
    let dir = tempfile::tempdir().unwrap();
    one_job(&Store::open(dir.path()).unwrap());
    drop(Store::open(dir.path()).unwrap());
    let files = fs::read_dir(dir.path().join("db")).unwrap().map(|entry| entry.unwrap().path());
    let snapshots: Vec<_> =
        files.filter(|path| path.file_name().unwrap().to_string_lossy().starts_with("snap.")).collect();
    assert!(!snapshots.is_empty(), "sled left no snapshot to damage");
    for path in snapshots {
        let mut bytes = fs::read(&path).unwrap();
        let middle = bytes.len() / 2;
        bytes[middle] ^= 0xff;
        fs::write(path, bytes).unwrap();
    }
    let store = Store::open(dir.path()).unwrap();
    assert!(store.rows.get(Tree::Jobs, b"key").unwrap().is_some());
}

#[test]
fn a_folder_on_a_full_disk_opens_for_reading_again_and_again_and_for_writing_once_there_is_room() {
    let dir = tempfile::tempdir().unwrap();
    let Some(disk) = SmallDisk::mount(dir.path().join("disk")) else { return };
    let data = disk.0.join("data");
    let row = |key: &str, tree| {
        let mut batch = Batch::default();
        batch.put(tree, key, "value");
        batch
    };
    let store = Store::open(&data).unwrap();
    let table = store.blobs.put(b"table").unwrap();
    store.rows.commit(&row("before", Tree::Recipes)).unwrap();
    store.rows.commit(&row("job", Tree::Jobs)).unwrap();
    drop(store);
    disk.fill();
    for start in 0..4 {
        let store = Store::open(&data).unwrap_or_else(|error| panic!("start {start}: {error:?}"));
        assert_eq!(store.damage, Damage::default());
        assert_eq!(store.blobs.get(table).unwrap().unwrap(), b"table");
        for (tree, key) in [(Tree::Recipes, "before"), (Tree::Jobs, "job")] {
            assert_eq!(store.rows.get(tree, key.as_bytes()).unwrap().unwrap(), b"value");
            assert!(matches!(store.rows.commit(&row("during", tree)), Err(StoreError::DiskFull)));
        }
        if start == 3 {
            disk.make_room();
            for (tree, key) in [(Tree::Recipes, "after"), (Tree::Jobs, "another")] {
                store.rows.commit(&row(key, tree)).unwrap();
            }
        }
    }
    let store = Store::open(&data).unwrap();
    assert_eq!(store.damage, Damage::default());
    for (tree, key) in
        [(Tree::Recipes, "before"), (Tree::Recipes, "after"), (Tree::Jobs, "job"), (Tree::Jobs, "another")]
    {
        assert_eq!(store.rows.get(tree, key.as_bytes()).unwrap().unwrap(), b"value", "{key}");
    }
    assert_eq!(store.rows.get(Tree::Recipes, b"during").unwrap(), None);
}
