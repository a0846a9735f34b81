use std::{
    fs,
    sync::{
        Arc, Mutex,
        atomic::{AtomicU32, Ordering},
    },
};

use super::*;

fn put(key: &str) -> Batch {
    let mut batch = Batch::default();
    batch.put(Tree::Jobs, key, "job");
    batch.put(Tree::Shards, key, "shard");
    batch
}

fn plain(folder: &Path) -> SledRows {
    SledRows::open(folder, Arc::new(File::sync_all)).unwrap()
}

#[test]
fn rows_are_set_removed_scanned_and_paged_in_order() {
    let dir = tempfile::tempdir().unwrap();
    let rows = plain(dir.path());
    for key in ["a1", "a2", "b1", "b2"] {
        rows.commit(&put(key)).unwrap();
    }
    let mut batch = Batch::default();
    batch.remove(Tree::Jobs, "b1");
    rows.commit(&batch).unwrap();
    let keys = |rows: Vec<Row>| rows.into_iter().map(|row| String::from_utf8(row.key).unwrap()).collect::<Vec<_>>();
    assert_eq!(rows.get(Tree::Jobs, b"a1").unwrap().unwrap(), b"job");
    assert_eq!(rows.get(Tree::Jobs, b"b1").unwrap(), None);
    assert_eq!(keys(rows.scan(Tree::Jobs, b"a").unwrap()), ["a1", "a2"]);
    assert_eq!(keys(rows.page(Tree::Shards, None, 2).unwrap()), ["b2", "b1"]);
    assert_eq!(keys(rows.page(Tree::Shards, Some(b"b1"), 9).unwrap()), ["a2", "a1"]);
}

#[test]
fn a_copy_of_the_open_files_has_every_acknowledged_row() {
    let dir = tempfile::tempdir().unwrap();
    let rows = plain(&dir.path().join("db"));
    for n in 0..20 {
        rows.commit(&put(&format!("{n:02}"))).unwrap();
        let killed = dir.path().join(format!("killed-{n}"));
        files::copy_folder(&dir.path().join("db"), &killed).unwrap();
        let again = plain(&killed);
        assert_eq!(again.scan(Tree::Jobs, b"").unwrap().len(), n + 1);
        assert_eq!(again.scan(Tree::Shards, b"").unwrap().len(), n + 1);
    }
}

/// Only the state at the last fsync survives; every later write is lost.
#[test]
fn a_power_cut_loses_nothing_acknowledged() {
    let dir = tempfile::tempdir().unwrap();
    let (folder, disk) = (dir.path().join("db"), dir.path().join("disk"));
    let syncs = Arc::new(AtomicU32::new(0));
    let last = Arc::new(Mutex::new(PathBuf::new()));
    let hook = {
        let (folder, disk, syncs, last) = (folder.clone(), disk, Arc::clone(&syncs), Arc::clone(&last));
        move |file: &File| {
            file.sync_all()?;
            let snapshot = disk.join(syncs.fetch_add(1, Ordering::Relaxed).to_string());
            files::copy_folder(&folder, &snapshot)?;
            *last.lock().unwrap() = snapshot;
            Ok(())
        }
    };
    let rows = SledRows::open(&folder, Arc::new(hook)).unwrap();
    let before = syncs.load(Ordering::Relaxed);
    for n in 0..12 {
        rows.commit(&put(&format!("{n:02}"))).unwrap();
    }
    assert_eq!(syncs.load(Ordering::Relaxed) - before, 12, "one fsync for each acknowledged commit");
    rows.stage(&put("lost, but never acknowledged")).unwrap();
    let survived = plain(&last.lock().unwrap());
    assert_eq!(survived.scan(Tree::Jobs, b"").unwrap().len(), 12);
}

#[test]
fn a_commit_whose_fsync_fails_is_not_acknowledged_and_the_next_one_works() {
    let dir = tempfile::tempdir().unwrap();
    let full = Arc::new(AtomicU32::new(0));
    let hook = {
        let full = Arc::clone(&full);
        move |file: &File| match full.load(Ordering::Relaxed) {
            0 => file.sync_all(),
            _ => Err(io::ErrorKind::StorageFull.into()),
        }
    };
    let rows = SledRows::open(dir.path(), Arc::new(hook)).unwrap();
    rows.commit(&put("before")).unwrap();
    full.store(1, Ordering::Relaxed);
    assert!(matches!(rows.commit(&put("during")), Err(StoreError::DiskFull)));
    assert!(rows.handle.read().unwrap().is_none(), "sled refuses everything after a write error: it is closed");
    full.store(0, Ordering::Relaxed);
    rows.commit(&put("after")).unwrap();
    assert!(rows.get(Tree::Jobs, b"before").unwrap().is_some());
    assert!(rows.get(Tree::Jobs, b"after").unwrap().is_some());
}

#[test]
fn a_lock_that_is_released_late_does_not_prevent_opening() {
    let dir = tempfile::tempdir().unwrap();
    plain(dir.path()).commit(&put("key")).unwrap();
    let file = File::options().write(true).open(dir.path().join("db")).unwrap();
    file.lock().unwrap();
    let again = thread::scope(|scope| {
        let again = scope.spawn(|| plain(dir.path()));
        // Long enough for an attempt that does not wait to fail; the test passes without it.
        thread::sleep(Duration::from_millis(50));
        drop(file);
        again.join().unwrap()
    });
    assert!(again.get(Tree::Jobs, b"key").unwrap().is_some());
}

#[test]
fn a_value_that_was_changed_on_the_disk_is_reported() {
    let dir = tempfile::tempdir().unwrap();
    let rows = plain(dir.path());
    rows.commit(&put("key")).unwrap();
    rows.with(|handle| handle.tree(Tree::Jobs).insert("key", b"12345678another".as_slice())).unwrap();
    assert!(matches!(rows.get(Tree::Jobs, b"key"), Err(StoreError::DamagedRow { tree: Tree::Jobs, .. })));
    assert_eq!(rows.scan(Tree::Jobs, b"").unwrap()[0].value, None);
}

#[test]
fn what_was_settled_survives_a_power_cut_and_what_was_staged_later_does_not() {
    let dir = tempfile::tempdir().unwrap();
    let (folder, cut) = (dir.path().join("db"), dir.path().join("cut"));
    let hook = {
        let (folder, cut) = (folder.clone(), cut.clone());
        move |file: &File| {
            file.sync_all()?;
            let _ = fs::remove_dir_all(&cut);
            files::copy_folder(&folder, &cut)
        }
    };
    let rows = SledRows::open(&folder, Arc::new(hook)).unwrap();
    let staged = rows.stage(&put("settled")).unwrap();
    rows.settle(staged).unwrap();
    rows.stage(&put("staged")).unwrap();
    let survived = plain(&cut);
    assert!(survived.get(Tree::Jobs, b"settled").unwrap().is_some());
    assert!(survived.get(Tree::Jobs, b"staged").unwrap().is_none());
}

#[test]
fn what_was_staged_before_a_write_error_is_not_acknowledged_after_it() {
    let dir = tempfile::tempdir().unwrap();
    let rows = SledRows::open(dir.path(), fails_at(1)).unwrap();
    let staged = rows.stage(&put("staged")).unwrap();
    assert!(matches!(rows.commit(&put("during")), Err(StoreError::DiskFull)));
    let error = rows.settle(staged).unwrap_err().to_string();
    assert!(error.contains("closed by a write error"), "{error}");
    let again = rows.stage(&put("staged")).unwrap();
    rows.settle(again).unwrap();
    assert!(rows.get(Tree::Jobs, b"staged").unwrap().is_some());
}

/// A sync that fails once, after so many that do not.
fn fails_at(sync: u32) -> SyncFn {
    let syncs = AtomicU32::new(0);
    Arc::new(move |file: &File| match syncs.fetch_add(1, Ordering::Relaxed) {
        at if at == sync => Err(io::ErrorKind::StorageFull.into()),
        _ => file.sync_all(),
    })
}

/// A database whose next commit fails and closes it.
fn closed_by_an_error(folder: &Path) -> SledRows {
    // Opening it syncs once, and so does the commit before.
    let rows = SledRows::open(folder, fails_at(2)).unwrap();
    rows.commit(&put("before")).unwrap();
    assert!(matches!(rows.commit(&put("during")), Err(StoreError::DiskFull)));
    rows
}

#[test]
fn a_database_that_is_opened_again_is_checked_before_it_is_read() {
    let dir = tempfile::tempdir().unwrap();
    let rows = closed_by_an_error(dir.path());
    // It comes back without its rows.
    fs::remove_dir_all(dir.path()).unwrap();
    fs::create_dir(dir.path()).unwrap();
    assert!(rows.reopen_check.set(Box::new(|rows| rows.commit(&put("before")))).is_ok());
    assert_eq!(rows.get(Tree::Jobs, b"before").unwrap().unwrap(), b"job");
}

#[test]
fn a_database_that_fails_a_check_stays_closed() {
    let dir = tempfile::tempdir().unwrap();
    let rows = closed_by_an_error(dir.path());
    let passes = Arc::new(AtomicU32::new(0));
    let check = Arc::clone(&passes);
    let check: ReopenCheck = Box::new(move |_| match check.load(Ordering::Relaxed) {
        0 => Err(StoreError::Database("not as it was".to_owned())),
        _ => Ok(()),
    });
    assert!(rows.reopen_check.set(check).is_ok());
    for _ in 0..2 {
        assert!(rows.scan(Tree::Jobs, b"").unwrap_err().to_string().contains("not as it was"));
    }
    passes.store(1, Ordering::Relaxed);
    assert!(rows.get(Tree::Jobs, b"before").unwrap().is_some());
}

#[test]
fn a_database_that_was_damaged_while_it_was_closed_is_an_error() {
    let dir = tempfile::tempdir().unwrap();
    let rows = closed_by_an_error(dir.path());
    for entry in fs::read_dir(dir.path()).unwrap() {
        let path = entry.unwrap().path();
        if path.is_file() {
            fs::write(&path, vec![0x5a; 1 << 20]).unwrap();
        }
    }
    let error = rows.scan(Tree::Jobs, b"").unwrap_err().to_string();
    assert!(error.contains("stays closed"), "{error}");
}

#[test]
fn a_clock_before_1970_is_told_and_no_damage() {
    let second = Duration::from_secs(1);
    for (now, is_taken) in [(SystemTime::UNIX_EPOCH - second, false), (SystemTime::UNIX_EPOCH, true)] {
        assert_eq!(check_clock(now).is_ok(), is_taken, "{now:?}");
    }
    assert!(check_clock(SystemTime::now()).is_ok());
}
