//! Damaged files are never served. They are created again if possible.

use std::{
    fs,
    path::{Path, PathBuf},
};

use crate::common::{SMALL, server::Server};

/// Every file below `folder`.
fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path());
    entries.flat_map(|path| if path.is_dir() { files(&path) } else { vec![path] }).collect()
}

/// The files below `folder` with exactly these bytes.
fn holding(folder: &Path, bytes: &[u8]) -> Vec<PathBuf> {
    files(folder).into_iter().filter(|path| fs::read(path).is_ok_and(|found| found == bytes)).collect()
}

/// Fits a table, stops the service, and flips a bit of the table's file. Returns the digest, the bytes before and
/// after, and the path.
fn damage(folder: &Path) -> (String, Vec<u8>, Vec<u8>, PathBuf) {
    let server = Server::start(folder, &[]);
    let digest = server.fit(SMALL);
    let good = server.get(&format!("/v1/tables/{digest}")).with_status(200).body;
    assert_eq!(server.stop("TERM").code, Some(0));

    let blobs = holding(folder, &good);
    assert_eq!(blobs.len(), 1, "{blobs:?}");
    let mut bad = good.clone();
    let middle = bad.len() / 2;
    bad[middle] ^= 1;
    fs::write(&blobs[0], &bad).expect("a damaged blob");
    (digest, good, bad, blobs[0].clone())
}

#[test]
fn a_damaged_table_is_quarantined_reported_and_fitted_again() {
    let folder = tempfile::tempdir().expect("a folder");
    let (digest, good, bad, blob) = damage(folder.path());
    let path = format!("/v1/tables/{digest}");
    let server = Server::start(folder.path(), &[]);
    assert_eq!(server.get(&path).with_status(500).json()["type"], "/problems/damaged-blob");
    assert_eq!(server.metric("ltcforge_blobs_corrupt_total"), 1);
    let aside = holding(folder.path(), &bad);
    assert_eq!(aside.len(), 1, "the damaged bytes must be kept");
    assert_ne!(aside, [blob], "in the quarantine folder");
    server.get(&path).with_status(404);

    server.submit(SMALL).with_status(202);
    assert_eq!(server.fit(SMALL), digest);
    assert_eq!(server.get(&path).with_status(200).body, good);
}

#[test]
fn the_manifest_of_a_damaged_table_is_not_served() {
    let folder = tempfile::tempdir().expect("a folder");
    let (digest, _, bad, blob) = damage(folder.path());
    let path = format!("/v1/tables/{digest}/manifest");
    let server = Server::start(folder.path(), &[]);
    assert_eq!(server.get(&path).with_status(500).json()["type"], "/problems/damaged-blob");
    assert_eq!(server.metric("ltcforge_blobs_corrupt_total"), 1);
    let quarantined = holding(folder.path(), &bad);
    assert_eq!(quarantined.len(), 1, "the damaged bytes must be kept");
    assert_ne!(quarantined[0], blob, "in the quarantine folder");
    server.get(&path).with_status(404);
    assert_eq!(server.get("/v1/tables").with_status(200).json()["items"], serde_json::json!([]));

    // The next equal job creates the table and its manifest again.
    assert_eq!(server.fit(SMALL), digest);
    assert_eq!(server.get(&path).with_status(200).json()["table"], digest);
}

#[test]
fn a_table_whose_blob_is_missing_has_no_manifest() {
    let folder = tempfile::tempdir().expect("a folder");
    let (digest, _, _, blob) = damage(folder.path());
    fs::remove_file(blob).expect("the blob");
    let server = Server::start(folder.path(), &[]);
    for path in [format!("/v1/tables/{digest}/manifest"), format!("/v1/tables/{digest}")] {
        let problem = server.get(&path).with_status(404).json();
        assert_eq!(problem["type"], "/problems/removed-table");
        assert_eq!(problem["recipe"]["brdf"], "ggx", "{problem}");
    }
}

#[test]
fn a_damaged_table_has_no_picture() {
    let folder = tempfile::tempdir().expect("a folder");
    let (digest, ..) = damage(folder.path());
    let server = Server::start(folder.path(), &["--adapter", "cpu"]);
    let picture = format!("/v1/preview?size=64&table={digest}");
    assert_eq!(server.get(&picture).with_status(500).json()["type"], "/problems/damaged-blob");
    server.get(&picture).with_status(404);
    assert_eq!(server.fit(SMALL), digest);
    server.get(&picture).with_status(200);
}
