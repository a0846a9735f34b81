//! `fsck` says what is wrong with a database and a store that processes use, and changes nothing in them.

use std::{
    fs::{self, File},
    path::{Path, PathBuf},
    time::{Duration, SystemTime},
};

use serde_json::{Value, json};

use crate::{
    Shared, Worker,
    common::{
        SMALL,
        command::{Run, ltcforge, run},
        folder::contents,
        server::text,
    },
    throwaway,
};

/// Runs it on what is shared; it must stay as it is.
#[track_caller]
fn fsck(shared: &Shared, folder: &Path, more: &[&str]) -> Run {
    let before = contents(&shared.store());
    let run = run(folder, ["fsck"].iter().chain(&shared.arguments()).chain(more));
    assert!(contents(&shared.store()) == before, "fsck has changed the store: {run:#?}");
    assert!(!folder.join("ltcforge-data").exists(), "it has made a folder");
    run
}

/// The file of a blob.
fn file(shared: &Shared, digest: &str) -> PathBuf {
    let hex = digest.strip_prefix("sha256:").expect("a digest");
    shared.store().join(&hex[..2]).join(hex)
}

#[test]
fn every_fault_of_a_cluster_that_works_is_named() {
    let folder = tempfile::tempdir().expect("a folder");
    let (here, data) = (folder.path(), folder.path().join("one"));
    let Some(shared) = Shared::new(here) else { return };
    let psql = |statements: &str| throwaway::shared().expect("a server").psql(shared.name(), statements);
    let fsck = |more: &[&str]| fsck(&shared, here, more);
    assert!(fsck(&[]).exited(1).complaints()[0].contains("start `ltcforge serve`"));
    assert_eq!(psql("SELECT to_regnamespace('ltcforge') IS NULL"), "t", "nothing is made");

    let replica = shared.replica(&data);
    let worker = Worker::start(&shared, here, "60");
    let table = replica.fit(SMALL);
    drop(worker);
    replica.request("PUT", &format!("/v1/tables/{table}/pins/film"), &[], None).with_status(201);
    run(here, ["tabulate", "oren_nayar", "--alpha", "0.2,1", "-o", "eon.safetensors"]).exited(0);
    let brdf = fs::read(here.join("eon.safetensors")).expect("a file");
    let octets = [("content-type", "application/octet-stream")];
    let sent = replica.request("POST", "/v1/brdfs", &octets, Some(&brdf)).with_status(201).json();
    let brdf = text(&sent["digest"]).to_owned();
    let recipe = json!({ "brdf": "tabulated", "tabulated": brdf, "resolution": { "alpha": 2, "theta": 3 } });
    let waiting = text(&replica.submit(&recipe.to_string()).with_status(202).json()["id"]).to_owned();

    let sound = fsck(&[]).exited(0);
    assert_eq!(sound.stdout, "1 tables and 1 other files have the bytes of their digests\nnothing is wrong\n");
    assert_eq!(sound.stderr, "", "it tells all itself");
    let told: Value = serde_json::from_str(fsck(&["--json"]).exited(0).last_line()).expect("JSON");
    assert_eq!((&told["clean"], &told["tables"], &told["blobs"]), (&true.into(), &1.into(), &json!(shared.blobs)));

    for (damaged, missing) in [(&table, "its object is missing"), (&brdf, "this tabulated BRDF is missing")] {
        let file = file(&shared, damaged);
        let good = fs::read(&file).expect("a file");
        fs::remove_file(&file).expect("a file");
        let gone = fsck(&[]).exited(3).stdout;
        assert!(gone.contains(&format!("{damaged}: ")) && gone.contains(missing), "{gone}");
        let mut flipped = good.clone();
        flipped[good.len() / 2] ^= 1;
        fs::write(&file, flipped).expect("a file");
        let other = fsck(&[]).exited(3).stdout;
        assert!(other.contains(&format!("{damaged}: the store gives other bytes")), "{other}");
        assert!(!other.contains("missing"), "{other}");
        fs::write(&file, good).expect("a file");
    }

    let orphan = shared.store().join("ab").join("ab".repeat(32));
    fs::create_dir_all(shared.store().join("ab")).expect("a folder");
    fs::write(&orphan, "an orphan").expect("a file");
    let long_ago = SystemTime::now() - Duration::from_secs(200_000);
    File::options().write(true).open(&orphan).and_then(|old| old.set_modified(long_ago)).expect("a file");
    let told = fsck(&[]).exited(0).stdout;
    assert!(told.contains("nothing refers to 1 blobs, 9 bytes; `ltcforge gc --delete` removes them"), "{told}");

    psql(
        "DELETE FROM ltcforge.serving; DELETE FROM ltcforge.rows WHERE tree = 'tables_by_age'; \
         UPDATE ltcforge.totals SET tables = tables + 1",
    );
    let told = fsck(&[]).exited(3).stdout;
    for fault in [format!("job {waiting}: no worker"), format!("{table}: a row of this table"), "totals".to_owned()] {
        assert!(told.contains(&fault), "{fault}: {told}");
    }
    psql("DELETE FROM ltcforge.rows WHERE tree = 'tables'");
    let told = fsck(&[]).exited(3).stdout;
    for fault in [format!("{table}: it has a pin"), "the tables of 1 done jobs were removed".to_owned()] {
        assert!(told.contains(&fault), "{fault}: {told}");
    }
    psql("DELETE FROM ltcforge.migrations WHERE number = (SELECT max(number) FROM ltcforge.migrations)");
    assert!(fsck(&[]).exited(1).complaints()[0].contains("nothing is changed here"));
}

#[test]
fn what_the_environment_names_is_checked_and_never_a_folder_in_its_place() {
    let folder = tempfile::tempdir().expect("a folder");
    let here = folder.path();
    let Some(shared) = Shared::new(here) else { return };
    let in_cluster = |args: &[&str]| -> Run {
        let mut command = ltcforge(here, args);
        command.env("LTCFORGE_DATABASE", &shared.database).env("LTCFORGE_BLOBS", &shared.blobs);
        command.env("LTCFORGE_DATA", here.join("cache")).output().expect("the binary runs").into()
    };
    let complaint = |args: &[&str], code| in_cluster(args).exited(code).complaints().concat();
    drop(shared.replica(&here.join("cache")));
    let worker = Worker::start(&shared, here, "60");
    assert!(in_cluster(&["fsck"]).exited(0).stdout.contains("0 tables"));
    drop(worker);
    assert!(complaint(&["fsck", "--data", "none"], 1).contains("none: no such folder"));
    for (args, instead) in [(["backup", "copy"], "pg_dump -Fc"), (["restore", "copy"], "pg_restore")] {
        let refused = complaint(&args, 2);
        assert!(refused.contains(instead) && refused.contains("docs/scale.md"), "{refused}");
        assert!(complaint(&[&args[..], &["--data", "none"]].concat(), 1).contains("has no jobs and tables"));
    }
    let both = ["fsck", "--data", "none", "--database", &shared.database];
    assert!(in_cluster(&both).exited(2).stderr.contains("name one of them"));
    let alone = run(here, ["fsck", "--database", &shared.database]).exited(2);
    assert!(alone.complaints()[0].contains("--blobs is missing"), "{alone:#?}");
    assert!(!here.join("copy").exists() && !here.join("ltcforge-data").exists());
}
