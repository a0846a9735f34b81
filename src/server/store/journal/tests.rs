use super::{
    entries::{Entries, read},
    *,
};
use crate::store::memory::MemoryRows;
use ltcforge_files::hex::to_hex;

/// Opens the journal in `dir` of rows that had one.
fn open(rows: MemoryRows, dir: &Path) -> (JournalledRows<MemoryRows>, Findings) {
    open_with(rows, dir, true, Findings::default())
}

fn open_with(
    rows: MemoryRows,
    dir: &Path,
    was_journalled: bool,
    mut found: Findings,
) -> (JournalledRows<MemoryRows>, Findings) {
    let (journal, database, quarantine) = (dir.join("jobs.log"), dir.join("db"), dir.join("quarantine"));
    let paths = Paths { journal: &journal, database: &database, quarantine: &quarantine };
    (JournalledRows::open(rows, paths, was_journalled, &mut found).unwrap(), found)
}

/// A database with these jobs, each last changed at its revision, and without the last entry of its journal.
fn stored(jobs: &[(&str, &str, u64)]) -> MemoryRows {
    let rows = MemoryRows::default();
    for (key, value, revision) in jobs {
        rows.commit(&with_revision(&job(key, Some(value)), *revision)).unwrap();
    }
    rows
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
fn what_the_database_lost_or_has_older_is_as_in_the_journal() {
    let dir = tempfile::tempdir().unwrap();
    journal(dir.path());
    // a is as it was last, b and c are older, d is lost.
    let partial = stored(&[("a", "a queued", 1), ("b", "b queued", 2), ("c", "c queued", 3)]);
    let (rows, found) = open(partial, dir.path());
    assert_eq!(jobs(&rows), ["a queued", "b done", "d queued"]);
    assert_eq!(rows.get(Tree::JobOrder, b"order of d").unwrap().unwrap(), b"d");
    assert_eq!((&found.restored_jobs, &found.reverted_jobs), (&named(&["d"]), &named(&["b", "c"])));
    // b, c and d, and the place of d.
    assert_eq!((found.restored_rows, found.damaged_journal_entries), (4, 0));
    assert!(found.lost_jobs.is_empty() && !found.journal_is_incomplete, "{found:?}");
    let kept = fs::read_to_string(dir.path().join("quarantine/jobs.log-1")).unwrap();
    assert!(kept.contains(&to_hex(b"b done")) && kept.contains(&to_hex(b"c queued")), "{kept}");
    // The journal was written anew, and nothing more is to restore.
    let (rows, found) = open(rows.rows, dir.path());
    assert_eq!(found, Findings::default());
    drop(rows);
    let (rows, found) = open(MemoryRows::default(), dir.path());
    assert_eq!((jobs(&rows).len(), found.reverted_jobs.len(), found.restored_jobs.len()), (3, 0, 3));
    assert!(!dir.path().join("quarantine/jobs.log-2").exists());
}

/// The journal that is written anew has no entry of a job that was removed. It tells that there are no other jobs.
#[test]
fn a_job_that_was_removed_before_the_journal_was_written_anew_stays_removed() {
    let dir = tempfile::tempdir().unwrap();
    journal(dir.path());
    let (rows, _) = open(MemoryRows::default(), dir.path());
    drop(rows);
    let older = || stored(&[("a", "a queued", 1), ("b", "b done", 5), ("c", "c queued", 3), ("d", "d queued", 4)]);
    let (rows, found) = open(older(), dir.path());
    assert_eq!((jobs(&rows).len(), found.reverted_jobs), (3, named(&["c"])));
    // If a row of the journal is damaged, it may have been that of c.
    let entry = to_hex(b"a queued");
    damage(dir.path(), |bytes| {
        let at = bytes.windows(entry.len()).position(|found| found == entry.as_bytes()).unwrap();
        bytes[at] ^= 1;
    });
    let (rows, found) = open(older(), dir.path());
    assert_eq!((jobs(&rows).len(), found.damaged_journal_entries), (4, 1));
}

/// A staged change is as new as the last commit, and the journal does not have it.
#[test]
fn a_staged_change_stays_and_loses_against_a_later_commit() {
    let dir = tempfile::tempdir().unwrap();
    let (rows, _) = open(MemoryRows::default(), dir.path());
    rows.commit(&job("a", Some("a queued"))).unwrap();
    rows.commit(&job("b", Some("b queued"))).unwrap();
    rows.stage(&job("a", Some("a running"))).unwrap();
    let (rows, found) = open(rows.rows, dir.path());
    assert_eq!((jobs(&rows), found), (vec!["a running".to_owned(), "b queued".to_owned()], Findings::default()));
    rows.commit(&job("a", None)).unwrap();
    let (rows, found) = open(stored(&[("a", "a running", 2), ("b", "b queued", 2)]), dir.path());
    assert_eq!((jobs(&rows), found.reverted_jobs), (vec!["b queued".to_owned()], named(&["a"])));
}

/// An entry that could not be appended is not missing from then on.
#[test]
fn after_a_failed_append_the_journal_is_written_anew() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("jobs.log");
    let (rows, _) = open(MemoryRows::default(), dir.path());
    rows.commit(&job("a", Some("a queued"))).unwrap();
    // Its descriptor does not write.
    rows.end().file = File::open(&path).unwrap();
    assert!(rows.commit(&job("b", Some("b queued"))).is_err());
    rows.commit(&job("c", Some("c queued"))).unwrap();
    let (rows, found) = open(rows.rows, dir.path());
    assert_eq!((jobs(&rows).len(), found), (3, Findings::default()));
}

/// A crash between the two leaves the database one entry ahead; the database knows that entry.
#[test]
fn the_last_entry_in_the_database_stands_for_the_one_that_the_journal_lacks() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("jobs.log");
    let (rows, _) = open(MemoryRows::default(), dir.path());
    rows.commit(&job("a", Some("a queued"))).unwrap();
    let before = fs::read(&path).unwrap();
    rows.commit(&job("a", Some("a cancelled"))).unwrap();
    fs::write(&path, &before).unwrap();
    // As if a page with the older row were back.
    rows.rows.commit(&with_revision(&job("a", Some("a queued")), 1)).unwrap();
    let (rows, found) = open(rows.rows, dir.path());
    assert_eq!((jobs(&rows), found.reverted_jobs), (vec!["a cancelled".to_owned()], named(&["a"])));
    rows.commit(&job("b", Some("b queued"))).unwrap();
    rows.commit(&job("b", Some("b done"))).unwrap();
    fs::write(&path, &before).unwrap();
    let (rows, found) = open(rows.rows, dir.path());
    assert!(found.journal_is_incomplete, "{found:?}");
    assert_eq!(jobs(&rows), ["a cancelled", "b done"]);
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
        let known = |key: &str| latest.contains_key(&(Tree::Jobs, key.as_bytes().to_vec()));
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
fn a_job_that_only_a_damaged_entry_has_is_named_as_doubtful() {
    let dir = tempfile::tempdir().unwrap();
    journal(dir.path());
    let entry = format!(" jobs {} ", to_hex(b"a"));
    damage(dir.path(), |bytes| {
        let at = bytes.windows(entry.len()).position(|found| found == entry.as_bytes()).unwrap();
        bytes[at - 1] = if bytes[at - 1] == b'0' { b'1' } else { b'0' };
    });
    let (rows, found) = open(MemoryRows::default(), dir.path());
    assert_eq!(jobs(&rows), ["b done", "d queued"]);
    assert_eq!((found.doubtful_jobs, found.restored_jobs), (named(&["a"]), named(&["b", "d"])));
    assert!(found.lost_jobs.is_empty());
}

/// A whole database proves that no job is lost. One bit of an id in the journal makes no job of another name.
#[test]
fn a_misread_id_of_a_job_that_is_there_is_not_named() {
    let dir = tempfile::tempdir().unwrap();
    let ids = ["0123456789abcdef", "fedcba9876543210"];
    let (rows, _) = open(MemoryRows::default(), dir.path());
    for id in ids {
        rows.commit(&job(id, Some("queued"))).unwrap();
    }
    let whole = fs::read(dir.path().join("jobs.log")).unwrap();
    let mut concerned = 0;
    for at in 0..8 * whole.len() {
        let (mut bytes, mut found) = (whole.clone(), Findings::default());
        bytes[at / 8] ^= 1 << (at % 8);
        comparison::compare(&rows.rows, Some(&bytes), true, &mut found).unwrap();
        assert!(found.lost_jobs.is_empty() && found.doubtful_jobs.is_empty(), "bit {at}: {found:?}");
        concerned += usize::from(found.damaged_journal_entries > 0);
    }
    assert!(concerned > 4 * whole.len(), "{concerned}");
}

/// A database that fell back and a journal whose end was cut off: the line that was cut had been acknowledged.
#[test]
fn what_both_have_lost_is_told_wherever_the_journal_was_cut() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("jobs.log");
    let (rows, _) = open(MemoryRows::default(), dir.path());
    let ids = ["0123456789abcdef", "1123456789abcdef", "fedcba9876543210"];
    for id in ids {
        rows.commit(&job(id, Some("queued"))).unwrap();
    }
    let whole = fs::read(&path).unwrap();
    let older = || stored(&[(ids[0], "queued", 1)]);
    let key = to_hex(ids[2].as_bytes());
    let after_key = whole.windows(key.len()).position(|found| found == key.as_bytes()).unwrap() + key.len();
    let last = whole[..whole.len() - 1].iter().rposition(|byte| *byte == b'\n').unwrap() + 1;
    for cut in last..whole.len() - 1 {
        fs::write(&path, &whole[..cut]).unwrap();
        let (opened, found) = open(older(), dir.path());
        assert_eq!(jobs(&opened).len(), 2, "cut at {cut}");
        assert!(found.database_is_older, "cut at {cut}: {found:?}");
        assert_eq!(found.journal_is_incomplete, cut > last, "cut at {cut}: {found:?}");
        let is_named = found.doubtful_jobs == named(&[ids[2]]);
        assert_eq!(is_named, cut > after_key + 1, "cut at {cut}: {found:?}");
        // A database that fell back no further than the journal's last whole line.
        let level = stored(&[(ids[0], "queued", 1), (ids[1], "queued", 2)]);
        fs::write(&path, &whole[..cut]).unwrap();
        let (_, found) = open(level, dir.path());
        assert_eq!((found.database_is_older, found.journal_is_incomplete), (false, cut > last), "cut at {cut}");
    }
    // After a crash between the two, the database has the change.
    fs::write(&path, &whole[..after_key]).unwrap();
    let (_, found) = open(rows.rows, dir.path());
    assert_eq!(found, Findings::default());
}

#[test]
fn a_journal_that_lacks_what_the_database_has_proves_nothing() {
    let stored = || stored(&[("a", "a", 0), ("b", "b", 0), ("c", "c", 0)]);
    let without = tempfile::tempdir().unwrap();
    let empty = tempfile::tempdir().unwrap();
    fs::write(empty.path().join("jobs.log"), "").unwrap();
    let short = tempfile::tempdir().unwrap();
    fs::write(short.path().join("jobs.log"), "\ne3b0c44298fc1c14\n").unwrap();
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
    assert_eq!(open_with(stored(), older.path(), false, Findings::default()).1, Findings::default());
    let crashed = tempfile::tempdir().unwrap();
    fs::write(crashed.path().join("jobs.log"), "\ne3b0c44298fc1c14\n").unwrap();
    assert_eq!(open(super::tests::stored(&[("a", "a", 0)]), crashed.path()).1, Findings::default());
}

#[test]
fn an_empty_database_in_place_of_a_damaged_one_without_a_journal_is_told() {
    let dir = tempfile::tempdir().unwrap();
    let found = Findings { database_was_replaced: true, ..Findings::default() };
    assert!(open_with(MemoryRows::default(), dir.path(), false, found).1.journal_is_incomplete);
}
