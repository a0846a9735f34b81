//! `fsck` says what is wrong with a data folder and changes nothing in it.

use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
};

use crate::common::{
    SMALL,
    command::{Run, run},
    folder::contents,
    server::{Server, text},
};

/// The damage that is done to a data folder.
type Damage = Box<dyn Fn(&Path)>;

pub(super) fn write(files: &BTreeMap<PathBuf, Vec<u8>>) {
    for (path, bytes) in files {
        fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
        fs::write(path, bytes).expect("a file");
    }
}

/// Runs it on `data`, which must stay as it is.
#[track_caller]
fn fsck(data: &Path) -> Run {
    let before = contents(data);
    let run = run(data, ["fsck", "--data", "."]);
    assert!(contents(data) == before, "fsck has changed the folder: {run:#?}");
    run
}

/// The one file of a table below `data`.
fn blob(data: &Path) -> PathBuf {
    let blobs: Vec<PathBuf> = contents(&data.join("blobs")).into_keys().collect();
    assert_eq!(blobs.len(), 1, "{blobs:?}");
    blobs[0].clone()
}

/// Flips a bit in the middle of a file.
fn flip(path: &Path) {
    flip_at(path, |bytes| bytes.len() / 2);
}

/// Flips a bit of the byte `at`.
fn flip_at(path: &Path, at: impl Fn(&[u8]) -> usize) {
    let mut bytes = fs::read(path).expect("a file");
    let at = at(&bytes);
    bytes[at] ^= 1;
    fs::write(path, bytes).expect("a file");
}

/// Changes the row of a table without its hash.
fn spoil_row(data: &Path, digest: &str) {
    let pairs = digest
        .trim_start_matches("sha256:")
        .as_bytes()
        .chunks(2)
        .map(|pair| std::str::from_utf8(pair).expect("digits"));
    let key: Vec<u8> = pairs.map(|pair| u8::from_str_radix(pair, 16).expect("digits")).collect();
    let database = sled::open(data.join("db")).expect("a database");
    database.open_tree("tables").and_then(|rows| rows.insert(key, b"12345678another")).expect("a row");
    database.flush().expect("a disk");
}

#[test]
fn every_damage_is_named_and_mended_by_the_next_start() {
    let folder = tempfile::tempdir().expect("a folder");
    let data = folder.path().join("data");
    let server = Server::start(&data, &[]);
    let digest = server.fit(SMALL);
    let id = text(&server.get("/v1/jobs").with_status(200).json()["items"][0]["id"]).to_owned();
    assert_eq!(server.stop("TERM").code, Some(0));
    assert!(fsck(&data).exited(0).stdout.contains("nothing is wrong"));
    let whole = contents(&data);

    let of_table = |what: &str| format!("{digest}: {what}");
    let damages: Vec<(Damage, Vec<String>)> = vec![
        (Box::new(|data| flip(&blob(data))), vec![of_table("its file is damaged")]),
        (Box::new(|data| fs::remove_file(blob(data)).expect("a blob")), vec![of_table("its file is missing")]),
        (Box::new(|data| flip(&data.join("jobs.log"))), vec!["entries of the journal of jobs are damaged".to_owned()]),
        (
            Box::new(|data| fs::remove_file(data.join("jobs.log")).expect("a journal")),
            vec!["the journal of jobs is missing".to_owned()],
        ),
        (
            Box::new(|data| fs::write(data.join("jobs.log"), "").expect("a journal")),
            vec!["the journal of jobs is missing, empty".to_owned()],
        ),
        (
            Box::new(|data| flip_at(&data.join("jobs.log"), |bytes| bytes.len() - 5)),
            vec![format!("jobs whose last change is lost: {id}")],
        ),
        (
            Box::new({
                let digest = digest.clone();
                move |data| spoil_row(data, &digest)
            }),
            vec![
                "1 rows of the database do not match their hash".to_owned(),
                of_table("it is missing in the catalogue"),
            ],
        ),
        (
            Box::new(|data| fs::remove_dir_all(data.join("db")).expect("a database")),
            vec!["the database is damaged or missing".to_owned(), of_table("it is missing in the catalogue")],
        ),
        (
            Box::new(|data| {
                let database = data.join("db/db");
                let length = fs::metadata(&database).expect("a database").len();
                fs::write(database, vec![0x5a; usize::try_from(length).expect("a length")]).expect("a database");
            }),
            vec!["the database is damaged or missing".to_owned(), of_table("it is missing in the catalogue")],
        ),
    ];
    for (damage, told) in damages {
        fs::remove_dir_all(&data).expect("a folder");
        write(&whole);
        damage(&data);
        let run = fsck(&data).exited(3);
        for told in &told {
            assert!(run.stdout.contains(told), "{told}: {run:#?}");
        }
        assert!(run.stdout.contains("nothing was changed"), "{run:#?}");
        assert_eq!(run.stderr, "", "it tells all itself");
        let server = Server::start(&data, &[]);
        // A damaged table is found when it is read.
        server.get(&format!("/v1/tables/{digest}"));
        assert_eq!(server.stop("TERM").code, Some(0));
        assert!(fsck(&data).exited(0).stdout.contains("nothing is wrong"), "{told:?}");
    }
}

#[test]
fn a_folder_without_a_store_is_refused_and_none_is_made() {
    let folder = tempfile::tempdir().expect("a folder");
    let refused = fsck(folder.path()).exited(1);
    assert_eq!(refused.complaints(), [". has no jobs and tables of this service"]);
    // A folder of something else.
    fs::create_dir(folder.path().join("db")).expect("a folder");
    fs::write(folder.path().join("db/schema.sql"), "create table").expect("a file");
    fsck(folder.path()).exited(1);
    run(folder.path(), ["fsck", "--data", "none"]).exited(1);
}

#[test]
fn the_folder_of_a_running_service_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let _server = Server::start(folder.path(), &[]);
    let refused = run(folder.path(), ["fsck", "--data", "."]).exited(1);
    assert!(refused.complaints()[0].contains("in use by another process"), "{refused:#?}");
}
