//! No damage to one of database and journal reverts what was acknowledged.

use std::{
    fs,
    path::{Path, PathBuf},
};

use super::{Batch, Findings, Rows, Store, Tree, files, migrations, rows, sled_rows::open_sled};
use ltcforge_files::{digest::Digest, hex::to_hex};

const JOBS: u32 = 12;

/// How job `n` ends; `None` if it is forgotten.
fn end(n: u32) -> Option<&'static str> {
    [Some("cancelled"), Some("done"), Some("failed"), None][n as usize % 4]
}

fn value(n: u32, state: &str) -> String {
    format!("job {n} {state} {}", "x".repeat(600))
}

fn put(rows: &dyn Rows, n: u32, state: Option<&str>) {
    let mut batch = Batch::default();
    if let Some(state) = state {
        batch.put(Tree::Jobs, n.to_be_bytes(), value(n, state));
        batch.put(Tree::JobOrder, u64::from(n).to_be_bytes(), n.to_be_bytes());
    } else {
        batch.remove(Tree::Jobs, n.to_be_bytes());
        batch.remove(Tree::JobOrder, u64::from(n).to_be_bytes());
    }
    rows.commit(&batch).unwrap();
}

/// A folder in which every job was queued and then ended, as kill -9 leaves it; and copies of it from before each end.
struct Setting {
    dir: tempfile::TempDir,
    killed: PathBuf,
    earlier: Vec<PathBuf>,
}

fn setting() -> Setting {
    let dir = tempfile::tempdir().unwrap();
    let (open, killed) = (dir.path().join("open"), dir.path().join("killed"));
    let store = Store::open(&open).unwrap();
    (0..JOBS).for_each(|n| put(store.rows.as_ref(), n, Some("queued")));
    let mut earlier = Vec::new();
    for n in 0..JOBS {
        earlier.push(dir.path().join(format!("before-{n}")));
        files::copy_folder(&open, &earlier[n as usize]).unwrap();
        put(store.rows.as_ref(), n, end(n));
    }
    files::copy_folder(&open, &killed).unwrap();
    Setting { dir, killed, earlier }
}

impl Setting {
    /// Opens a changed copy of the folder `from`, and gives what was found and the jobs whose state is wrong.
    fn opened(&self, from: &Path, change: impl FnOnce(&Path)) -> (Findings, Vec<u32>) {
        let copy = self.dir.path().join("copy");
        let _ = fs::remove_dir_all(&copy);
        files::copy_folder(from, &copy).unwrap();
        change(&copy);
        let store = Store::open(&copy).unwrap();
        let is_right = |n: &u32| {
            let found = store.rows.get(Tree::Jobs, &n.to_be_bytes()).ok().flatten();
            found == end(*n).map(|state| value(*n, state).into_bytes())
        };
        let wrong = (0..JOBS).filter(|n| !is_right(n)).collect();
        (store.found, wrong)
    }

    fn quarantined(&self, name: &str) -> PathBuf {
        self.dir.path().join("copy/quarantine").join(name)
    }
}

fn older_database(from: &Path) -> impl Fn(&Path) {
    move |copy| {
        fs::remove_dir_all(copy.join("db")).unwrap();
        files::copy_folder(&from.join("db"), &copy.join("db")).unwrap();
    }
}

/// Whether the jobs `wrong` are forgotten ones that the database lacks, the journal has, and `found` names. Which of the two
/// is right cannot be told then, and a job too many is better than one too few.
fn are_forgotten_and_named(wrong: &[u32], found: &Findings) -> bool {
    let is_named = |n: &u32| found.restored_jobs.contains(&to_hex(&n.to_be_bytes()));
    wrong.iter().all(|n| end(*n).is_none() && is_named(n)) && (wrong.is_empty() || found.journal_is_incomplete)
}

/// The ends of a journal's lines.
fn line_ends(journal: &[u8]) -> Vec<usize> {
    let lines = journal.windows(2).enumerate().filter(|(_, pair)| pair[0] != b'\n' && pair[1] == b'\n');
    lines.map(|(at, _)| at + 2).collect()
}

#[test]
fn no_flipped_bit_of_the_database_reverts_the_end_of_a_job() {
    let setting = setting();
    let whole = fs::read(setting.killed.join("db/db")).unwrap();
    let used = whole.iter().rposition(|byte| *byte != 0).unwrap() + 1;
    let mut concerned = 0;
    for step in 0..96 {
        let at = used * step / 96;
        let mut bytes = whole.clone();
        bytes[at] ^= 1 << (step % 8);
        let flip = |copy: &Path| fs::write(copy.join("db/db"), bytes).unwrap();
        let (found, wrong) = setting.opened(&setting.killed, flip);
        assert!(wrong.is_empty(), "a bit at {at} of {used}: {wrong:?} {found:?}");
        concerned += usize::from(found != Findings::default());
    }
    assert!(concerned > 32, "only {concerned} of 96 flips concerned a job");
}

#[test]
fn an_older_database_beside_the_journal_is_told_and_brought_up_to_date() {
    let setting = setting();
    // The journal as it was written, and as the next start writes it anew.
    let started = setting.dir.path().join("started");
    files::copy_folder(&setting.killed, &started).unwrap();
    assert_eq!(Store::open(&started).unwrap().found, Findings::default());
    for from in [&setting.killed, &started] {
        for earlier in &setting.earlier {
            let (found, wrong) = setting.opened(from, older_database(earlier));
            assert!(wrong.is_empty(), "{}: {wrong:?} {found:?}", earlier.display());
            let ended = earlier.display().to_string();
            let first: u32 = ended.rsplit('-').next().unwrap().parse().unwrap();
            let reverted: Vec<String> = (first..JOBS).map(|n| to_hex(&n.to_be_bytes())).collect();
            assert_eq!(found.reverted_jobs, reverted, "{ended}");
            let kept = fs::read(setting.quarantined("jobs.log-1")).unwrap();
            assert!(kept == fs::read(from.join("jobs.log")).unwrap(), "{}", earlier.display());
            assert!(setting.quarantined("db-1/db").is_file());
        }
    }
}

#[test]
fn an_older_journal_beside_the_database_reverts_nothing_and_is_told() {
    let setting = setting();
    // The last one lacks the last entry alone, as after a crash between database and journal.
    for (n, earlier) in setting.earlier.iter().enumerate() {
        let older = |copy: &Path| {
            fs::copy(earlier.join("jobs.log"), copy.join("jobs.log")).unwrap();
        };
        let (found, wrong) = setting.opened(&setting.killed, older);
        assert!(are_forgotten_and_named(&wrong, &found), "{n}: {wrong:?} {found:?}");
        assert_eq!(found.journal_is_incomplete, n + 1 < JOBS as usize, "{n}: {found:?}");
    }
}

#[test]
fn a_journal_cut_after_any_line_is_noticed() {
    let setting = setting();
    let whole = fs::read(setting.killed.join("jobs.log")).unwrap();
    let ends = line_ends(&whole);
    assert_eq!(ends.len(), 1 + 2 * JOBS as usize);
    for (n, end) in ends.iter().enumerate() {
        let cut = |copy: &Path| fs::write(copy.join("jobs.log"), &whole[..*end]).unwrap();
        let (found, wrong) = setting.opened(&setting.killed, cut);
        assert!(are_forgotten_and_named(&wrong, &found), "cut after line {n}: {wrong:?} {found:?}");
        assert_eq!(found.journal_is_incomplete, n + 2 < ends.len(), "cut after line {n}: {found:?}");
        let without = |copy: &Path| {
            cut(copy);
            fs::remove_dir_all(copy.join("db")).unwrap();
        };
        let (found, _) = setting.opened(&setting.killed, without);
        assert!(found.database_was_replaced, "cut after line {n}, without a database: {found:?}");
    }
}

/// The jobs whose state is wrong in a folder as it was after `changes` changes: all jobs are queued first.
fn wrong_after(changes: usize) -> Vec<u32> {
    let jobs = JOBS as usize;
    let has_ended = |n: usize| changes > jobs + n;
    let is_right = |n: usize| has_ended(n) || (end(n as u32).is_none() && changes <= n);
    (0..jobs).filter(|n| !is_right(*n)).map(|n| n as u32).collect()
}

/// Whatever both have lost, the findings say that something is. Only where both end after the same change there is
/// nothing to tell by: that is the folder as it once was.
#[test]
fn no_cut_of_both_loses_a_job_without_a_word() {
    let setting = setting();
    let journal = fs::read(setting.killed.join("jobs.log")).unwrap();
    let database = fs::read(setting.killed.join("db/db")).unwrap();
    let used = database.iter().rposition(|byte| *byte != 0).unwrap() + 1;
    let mut concerned = 0;
    for cut in (5..100).step_by(5).map(|percent| journal.len() * percent / 100) {
        let cut_journal = |copy: &Path| fs::write(copy.join("jobs.log"), &journal[..cut]).unwrap();
        // The first line is the head. A crash between the two leaves the database one change ahead.
        let changes = line_ends(&journal[..cut]).len() - 1;
        let mut check = |what: &str, change: &dyn Fn(&Path)| {
            let (found, wrong) = setting.opened(&setting.killed, |copy| {
                change(copy);
                cut_journal(copy);
            });
            let is_told = found.database_was_replaced || found.database_is_older || found.journal_is_incomplete;
            let is_as_it_once_was = wrong == wrong_after(changes) || wrong == wrong_after(changes + 1);
            assert!(
                wrong.is_empty() || is_told || is_as_it_once_was,
                "{what}, journal cut at {cut}: {wrong:?} {found:?}"
            );
            concerned += usize::from(!wrong.is_empty() && is_told);
        };
        for percent in [20, 50, 80] {
            let kept = &database[..used * percent / 100];
            check(&format!("{percent} % of the database"), &|copy| fs::write(copy.join("db/db"), kept).unwrap());
        }
        for earlier in &setting.earlier {
            check(&earlier.display().to_string(), &older_database(earlier));
        }
    }
    assert!(concerned > 30, "only {concerned} cuts concerned a job");
}

/// What a start wrote anew states how many jobs there are.
#[test]
fn a_journal_written_anew_and_cut_is_noticed_even_beside_an_empty_database() {
    let setting = setting();
    drop(Store::open(&setting.killed).unwrap());
    let whole = fs::read(setting.killed.join("jobs.log")).unwrap();
    let ends = line_ends(&whole);
    assert!(ends.len() > JOBS as usize);
    for (n, end) in ends.iter().enumerate().take(ends.len() - 1) {
        for keeps_database in [true, false] {
            let cut = |copy: &Path| {
                fs::write(copy.join("jobs.log"), &whole[..*end]).unwrap();
                if !keeps_database {
                    fs::remove_dir_all(copy.join("db")).unwrap();
                }
            };
            let (found, wrong) = setting.opened(&setting.killed, cut);
            assert!(found.journal_is_incomplete, "cut after line {n}: {found:?}");
            assert_eq!(found.database_was_replaced, !keeps_database);
            assert!(wrong.is_empty() || !keeps_database, "cut after line {n}: {wrong:?} {found:?}");
        }
    }
}

#[test]
fn a_missing_database_beside_tables_counts_as_replaced() {
    let dir = tempfile::tempdir().unwrap();
    let store = Store::open(dir.path()).unwrap();
    store.blobs.put(b"table").unwrap();
    drop(store);
    fs::remove_dir_all(dir.path().join("db")).unwrap();
    fs::remove_file(dir.path().join("jobs.log")).unwrap();
    assert!(Store::open(dir.path()).unwrap().found.database_was_replaced);
    assert_eq!(Store::open(dir.path()).unwrap().found, Findings::default());
}

/// A folder that the schema before revisions left, with its journal.
#[test]
fn a_folder_without_revisions_is_taken_over_as_it_is() {
    let dir = tempfile::tempdir().unwrap();
    fs::create_dir(dir.path().join("blobs")).unwrap();
    let db = open_sled(&dir.path().join("db")).unwrap();
    migrations::apply(&db, &migrations::ALL[..3]).unwrap();
    let mut journal = "\ne3b0c44298fc1c14\n".to_owned();
    for (key, state) in [("a", "queued"), ("b", "queued"), ("a", "cancelled")] {
        db.open_tree("jobs").unwrap().insert(key, rows::seal("jobs", key.as_bytes(), state.as_bytes())).unwrap();
        let words = format!(" jobs {} {}", to_hex(key.as_bytes()), to_hex(state.as_bytes()));
        journal = format!("{journal}\n{}{words}\n", &Digest::of(words.as_bytes()).hex()[..16]);
    }
    drop(db);
    fs::write(dir.path().join("jobs.log"), journal).unwrap();
    for _ in 0..2 {
        let store = Store::open(dir.path()).unwrap();
        assert_eq!(store.found, Findings::default());
        for (key, state) in [("a", "cancelled"), ("b", "queued")] {
            assert_eq!(store.rows.get(Tree::Jobs, key.as_bytes()).unwrap().unwrap(), state.as_bytes());
        }
    }
    // What the database of the old schema lost comes from its journal.
    fs::remove_dir_all(dir.path().join("db")).unwrap();
    assert_eq!(Store::open(dir.path()).unwrap().found.restored_jobs, [to_hex(b"a"), to_hex(b"b")]);
}

/// A job that is submitted again after its end is newer than the end, in whichever of the two.
#[test]
fn a_new_submission_wins_over_an_earlier_end() {
    let setting = setting();
    let again = setting.dir.path().join("again");
    files::copy_folder(&setting.killed, &again).unwrap();
    let store = Store::open(&again).unwrap();
    put(store.rows.as_ref(), 0, Some("queued again"));
    put(store.rows.as_ref(), 3, Some("queued again"));
    drop(store);
    for database_is_older in [true, false] {
        let change = |copy: &Path| {
            if database_is_older {
                older_database(&setting.killed)(copy);
            } else {
                fs::copy(setting.killed.join("jobs.log"), copy.join("jobs.log")).unwrap();
            }
        };
        let (found, wrong) = setting.opened(&again, change);
        assert_eq!(wrong, [0, 3], "{found:?}");
        let store = Store::open(&setting.dir.path().join("copy")).unwrap();
        for n in [0, 3_u32] {
            let stored = store.rows.get(Tree::Jobs, &n.to_be_bytes()).unwrap().unwrap();
            assert_eq!(stored, value(n, "queued again").as_bytes());
        }
    }
}
