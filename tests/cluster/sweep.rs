//! `gc`: what nothing refers to.

use std::{
    fs::{self, File},
    path::PathBuf,
    time::{Duration, SystemTime},
};

use serde_json::Value;

use crate::{
    Shared, Worker,
    common::{SMALL, command::run},
};

#[test]
fn gc_tells_and_deletes_only_when_it_is_told_to() {
    let folder = tempfile::tempdir().expect("a folder");
    let Some(shared) = Shared::new(folder.path()) else { return };
    let of = |database: &str, more: &[&str]| {
        let args = ["gc", "--database", database, "--blobs", &shared.blobs, "--data", "gc"];
        run(folder.path(), args.iter().chain(more))
    };
    let gc = |more: &[&str]| of(&shared.database, more);
    assert!(gc(&[]).exited(1).stderr.contains("new to each other"));
    gc(&["--even-most"]).exited(2);

    let _worker = Worker::start(&shared, folder.path(), "60");
    let replica = shared.replica(&folder.path().join("one"));
    let table = replica.fit(SMALL);
    let store: PathBuf = shared.blobs.strip_prefix("file://").expect("a folder").into();
    let orphan = "ab".repeat(32);
    let file = store.join("ab").join(&orphan);
    fs::create_dir_all(store.join("ab")).expect("a folder");
    fs::write(&file, "an orphan").expect("a file");
    let long_ago = SystemTime::now() - Duration::from_secs(200_000);
    let hex = table.strip_prefix("sha256:").expect("a digest");
    for old in [&file, &store.join(&hex[..2]).join(hex)] {
        File::options().write(true).open(old).and_then(|old| old.set_modified(long_ago)).expect("a file");
    }

    let told = gc(&[]).exited(0).stdout;
    assert!(told.contains(&orphan) && told.contains("1 of 2 files, 9 of "), "{told}");
    assert!(file.exists());
    let empty = crate::throwaway::empty_database().expect("a database");
    for more in [&["--delete"][..], &["--delete", "--even-most"]] {
        assert!(of(&empty, more).exited(1).stderr.contains("do not belong together"));
    }
    let done: Value = serde_json::from_str(gc(&["--delete", "--json"]).exited(0).last_line()).expect("JSON");
    let going = &done["going"][0];
    assert_eq!((&done["files"], &done["removed"]), (&2.into(), &1.into()), "{done}");
    assert_eq!((&going["digest"], &going["reason"]), (&format!("sha256:{orphan}").into(), &"orphan".into()), "{done}");
    assert!(!file.exists());
    shared.replica(&folder.path().join("other")).get(&format!("/v1/tables/{table}")).with_status(200);
}
