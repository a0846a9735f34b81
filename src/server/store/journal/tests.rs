use super::{entries::read, *};
use crate::server::store::memory::MemoryRows;

/// Opens the journal in `dir` of rows that had one.
fn open(rows: MemoryRows, dir: &Path) -> (JournalledRows<MemoryRows>, Findings) {
    let mut found = Findings::default();
    let opened = JournalledRows::open(rows, &dir.join("jobs.log"), &dir.join("quarantine"), true, &mut found);
    (opened.unwrap(), found)
}

/// Names as findings list them.
fn named(keys: &[&str]) -> Vec<String> {
    keys.iter().map(|key| to_hex(key.as_bytes())).collect()
}

fn job(key: &str, value: Option<&str>) -> Batch {
    let mut batch = Batch::default();
    match value {
        Some(value) => {
            batch.put(Tree::Jobs, key, value);
            batch.put(Tree::JobOrder, format!("order of {key}"), key);
        }
        None => batch.remove(Tree::Jobs, key),
    }
    // What is not a job's is not kept.
    batch.put(Tree::Shards, key, "shard");
    batch
}

fn jobs(rows: &impl Rows) -> Vec<String> {
    let rows = rows.scan(Tree::Jobs, &[]).unwrap();
    rows.into_iter().map(|row| String::from_utf8(row.value.unwrap()).unwrap()).collect()
}

/// The journal of four jobs, of which one has changed and one was removed.
fn journal(dir: &Path) {
    let (rows, _) = open(MemoryRows::default(), dir);
    for key in ["a", "b", "c", "d"] {
        rows.commit(&job(key, Some(&format!("{key} queued")))).unwrap();
    }
    rows.stage(&job("b", Some("b running"))).unwrap();
    rows.commit(&job("b", Some("b done"))).unwrap();
    rows.commit(&job("c", None)).unwrap();
}

#[test]
fn what_the_database_lost_is_restored_and_what_it_has_stays() {
    let dir = tempfile::tempdir().unwrap();
    journal(dir.path());
    let partial = MemoryRows::default();
    partial.commit(&job("a", Some("a cancelled"))).unwrap();
    let (rows, restored) = open(partial, dir.path());
    assert_eq!(jobs(&rows), ["a cancelled", "b done", "d queued"]);
    assert_eq!(rows.get(Tree::JobOrder, b"order of d").unwrap().unwrap(), b"d");
    assert_eq!(restored.damaged_journal_entries, 0);
    assert!(restored.restored_rows >= 4, "{restored:?}");
    assert_eq!(restored.restored_jobs, named(&["b", "d"]));
    assert!(restored.lost_jobs.is_empty() && !restored.journal_is_incomplete, "{restored:?}");
    drop(rows);
    // The journal was written anew, and nothing more is to restore.
    let (rows, _) = open(MemoryRows::default(), dir.path());
    assert_eq!(jobs(&rows), ["a cancelled", "b done", "d queued"]);
    let (_, restored) = open(rows.rows, dir.path());
    assert_eq!(restored, Findings::default());
    assert!(!dir.path().join("quarantine").exists());
}

#[test]
fn an_entry_that_was_cut_off_hides_no_other() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("jobs.log");
    journal(dir.path());
    let whole = fs::read(&path).unwrap();
    let end = whole.len() - 1;
    let last = whole[..end].iter().rposition(|byte| *byte == b'\n').unwrap();
    for cut in last + 1..end {
        fs::write(&path, &whole[..cut]).unwrap();
        let (rows, restored) = open(MemoryRows::default(), dir.path());
        // The last entry removed c.
        assert_eq!(jobs(&rows), ["a queued", "b done", "c queued", "d queued"], "cut at {cut}");
        assert_eq!(restored.damaged_journal_entries, 0);
        rows.commit(&job("e", Some("e queued"))).unwrap();
    }
}

/// A whole entry was acknowledged, even if it is the last one. What an older entry says of its job does not undo what
/// the database has.
#[test]
fn a_damaged_last_entry_is_counted_and_reverts_nothing() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("jobs.log");
    let (rows, _) = open(MemoryRows::default(), dir.path());
    rows.commit(&job("a", Some("a queued"))).unwrap();
    rows.commit(&job("a", Some("a cancelled"))).unwrap();
    let mut bytes = fs::read(&path).unwrap();
    let near_end = bytes.len() - 4;
    bytes[near_end] ^= 1;
    fs::write(&path, bytes).unwrap();
    let (rows, restored) = open(rows.rows, dir.path());
    assert_eq!(restored, Findings { damaged_journal_entries: 1, ..Findings::default() });
    assert_eq!(jobs(&rows), ["a cancelled"]);
}

#[test]
fn every_flipped_bit_is_found_and_costs_one_entry_at_most() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("jobs.log");
    journal(dir.path());
    let whole = fs::read(&path).unwrap();
    for at in 0..whole.len() {
        let mut flipped = whole.clone();
        flipped[at] ^= 1 << (at % 8);
        let Entries { latest, damaged, .. } = read(&flipped);
        let known = |key: &str| latest.contains_key(&(Tree::Jobs.name(), key.as_bytes().to_vec()));
        let missing = ["a", "b", "c", "d"].iter().filter(|key| !known(key)).count();
        // A line break that is gone, or a new one, concerns two entries.
        assert!(damaged <= 2 && missing <= 2, "bit {} of byte {at}: {damaged} {missing}", at % 8);
    }
}

/// Changes the bytes of the journal in `dir`; returns them as they are now.
fn damage(dir: &Path, change: impl FnOnce(&mut Vec<u8>)) -> Vec<u8> {
    let path = dir.join("jobs.log");
    let mut bytes = fs::read(&path).unwrap();
    change(&mut bytes);
    fs::write(&path, &bytes).unwrap();
    bytes
}

#[test]
fn a_damaged_journal_is_copied_to_quarantine_before_it_is_written_anew() {
    let dir = tempfile::tempdir().unwrap();
    journal(dir.path());
    let damaged = damage(dir.path(), |bytes| {
        let middle = bytes.len() / 2;
        bytes[middle] ^= 1;
    });
    let (rows, found) = open(MemoryRows::default(), dir.path());
    assert_eq!(found.damaged_journal_entries, 1);
    assert_eq!(fs::read(dir.path().join("quarantine/jobs.log-1")).unwrap(), damaged);
    // The new one is whole.
    let (_, found) = open(rows.rows, dir.path());
    assert_eq!(found, Findings::default());
    assert!(!dir.path().join("quarantine/jobs.log-2").exists());
}

/// The seal of the entry is broken, and its job can be read. Neither the database nor another entry has the job.
#[test]
fn a_job_that_only_a_damaged_entry_has_is_named_as_lost() {
    let dir = tempfile::tempdir().unwrap();
    journal(dir.path());
    let entry = format!(" jobs {} ", to_hex(b"a"));
    damage(dir.path(), |bytes| {
        let at = bytes.windows(entry.len()).position(|found| found == entry.as_bytes()).unwrap();
        bytes[at - 1] = if bytes[at - 1] == b'0' { b'1' } else { b'0' };
    });
    let (rows, found) = open(MemoryRows::default(), dir.path());
    assert_eq!(jobs(&rows), ["b done", "d queued"]);
    assert_eq!((found.lost_jobs, found.restored_jobs), (named(&["a"]), named(&["b", "d"])));
}

#[test]
fn a_journal_that_lacks_what_the_database_has_proves_nothing() {
    let stored = || {
        let rows = MemoryRows::default();
        for key in ["a", "b", "c"] {
            rows.commit(&job(key, Some(key))).unwrap();
        }
        rows
    };
    let without = tempfile::tempdir().unwrap();
    let empty = tempfile::tempdir().unwrap();
    fs::write(empty.path().join("jobs.log"), "").unwrap();
    let short = tempfile::tempdir().unwrap();
    fs::write(short.path().join("jobs.log"), entries::first()).unwrap();
    for dir in [&without, &empty, &short] {
        let (rows, found) = open(stored(), dir.path());
        assert_eq!(found, Findings { journal_is_incomplete: true, ..Findings::default() });
        assert_eq!(jobs(&rows), ["a", "b", "c"]);
        let (_, found) = open(rows.rows, dir.path());
        assert_eq!(found, Findings::default(), "it was written anew");
    }
    assert!(empty.path().join("quarantine/jobs.log-1").exists() && short.path().join("quarantine/jobs.log-1").exists());

    // A fresh store, one from before there was a journal, and one whose last commit a crash interrupted lack nothing.
    let fresh = tempfile::tempdir().unwrap();
    assert_eq!(open(MemoryRows::default(), fresh.path()).1, Findings::default());
    let older = tempfile::tempdir().unwrap();
    let mut found = Findings::default();
    let path = older.path().join("jobs.log");
    JournalledRows::open(stored(), &path, older.path(), false, &mut found).unwrap();
    assert_eq!(found, Findings::default());
    let one = MemoryRows::default();
    one.commit(&job("a", Some("a"))).unwrap();
    assert_eq!(open(one, fresh.path()).1, Findings::default());
}

#[test]
fn an_empty_database_in_place_of_a_damaged_one_without_a_journal_is_told() {
    let dir = tempfile::tempdir().unwrap();
    let mut found = Findings { database_was_replaced: true, ..Findings::default() };
    let path = dir.path().join("jobs.log");
    JournalledRows::open(MemoryRows::default(), &path, dir.path(), false, &mut found).unwrap();
    assert!(found.journal_is_incomplete);
}
