//! Pins, deleted tables, and what `gc` tells.

use std::{
    fs::{self, File},
    path::{Path, PathBuf},
    thread,
    time::{Duration, SystemTime},
};

use serde_json::{Value, json};

use super::clients::{host, request, send};
use crate::common::{
    SMALL,
    command::run,
    folder::contents,
    seeded,
    server::{Server, text},
};

const ADMIN: &[(&str, &str)] = &[];

#[test]
fn a_pin_keeps_a_table_from_being_deleted_and_a_deleted_one_is_fitted_again() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = Server::start(folder.path(), &[]);
    let table = server.fit(SMALL);
    let (path, film) = (format!("/v1/tables/{table}"), format!("/v1/tables/{table}/pins/film-2026"));
    let bytes = server.get(&path).with_status(200).body;
    let pin = server.request("PUT", &film, ADMIN, None).with_status(201).json();
    assert_eq!((&pin["table"], &pin["name"]), (&json!(table), &json!("film-2026")));
    assert_eq!(server.request("PUT", &film, ADMIN, None).with_status(200).json(), pin, "it stays as it was");
    let listed = server.get(&format!("{path}/pins")).with_status(200).json();
    assert_eq!(listed["items"], json!([{ "name": "film-2026", "created_at": pin["created_at"], "created_by": null }]));
    let refused = server.request("DELETE", &path, ADMIN, None).with_status(409).json();
    assert!(text(&refused["detail"]).contains("is pinned: film-2026;"), "{refused}");
    server.request("DELETE", &film, ADMIN, None).with_status(204);
    assert_eq!(server.request("DELETE", &film, ADMIN, None).with_status(404).json()["type"], "/problems/unknown-pin");
    let bad = server.request("PUT", &format!("{path}/pins/a%2Fb"), ADMIN, None).with_status(400).json();
    assert!(text(&bad["detail"]).contains("1 to 64 letters, digits and -_.@"), "{bad}");
    server.request("DELETE", &path, &[("if-match", "\"other\"")], None).with_status(412);
    let exports = format!("{path}/exports");
    let export = text(&server.get(&exports).with_status(200).json()["items"][0]["url"]).to_owned();
    server.get(&export).with_status(200);
    server.request("DELETE", &path, ADMIN, None).with_status(204);

    let below = ["/manifest", "/pins", "/exports", "/plots/error.png"].map(|below| format!("{path}{below}"));
    for gone in below.iter().chain([&path, &export]) {
        let told = server.get(gone).with_status(404).json();
        assert_eq!(told["type"], "/problems/removed-table", "{gone}: {told:#}");
        let detail = text(&told["detail"]);
        assert!(detail.contains(&table) && detail.contains("it was deleted; submit its recipe"), "{detail}");
    }
    for (method, path) in [("DELETE", &path), ("PUT", &film)] {
        let told = server.request(method, path, ADMIN, None).with_status(404).json();
        assert_eq!(told["type"], "/problems/removed-table");
    }
    let recipe = server.get(&path).json()["recipe"].to_string();
    assert_eq!(server.fit(&recipe), table, "the recipe that is told fits it again");
    assert_eq!(server.get(&path).with_status(200).body, bytes);
    server.request("PUT", &format!("/v1/tables/{}/pins/film", "0".repeat(64)), ADMIN, None).with_status(404);
}

#[test]
fn the_tables_of_a_lock_file_are_pinned_and_no_others() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = Server::start(&folder.path().join("data"), &[]);
    let [metal, paint] = [1, 2].map(|seed| server.fit(&seeded(seed)));
    let put = |lock: &str| server.request("PUT", "/v1/pins/film", &[], Some(lock.as_bytes()));
    // As the command writes it.
    let flags = ["--server", &server.url, "--to", "metal.safetensors"];
    run(folder.path(), ["lock", "metal", &metal].iter().chain(&flags)).exited(0);
    let written = fs::read_to_string(folder.path().join("ltcforge.lock")).expect("a lock file");
    let done = put(&written).with_status(200).json();
    let of_metal = json!({ "name": "metal", "table": metal });
    assert_eq!(done, json!({ "name": "film", "pinned": [of_metal], "unknown": [], "unpinned": [] }));

    let stranger = format!("sha256:{}", "ab".repeat(32));
    let table =
        |name: &str, digest: &str| format!("[[table]]\nname = '{name}'\npath = '{name}'\ndigest = '{digest}'\n");
    let next = format!("version = 1\n{}{}", table("paint", &paint), table("glass", &stranger));
    let done = put(&next).with_status(200).json();
    assert_eq!(done["pinned"], json!([{ "name": "paint", "table": paint }]));
    assert_eq!(done["unknown"], json!([{ "name": "glass", "table": stranger }]));
    assert_eq!(done["unpinned"], json!([metal]));
    server.request("DELETE", &format!("/v1/tables/{metal}"), &[], None).with_status(204);
    server.request("DELETE", &format!("/v1/tables/{paint}"), &[], None).with_status(409);

    for (bad, said) in
        [("version = 3", "version 3"), ("colour = 1", "version"), ("version = 1\n[[table]]\nname = 1", "name")]
    {
        let refused = put(bad).with_status(422).json();
        assert_eq!(refused["type"], "/problems/bad-lock");
        assert!(text(&refused["detail"]).contains(said), "{refused}");
    }
    let pins =
        || server.get(&format!("/v1/tables/{paint}/pins")).with_status(200).json()["items"].as_array().map(Vec::len);
    assert_eq!(pins(), Some(1), "a lock file with a fault changes nothing");
    assert_eq!(put("version = 2").with_status(200).json()["unpinned"], json!([paint]));
    assert_eq!(pins(), Some(0));
}

/// Wherever the process ends, each table is there whole, or known to be removed.
#[test]
fn kill_9_while_tables_are_deleted_leaves_nothing_wrong() {
    let folder = tempfile::tempdir().expect("a folder");
    let data = folder.path().join("data");
    for round in 0..6 {
        let server = Server::start(&data, &[]);
        let tables: Vec<String> = (0..3).map(|n| server.fit(&seeded(10 * round + n))).collect();
        let whole: Vec<_> = tables.iter().map(|table| server.get(&format!("/v1/tables/{table}")).body).collect();
        let asked: Vec<_> = tables
            .iter()
            .map(|table| send(&server, &request(&format!("DELETE /v1/tables/{table}"), &[("host", host(&server))])))
            .collect();
        thread::sleep(Duration::from_millis(u64::from(round) * 3));
        server.kill();
        drop(asked);
        let server = Server::start(&data, &[]);
        for (n, (table, whole)) in (0..).zip(tables.iter().zip(whole)) {
            let answer = server.get(&format!("/v1/tables/{table}"));
            match answer.status {
                200 => assert!(answer.body == whole),
                404 => assert_eq!(answer.json()["type"], "/problems/removed-table"),
                other => panic!("{other}: {answer:?}"),
            }
            assert_eq!(server.fit(&seeded(10 * round + n)), *table);
        }
        server.stop("TERM").exited(0);
        assert!(run(&data, ["fsck", "--data", "."]).exited(0).stdout.contains("nothing is wrong"));
    }
}

/// As if nothing below `folder` had been stored or used for so many seconds: what the database knows of uses is lost with it.
fn age(data: &Path, seconds: u64) {
    fs::remove_dir_all(data.join("db")).expect("a database");
    for path in contents(&data.join("blobs")).into_keys() {
        let then = SystemTime::now() - Duration::from_secs(seconds);
        File::options().write(true).open(path).and_then(|file| file.set_modified(then)).expect("a file");
    }
}

/// The file of a table in a data folder.
fn blob(data: &Path, table: &str) -> PathBuf {
    let hex = table.trim_start_matches("sha256:");
    data.join("blobs").join(&hex[..2]).join(hex)
}

#[test]
fn gc_tells_what_goes_from_a_data_folder_and_why_and_removes_it_when_it_is_told_to() {
    let folder = tempfile::tempdir().expect("a folder");
    let data = folder.path().join("data");
    let server = Server::start(&data, &[]);
    let [kept, gone] = [1, 2].map(|seed| server.fit(&seeded(seed)));
    server.request("PUT", &format!("/v1/tables/{kept}/pins/film"), &[], None).with_status(201);
    let gc = |more: &[&str]| run(&data, ["gc", "--data", ".", "--store-bytes", "1"].iter().chain(more));
    assert!(gc(&[]).exited(1).stderr.contains("in use by another process"));
    server.stop("TERM").exited(0);
    let told = gc(&["--dry-run"]).exited(0).stdout;
    let all: u64 = contents(&data.join("blobs")).values().map(|bytes| bytes.len() as u64).sum();
    let of_kept = fs::metadata(blob(&data, &kept)).expect("a file").len();
    let expected = [
        format!("none of 2 files, {all} bytes, would go"),
        format!("the store stays larger than --store-bytes, by {} bytes", all - 1),
        format!("{of_kept} bytes in 1 files stay: pinned"),
        format!("{} bytes in 1 files stay: used or stored lately", all - of_kept),
    ];
    assert_eq!(told.lines().collect::<Vec<_>>(), expected);
    age(&data, 9000);
    let before = contents(&data);
    let told = gc(&["--dry-run"]).exited(0);
    assert!(contents(&data) == before, "nothing is changed");
    let lines: Vec<&str> = told.stdout.lines().collect();
    assert_eq!(lines.len(), 4, "{told:?}");
    assert!(
        lines[0].starts_with(&gone)
            && lines[0].ends_with("used longest ago, and the store is larger than --store-bytes")
    );
    assert!(
        lines[1].starts_with("1 of 2 files, ") && lines[1].ends_with("would go; `--delete` removes them"),
        "{lines:?}"
    );
    gc(&["--dry-run", "--delete"]).exited(2);
    let done: Value = serde_json::from_str(gc(&["--delete", "--json"]).exited(0).last_line()).expect("JSON");
    assert_eq!((&done["files"], &done["removed"]), (&json!(2), &json!(1)));
    assert_eq!(done["kept"], json!([{ "reason": "pin", "files": 1, "bytes": of_kept }]));
    assert_eq!((&done["going"][0]["digest"], &done["going"][0]["reason"]), (&json!(gone), &json!("store_bytes")));
    assert_eq!(contents(&data.join("blobs")).len(), 1);

    // The service does the same by itself.
    let server = Server::start(&data, &["--store-bytes", "1"]);
    let told = server.get(&format!("/v1/tables/{gone}")).with_status(404).json();
    assert!(text(&told["detail"]).contains("`--store-bytes`"), "{told}");
    server.get(&format!("/v1/tables/{kept}")).with_status(200);
    assert_eq!(server.fit(&seeded(2)), gone);
}

#[test]
fn a_store_that_is_too_large_is_mended_by_a_start() {
    let folder = tempfile::tempdir().expect("a folder");
    let data = folder.path().join("data");
    let server = Server::start(&data, &[]);
    let table = server.fit(SMALL);
    server.stop("TERM").exited(0);
    age(&data, 9000);
    let server = Server::start(&data, &["--store-bytes", "1"]);
    let removed = || server.metric("ltcforge_files_removed_total");
    crate::common::eventually("the removal", || (removed() == 1).then_some(()));
    let told = server.get(&format!("/v1/tables/{table}")).with_status(404).json();
    assert_eq!(told["type"], "/problems/removed-table");
    assert_eq!(server.get("/v1/tables").json()["items"], json!([]));
}
