use super::*;
use crate::store::Tree;
use ltcforge_files::digest::Digest;

fn open(dir: &Path) -> (Journal, Damage) {
    open_with(dir, vec![])
}

/// Opens the journal in `dir`, with jobs that an earlier version had elsewhere.
fn open_with(dir: &Path, earlier: Vec<Row>) -> (Journal, Damage) {
    let mut damage = Damage::default();
    let journal = Journal::open(&dir.join("jobs.log"), &dir.join("quarantine"), earlier, &mut damage).unwrap();
    (journal, damage)
}

/// The changes of some jobs; the value `-` removes one.
fn batch(changes: &[(&str, &str)]) -> Batch {
    let mut batch = Batch::default();
    for (key, value) in changes {
        match *value {
            "-" => batch.remove(Tree::Jobs, *key),
            value => batch.put(Tree::Jobs, *key, value),
        }
    }
    batch
}

fn row(key: &str, value: Option<&str>) -> Row {
    Row { key: key.into(), value: value.map(Into::into) }
}

fn jobs(journal: &Journal) -> Vec<String> {
    let rows = journal.rows(Tree::Jobs).unwrap();
    rows.into_iter().map(|row| String::from_utf8(row.value.unwrap()).unwrap()).collect()
}

/// A journal of four jobs, of which one has changed and one was removed.
fn four(dir: &Path) -> Journal {
    let (mut journal, damage) = open(dir);
    assert_eq!(damage, Damage::default());
    for key in ["a", "b", "c", "d"] {
        journal.append(&batch(&[(key, &format!("{key} queued"))]), true).unwrap();
    }
    journal.append(&batch(&[("b", "b running")]), false).unwrap();
    journal.append(&batch(&[("b", "b done"), ("c", "-")]), true).unwrap();
    journal
}

const AT_LAST: [&str; 3] = ["a queued", "b done", "d queued"];

#[test]
fn the_last_change_of_each_job_counts_and_a_start_writes_it_alone() {
    let dir = tempfile::tempdir().unwrap();
    let journal = four(dir.path());
    assert_eq!(jobs(&journal), AT_LAST);
    for _ in 0..2 {
        let (journal, damage) = open(dir.path());
        assert_eq!((jobs(&journal), damage), (AT_LAST.map(str::to_owned).to_vec(), Damage::default()));
    }
    let text = fs::read_to_string(dir.path().join("jobs.log")).unwrap();
    assert_eq!(text.lines().filter(|line| !line.is_empty()).count(), 1 + AT_LAST.len(), "{text}");
    assert!(!dir.path().join("quarantine").exists());
}

#[test]
fn a_journal_that_has_grown_too_long_is_written_anew() {
    let dir = tempfile::tempdir().unwrap();
    let mut journal = four(dir.path());
    journal.most = 0;
    journal.append(&batch(&[("e", "e queued")]), true).unwrap();
    let text = fs::read_to_string(dir.path().join("jobs.log")).unwrap();
    assert!(!text.contains(&to_hex(b"b running")), "{text}");
    assert_eq!(jobs(&journal)[..3], AT_LAST);
    assert_eq!(
        journal.most,
        MOST_APPENDED + journal.length - words(Tree::Jobs, b"e", Some(b"e queued")).len() as u64 - 18
    );
    drop(journal);
    assert_eq!(jobs(&open(dir.path()).0).len(), 4);
}

/// Only the state at the last fsync survives.
#[test]
fn a_power_cut_loses_nothing_acknowledged() {
    let dir = tempfile::tempdir().unwrap();
    let (path, disk) = (dir.path().join("jobs.log"), dir.path().join("disk"));
    fs::create_dir(&disk).unwrap();
    let mut journal = four(dir.path());
    let to = disk.join("jobs.log");
    journal.sync = Arc::new(move |_: &File| fs::copy(&path, &to).map(drop));
    journal.append(&batch(&[("e", "e queued")]), false).unwrap();
    assert!(!disk.join("jobs.log").exists(), "nobody waited for the disk");
    journal.append(&batch(&[("f", "f queued")]), true).unwrap();
    journal.append(&batch(&[("f", "f running")]), false).unwrap();
    assert_eq!(jobs(&open(&disk).0)[3..], ["e queued", "f queued"]);
}

#[test]
fn a_change_whose_fsync_fails_is_not_acknowledged_and_the_next_one_is() {
    let dir = tempfile::tempdir().unwrap();
    let mut journal = four(dir.path());
    journal.sync = Arc::new(|_: &File| Err(io::ErrorKind::StorageFull.into()));
    assert!(matches!(journal.append(&batch(&[("e", "e queued")]), true), Err(StoreError::DiskFull)));
    journal.sync = Arc::new(File::sync_data);
    journal.append(&batch(&[("f", "f queued")]), true).unwrap();
    assert_eq!(jobs(&open(dir.path()).0)[3..], ["f queued"]);
}

/// A line that could not be written, or not whole, was not acknowledged.
#[test]
fn after_a_failed_append_nothing_of_it_is_left() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("jobs.log");
    let mut journal = four(dir.path());
    let before = fs::read(&path).unwrap();
    let file = std::mem::replace(&mut journal.file, File::open(&path).unwrap());
    assert!(journal.append(&batch(&[("e", "e queued")]), true).is_err(), "the descriptor does not write");
    journal.file = file;
    journal.file.write_all(b"\nhalf a li").unwrap();
    journal.append(&batch(&[("f", "f queued")]), true).unwrap();
    assert!(fs::read(&path).unwrap().starts_with(&before));
    let (journal, damage) = open(dir.path());
    assert_eq!((jobs(&journal).len(), damage), (4, Damage::default()));
    assert_eq!(jobs(&journal)[3], "f queued");
}

/// Opens the journal in `dir` with other bytes.
fn with_bytes(dir: &Path, bytes: &[u8]) -> (Journal, Damage) {
    fs::write(dir.join("jobs.log"), bytes).unwrap();
    open(dir)
}

#[test]
fn every_flipped_bit_is_found_costs_one_line_at_most_and_names_its_jobs() {
    let dir = tempfile::tempdir().unwrap();
    drop(four(dir.path()));
    let whole = fs::read(dir.path().join("jobs.log")).unwrap();
    let places: Vec<_> = (0..whole.len()).filter(|at| whole[*at] != b'\n').collect();
    for (n, at) in places.into_iter().enumerate() {
        let mut bytes = whole.clone();
        bytes[at] ^= 1 << (n % 8);
        let (journal, damage) = with_bytes(dir.path(), &bytes);
        // A bit may also make a line break, and two damaged lines of one.
        assert!((1..=2).contains(&damage.damaged_journal_entries), "byte {at}: {damage:?}");
        let found = jobs(&journal);
        let missing = AT_LAST.iter().filter(|job| !found.iter().any(|found| found == *job)).count();
        assert!(missing <= 1, "byte {at}: {found:?}");
        let line = whole[..at].split(|byte| *byte == b'\n').count() / 2 - 1;
        let is_key = |key: &str| {
            let word = format!(" jobs {} ", to_hex(key.as_bytes()));
            let ends = whole.windows(word.len()).enumerate().filter(|(_, found)| *found == word.as_bytes());
            ends.into_iter().any(|(start, _)| (start..start + word.len()).contains(&at))
        };
        // Lines 1, 4 and 6 are the last ones of jobs a, d, and b with c; a job whose name is damaged is not named.
        for (key, last) in [("a", 1), ("d", 4), ("b", 6), ("c", 6)] {
            let is_named = damage.lost_jobs.contains(&to_hex(key.as_bytes()));
            assert!(is_named == (line == last) || is_key(key), "byte {at}, job {key}: {damage:?}");
        }
        // It was written anew.
        assert_eq!(open(dir.path()).1, Damage::default());
        assert_eq!(jobs(&open(dir.path()).0), found);
    }
}

#[test]
fn a_damaged_journal_is_copied_to_quarantine_before_it_is_written_anew() {
    let dir = tempfile::tempdir().unwrap();
    drop(four(dir.path()));
    let mut bytes = fs::read(dir.path().join("jobs.log")).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    assert_eq!(with_bytes(dir.path(), &bytes).1.damaged_journal_entries, 1);
    assert_eq!(fs::read(dir.path().join("quarantine/jobs.log-1")).unwrap(), bytes);
    assert_eq!(open(dir.path()).1, Damage::default());
    assert!(!dir.path().join("quarantine/jobs.log-2").exists());
}

#[test]
fn a_line_that_was_cut_off_hides_no_other() {
    let dir = tempfile::tempdir().unwrap();
    drop(four(dir.path()));
    let whole = fs::read(dir.path().join("jobs.log")).unwrap();
    let last = whole[..whole.len() - 1].iter().rposition(|byte| *byte == b'\n').unwrap() + 1;
    for cut in last + 1..whole.len() - 1 {
        let (mut journal, damage) = with_bytes(dir.path(), &whole[..cut]);
        assert_eq!(jobs(&journal), ["a queued", "b running", "c queued", "d queued"], "cut at {cut}");
        assert_eq!(damage.damaged_journal_entries, 1);
        journal.append(&batch(&[("e", "e queued")]), true).unwrap();
        assert_eq!(jobs(&open(dir.path()).0).len(), 5);
    }
}

#[test]
fn a_journal_that_lacks_lines_of_the_last_start_is_told() {
    let dir = tempfile::tempdir().unwrap();
    drop(four(dir.path()));
    drop(open(dir.path()));
    let whole = fs::read(dir.path().join("jobs.log")).unwrap();
    let ends: Vec<usize> = (2..whole.len()).filter(|at| whole[..*at].ends_with(b"\n\n")).map(|at| at - 1).collect();
    assert_eq!(ends.len(), AT_LAST.len());
    for (n, end) in ends.into_iter().enumerate() {
        let (journal, damage) = with_bytes(dir.path(), &whole[..end]);
        assert_eq!((jobs(&journal).len(), damage), (n, Damage { journal_is_incomplete: true, ..Damage::default() }));
        assert!(dir.path().join(format!("quarantine/jobs.log-{}", n + 1)).exists());
        assert_eq!(open(dir.path()).1, Damage::default());
    }
}

/// Seals, revisions, a tree `job_order` and a head with a revision: the journal of an earlier version.
#[test]
fn another_file_in_its_place_is_told_to_lose_jobs_and_kept() {
    for other in [&b"{}"[..], &[0; 100], b"\nnonsense\n"] {
        let dir = tempfile::tempdir().unwrap();
        drop(four(dir.path()));
        let (journal, damage) = with_bytes(dir.path(), other);
        assert!(jobs(&journal).is_empty());
        assert!(damage.journal_is_incomplete && damage.damaged_journal_entries > 0, "{damage:?}");
        assert_eq!(fs::read(dir.path().join("quarantine/jobs.log-1")).unwrap(), other);
    }
}

#[test]
fn a_fifo_in_its_place_is_refused_and_not_waited_for() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("jobs.log");
    rustix::fs::mknodat(rustix::fs::CWD, &path, rustix::fs::FileType::Fifo, rustix::fs::Mode::RWXU, 0).unwrap();
    let refused = Journal::open(&path, &dir.path().join("quarantine"), vec![], &mut Damage::default());
    assert!(refused.err().unwrap().to_string().contains("is not a regular file"));
}

#[test]
fn journals_of_earlier_versions_are_read() {
    let dir = tempfile::tempdir().unwrap();
    let of = |words: &[&str]| words.iter().map(|words| line(words)).collect::<String>();
    let without_revisions = of(&[
        "",
        " jobs 61 00 job_order 31 61",
        " jobs 62 01 job_order 32 62",
        " jobs 61 02",
        " jobs 62 - job_order 32 -",
    ]);
    let with_revisions = of(&[" head 7 2", " 4 jobs 61 00", " 4 job_order 31 61", " 8 job_order 31 - jobs 61 02"]);
    for journal in [without_revisions, with_revisions] {
        let (journal, damage) = with_bytes(dir.path(), journal.as_bytes());
        assert_eq!((journal.rows(Tree::Jobs).unwrap(), damage), (vec![row("a", Some("\u{2}"))], Damage::default()));
    }
}

#[test]
fn jobs_of_earlier_versions_are_added_unless_the_journal_mentions_them() {
    let dir = tempfile::tempdir().unwrap();
    drop(four(dir.path()));
    let earlier = [("a", Some("a old")), ("b", None), ("c", Some("c old")), ("x", Some("x old")), ("y", None)];
    let earlier = earlier.map(|(key, value)| row(key, value)).to_vec();
    let (journal, damage) = open_with(dir.path(), earlier);
    assert_eq!(jobs(&journal), ["a queued", "b done", "d queued", "x old"]);
    assert_eq!(damage, Damage { lost_jobs: vec![to_hex(b"y")], ..Damage::default() });
}

#[test]
fn pins_are_beside_the_jobs_and_a_damaged_line_names_its_pin() {
    let dir = tempfile::tempdir().unwrap();
    let mut journal = four(dir.path());
    let table = Digest::of(b"table");
    let key = |name: &[u8]| [table.as_bytes().as_slice(), name].concat();
    for name in [b"film".as_slice(), b"game", b"gone"] {
        let mut batch = Batch::default();
        batch.put(Tree::Pins, key(name), "pin");
        journal.append(&batch, true).unwrap();
    }
    let mut removal = Batch::default();
    removal.remove(Tree::Pins, key(b"gone"));
    journal.append(&removal, true).unwrap();
    let names =
        |journal: &Journal| journal.rows(Tree::Pins).unwrap().into_iter().map(|row| row.key).collect::<Vec<_>>();
    assert_eq!(names(&journal), [key(b"film"), key(b"game")]);
    let (journal, damage) = open(dir.path());
    assert_eq!(
        (names(&journal), jobs(&journal), damage),
        (vec![key(b"film"), key(b"game")], AT_LAST.map(str::to_owned).to_vec(), Damage::default(),)
    );
    let path = dir.path().join("jobs.log");
    let text = fs::read_to_string(&path).unwrap();
    fs::write(&path, text.replacen(&to_hex(b"pin"), &to_hex(b"pan"), 1)).unwrap();
    let (journal, damage) = open(dir.path());
    assert_eq!(damage.lost_pins, [format!("{table} film")]);
    assert_eq!((names(&journal), damage.lost_jobs.len()), (vec![key(b"game")], 0));
}
