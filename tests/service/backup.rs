//! A copy of a data folder, made while the service runs, has everything that was acknowledged before.

use std::{
    fs,
    path::{Path, PathBuf},
};

use super::brdfs::OCTETS;
use crate::common::{
    LARGE,
    command::{Run, run, run_with_stdin},
    folder::contents,
    seeded,
    server::{Server, text},
};

fn backup(folder: &Path) -> Run {
    run(folder, ["backup", "copy", "--data", "data"])
}

/// The files of the tables and BRDFs in `folder`.
fn blobs(folder: &Path) -> Vec<PathBuf> {
    contents(&folder.join("blobs")).into_keys().collect()
}

#[test]
fn a_copy_of_a_running_service_is_restored_whole() {
    let folder = tempfile::tempdir().expect("a folder");
    let (here, data) = (folder.path(), folder.path().join("data"));
    let expected = run_with_stdin(here, ["fit", "-", "-o", "fitted"], LARGE).exited(0);
    let made = run(here, ["tabulate", "oren_nayar", "--alpha", "0.2,1", "-o", "eon.safetensors"]).exited(0);
    let brdf = fs::read(here.join("eon.safetensors")).expect("a file");
    let server = Server::start(&data, &["--workers", "1"]);
    server.request("POST", "/v1/brdfs", &[OCTETS], Some(&brdf)).with_status(201);
    let first = server.fit(&seeded(0));
    let pins = format!("/v1/tables/{first}/pins");
    server.request("PUT", &format!("{pins}/film"), &[], None).with_status(201);
    let pinned = server.get(&pins).with_status(200).json();
    assert_eq!(backup(here).exited(0).last_line(), "2 files were copied, 0 were there");

    // While a job runs and others end; each copy has what was acknowledged before it.
    let large = text(&server.submit(LARGE).with_status(202).json()["id"]).to_owned();
    let (mut ids, mut digests) = (vec![large.clone()], vec![first]);
    for seed in 1..4 {
        let id = text(&server.submit(&seeded(seed)).with_status(202).json()["id"]).to_owned();
        digests.push(text(&server.finished(&id)["table"]).to_owned());
        ids.push(id);
        backup(here).exited(0);
    }
    let bytes: Vec<_> =
        digests.iter().map(|digest| server.get(&format!("/v1/tables/{digest}")).with_status(200).body).collect();
    let refused = run(here, ["restore", "copy", "--data", "data"]).exited(1);
    assert!(refused.complaints()[0].contains("data has jobs and tables already"), "{refused:#?}");
    server.kill();
    fs::remove_dir_all(&data).expect("a folder");

    run(here, ["restore", "copy", "--data", "data"]).exited(0);
    let server = Server::start(&data, &[]);
    for (digest, bytes) in digests.iter().zip(bytes) {
        assert!(server.get(&format!("/v1/tables/{digest}")).with_status(200).body == bytes, "{digest}");
        server.get(&format!("/v1/tables/{digest}/manifest")).with_status(200);
    }
    assert_eq!(server.get(&format!("/v1/brdfs/{}", made.last_line())).with_status(200).body, brdf);
    assert_eq!(server.get(&pins).with_status(200).json(), pinned);
    for id in &ids {
        assert_eq!(server.finished(id)["state"], "done", "{id}");
    }
    assert_eq!(server.finished(&large)["table"], expected.last_line());
    server.stop("TERM").exited(0);
    assert!(run(here, ["fsck", "--data", "data"]).exited(0).stdout.contains("nothing is wrong"));
}

#[test]
fn damage_is_not_copied_and_a_folder_in_use_is_not_written() {
    let folder = tempfile::tempdir().expect("a folder");
    let (here, data) = (folder.path(), folder.path().join("data"));
    run(here, ["backup", "copy", "--data", "data"]).exited(1);
    let server = Server::start(&data, &[]);
    let digest = server.fit(&seeded(0));
    let blob = blobs(&data).pop().expect("a blob");
    let good = fs::read(&blob).expect("a file");
    fs::write(&blob, &good[1..]).expect("a file");
    let told = backup(here).exited(3).stdout;
    assert!(told.contains(&format!("{digest}: its file is damaged and was not copied")), "{told}");
    assert!(!here.join("copy/blobs").exists());
    fs::write(&blob, good).expect("a file");
    assert_eq!(backup(here).exited(0).last_line(), "1 files were copied, 0 were there");
    assert_eq!(backup(here).exited(0).last_line(), "0 files were copied, 1 were there");

    let _other = Server::start(&here.join("other"), &[]);
    let refused = run(here, ["backup", "other", "--data", "data"]).exited(1);
    assert!(refused.complaints()[0].contains("in use by another process"), "{refused:#?}");
}
