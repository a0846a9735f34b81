//! `pull` makes a project agree with its lock file. Its sources may have nothing, other bytes, or an endless body.

use std::{
    ffi::OsStr,
    fs,
    io::{Read as _, Write as _},
    net::TcpListener,
    os::unix::{ffi::OsStrExt as _, fs::symlink},
    thread,
};

use serde_json::Value;

use super::project::{NOBODY, files_of, modified, pinned, project, pull, read};
use crate::common::{SMALL, command::run, server::Server};
use ltcforge::files::digest::Digest;

/// A server that answers every request with a status line, header fields and `body`.
fn answering(status: &'static str, body: &'static [u8]) -> String {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a free port");
    let url = format!("http://{}", listener.local_addr().expect("an address"));
    thread::spawn(move || {
        for stream in listener.incoming() {
            let mut stream = stream.expect("a connection");
            let _ = stream.read(&mut [0; 4096]);
            let head = format!("HTTP/1.1 {status}\r\nconnection: close\r\ncontent-length: {}\r\n\r\n", body.len());
            let _ = stream.write_all(head.as_bytes()).and_then(|()| stream.write_all(body));
        }
    });
    url
}

#[test]
fn exports_come_from_a_service_with_the_pinned_bytes() {
    let (folder, project) = project();
    let before = files_of(&project);
    let server = Server::start(&folder.path().join("data"), &[]);
    server.fit(SMALL);
    fs::remove_dir_all(project.join("assets/ltc")).expect("a folder");
    fs::write(project.join("assets/metal.safetensors"), "drifted").expect("a drifted file");
    let output = run(&project, ["pull", "--from", NOBODY, "--from", &server.url]).exited(0);
    assert!(output.stdout.starts_with("metal replaced: assets/metal.safetensors\nmetal downloaded: "), "{output:#?}");
    assert_eq!(files_of(&project), before);
    assert_eq!(server.metric("ltcforge_exports_total"), 1);

    // Correct files do not change, not even their modification times.
    let texture = project.join("assets/ltc/ltc_terms.ktx2");
    let time = modified(&texture);
    fs::remove_file(project.join("assets/ltc/ltc.json")).expect("a file");
    run(&project, ["pull", "--from", &server.url]).exited(0);
    assert_eq!((files_of(&project), modified(&texture)), (before, time));
}

#[test]
fn exports_that_no_service_has_are_made() {
    let (_folder, project) = project();
    let before = files_of(&project);
    let texture = project.join("assets/ltc/ltc_terms.ktx2");
    for url in [
        answering("200 OK", b"other bytes"),
        answering("404 Not Found", b"{}"),
        answering("503 Service Unavailable", b""),
        NOBODY.to_owned(),
    ] {
        fs::remove_file(&texture).expect("a file");
        let output = run(&project, ["pull", "--from", &url]).exited(0);
        assert!(output.stdout.contains("metal made: assets/ltc/ltc_terms.ktx2\n"), "{output:#?}");
        assert_eq!(files_of(&project), before);
    }
    // If a service or this program has another version, it makes other bytes than the pinned bytes, and reports it.
    let lock = read(&project.join("ltcforge.lock"));
    let pin = format!("digest = \"{}\" }}", Digest::of(&fs::read(&texture).expect("a texture")));
    let other = lock.replace(&pin, &format!("digest = \"{}\" }}", Digest::of(b"other")));
    fs::write(project.join("ltcforge.lock"), other).expect("a lock file");
    let server = Server::start(&project.join("data"), &[]);
    server.fit(SMALL);
    let refused = run(&project, ["pull", "--from", &server.url]).exited(3);
    assert!(refused.stderr.contains("this version makes sha256:"), "{refused:#?}");
    assert_eq!(Digest::of(&fs::read(&texture).expect("a texture")).to_string(), pin[10..10 + 71]);
}

#[test]
fn pull_restores_changed_files_and_locked_reports_them() {
    let (folder, project) = project();
    let before = files_of(&project);
    fs::create_dir(folder.path().join("tables")).expect("a folder");
    let hex = pinned(&project).replace("sha256:", "");
    fs::copy(project.join("assets/metal.safetensors"), folder.path().join(format!("tables/{hex}.safetensors")))
        .expect("a copy");
    let pinned = before.iter().filter(|(path, _)| path.extension().is_some_and(|name| name != "lock"));
    // Each file in turn is missing, changed or cut off. `--locked` reports each.
    for (i, (path, bytes)) in pinned.enumerate() {
        match i % 3 {
            0 => fs::remove_file(path).expect("a file"),
            1 => fs::write(path, "drifted").expect("a drifted file"),
            _ => fs::write(path, &bytes[..bytes.len() - 1]).expect("a file cut off"),
        }
        let drifted = files_of(&project);
        let output = run(&project, ["pull", "--locked"]).exited(3);
        let said = path.strip_prefix(&project).expect("a path below").display().to_string();
        assert!(output.complaints()[0].contains(&said), "{said}: {output:#?}");
        assert_eq!(files_of(&project), drifted, "--locked changes nothing");
        run(&project, ["pull", "--offline", "--from", "../tables"]).exited(0);
        assert_eq!(files_of(&project), before, "{}", path.display());
    }
}

#[test]
fn locked_lists_every_file_that_is_missing_or_changed() {
    let (_folder, project) = project();
    run(&project, ["lock", "other", "--recipe", "../small.json", "--to", "assets/other"]).exited(0);
    let mut pinned = files_of(&project.join("assets"));
    // The last file stays, all others are missing or changed.
    let (right, _) = pinned.pop().expect("a file");
    for (i, (path, _)) in pinned.iter().enumerate() {
        match i % 2 {
            0 => fs::remove_file(path).expect("a file"),
            _ => fs::write(path, "drifted").expect("a drifted file"),
        }
    }
    let below = |path: &std::path::Path| path.strip_prefix(&project).expect("a path below").display().to_string();
    let text = run(&project, ["pull", "--locked"]).exited(3);
    assert_eq!(text.complaints().len(), pinned.len(), "{text:#?}");
    let json = run(&project, ["pull", "--locked", "--json"]).exited(3);
    let documents: Vec<Value> =
        json.stdout.lines().map(|line| serde_json::from_str(line).expect("a document a line")).collect();
    assert_eq!(documents.len(), pinned.len() + 1, "{json:#?}");
    for path in pinned.iter().map(|(path, _)| path).chain([&right]) {
        let path_below = below(path);
        let line = documents.iter().find(|document| document["path"] == path_below.as_str()).expect("a document");
        let is_right = *path == right;
        assert_eq!(line["outcome"], if is_right { "unchanged" } else { "failed" }, "{line:#}");
        assert_eq!(line["detail"].as_str().is_some_and(|detail| detail.contains(&path_below)), !is_right, "{line:#}");
        assert_eq!(text.complaints().iter().any(|line| line.contains(&path_below)), !is_right, "{text:#?}");
    }
}

#[test]
fn the_name_of_a_folder_of_tables_need_not_be_utf_8() {
    let (folder, project) = project();
    let before = files_of(&project);
    let table = project.join("assets/metal.safetensors");
    let odd = OsStr::from_bytes(b"../odd\xff");
    fs::create_dir(project.join(odd)).expect("a folder");
    let name = format!("{}.safetensors", pinned(&project).trim_start_matches("sha256:"));
    fs::rename(&table, project.join(odd).join(name)).expect("a table");
    let from = |words: &[&str]| run(&project, words.iter().map(OsStr::new).chain([OsStr::new("--from"), odd]));
    from(&["pull", "--offline"]).exited(0);
    assert_eq!(files_of(&project), before);
    fs::remove_file(&table).expect("a file");
    from(&["lock", "--offline"]).exited(0);
    assert_eq!(files_of(&project), before, "the lock file names no folder of this machine");
    let escape = OsStr::from_bytes(b"odd\xff\x1b[2J");
    let refused = run(&project, [OsStr::new("pull"), OsStr::new("--from"), escape]).exited(2);
    assert!(!refused.stderr.contains('\x1b'), "{refused:#?}");
    drop(folder);
}

#[test]
fn sources_are_tried_in_order_and_wrong_bytes_are_rejected() {
    let (folder, project) = project();
    let table = project.join("assets/metal.safetensors");
    let right = fs::read(&table).expect("the table");
    let hex = Digest::of(&right).hex();
    let mut other = right.clone();
    other[100] ^= 1;
    for (name, bytes) in [("wrong", &other), ("right", &right)] {
        fs::create_dir(folder.path().join(name)).expect("a folder");
        fs::write(folder.path().join(name).join(format!("{hex}.safetensors")), bytes).expect("a file");
    }
    let from = |places: &[&str], code: i32| {
        let words = places.iter().flat_map(|place| ["--from", place]);
        run(&project, ["pull"].into_iter().chain(words)).exited(code)
    };
    fs::remove_file(&table).expect("a file");
    let none = from(&["../none"], 1);
    assert!(none.stderr.contains(&format!("../none/{hex}.safetensors")), "{none:#?}");
    from(&[NOBODY, "../none"], 4);
    let wrong = from(&["../wrong", NOBODY], 3);
    assert!(wrong.stderr.contains(&Digest::of(&other).to_string()), "{wrong:#?}");
    let offline = run(&project, ["pull", "--from", NOBODY, "--offline"]).exited(4);
    assert!(offline.stderr.contains("--offline sends no request to a server"), "{offline:#?}");
    assert!(!table.exists());
    let brought = from(&["../none", "../wrong", NOBODY, "../right"], 0);
    assert!(brought.stdout.starts_with("metal downloaded: assets/metal.safetensors\n"), "{brought:#?}");
    assert_eq!(fs::read(&table).expect("the table"), right);

    // The lock file and the configuration can also name sources.
    fs::remove_file(&table).expect("a file");
    let lock = read(&project.join("ltcforge.lock"));
    fs::write(project.join("ltcforge.lock"), lock.replace("version = 2\n", "version = 2\nsources = [\"../right\"]\n"))
        .expect("a lock file");
    run(&project, ["pull"]).exited(0);
    fs::remove_file(&table).expect("a file");
    fs::write(project.join("ltcforge.lock"), &lock).expect("a lock file");
    fs::write(project.join("ltcforge.toml"), "sources = [\"../none\", \"../right\"]\n").expect("a configuration");
    run(&project, ["pull"]).exited(0);
    assert_eq!(fs::read(&table).expect("the table"), right);
}

#[test]
fn a_table_without_a_source_is_fitted_again_and_checked_against_its_digest() {
    let (_folder, project) = project();
    let before = files_of(&project);
    fs::remove_dir_all(project.join("assets")).expect("a folder");
    let without = run(&project, ["pull", "--offline"]).exited(4);
    assert!(without.stderr.contains("--fit to fit the table from its recipe"), "{without:#?}");
    let fitted = run(&project, ["pull", "--offline", "--fit"]).exited(0);
    assert!(fitted.stdout.starts_with("metal fitted: assets/metal.safetensors\nmetal made: "), "{}", fitted.stdout);
    assert_eq!(files_of(&project), before);

    // Fitting the recipe of another table gives another digest. The failed pull leaves no files.
    let lock = read(&project.join("ltcforge.lock"));
    let other = lock.replace(&pinned(&project), &Digest::of(b"other").to_string());
    fs::write(project.join("ltcforge.lock"), other).expect("a lock file");
    let before = files_of(&project);
    let refused = run(&project, ["pull", "--offline", "--fit"]).exited(3);
    assert!(refused.stderr.contains("fitting the recipe gives sha256:"), "{refused:#?}");
    assert_eq!(files_of(&project), before);
}

#[test]
fn an_endless_table_is_cut_off_at_the_size_in_the_lock_file() {
    let folder = tempfile::tempdir().expect("a folder");
    let listener = TcpListener::bind("127.0.0.1:0").expect("a free port");
    let url = format!("http://{}", listener.local_addr().expect("an address"));
    thread::spawn(move || {
        for stream in listener.incoming() {
            let mut stream = stream.expect("a connection");
            let _ = stream.read(&mut [0; 4096]);
            let mut sent = stream.write_all(b"HTTP/1.1 200 OK\r\nconnection: close\r\n\r\n");
            while sent.is_ok() {
                sent = stream.write_all(&[0; 8192]);
            }
        }
    });
    let pin = format!("version = 1\n[[table]]\nname = \"metal\"\ndigest = \"{}\"\npath = \"t\"\n", Digest::of(b""));
    let lock = folder.path().join("ltcforge.lock");
    fs::write(&lock, format!("{pin}bytes = 1000000\n")).expect("a lock file");
    let refused = pull(folder.path(), &url, &[]).exited(3);
    assert!(refused.stderr.contains("longer than 1000000 bytes, the size that the lock file states"), "{refused:#?}");
    fs::write(&lock, pin).expect("a lock file");
    let refused = pull(folder.path(), &url, &["--table-limit", "2000000"]).exited(1);
    assert!(refused.stderr.contains("longer than 2000000 bytes, the limit for tables"), "{refused:#?}");
    assert_eq!(fs::read_dir(folder.path()).expect("the folder").count(), 1, "a temporary file is left");
}

#[test]
fn a_size_other_than_the_pinned_size_is_rejected_from_every_source() {
    let (folder, project) = project();
    let (table, texture) = ("assets/metal.safetensors", "assets/ltc/ltc_terms.ktx2");
    let hex = pinned(&project).replace("sha256:", "");
    fs::create_dir(folder.path().join("tables")).expect("a folder");
    let copy = folder.path().join(format!("tables/{hex}.safetensors"));
    fs::copy(project.join(table), copy).expect("a copy");
    let server = Server::start(&folder.path().join("data"), &[]);
    server.fit(SMALL);
    let lock = read(&project.join("ltcforge.lock"));
    let from_server = ["pull", "--from", &server.url];
    for (file, is_there, ways) in [
        (table, true, &[&["pull", "--offline"][..], &["pull", "--locked"]][..]),
        (table, false, &[&["pull", "--offline", "--from", "../tables"], &["pull", "--offline", "--fit"], &from_server]),
        (texture, true, &[&["pull", "--offline"], &["pull", "--locked"]]),
        (texture, false, &[&["pull", "--offline"], &from_server]),
    ] {
        let right = fs::read(project.join(file)).expect("a file");
        if !is_there {
            fs::remove_file(project.join(file)).expect("a file");
        }
        for bytes in [right.len() - 1, right.len() + 1, right.len() + 1000] {
            // In the lock file, the size is before the digest of a texture, but after the digest of a table.
            let digest = Digest::of(&right);
            let wrong = lock
                .replace(
                    &format!("digest = \"{digest}\"\nbytes = {}\n", right.len()),
                    &format!("digest = \"{digest}\"\nbytes = {bytes}\n"),
                )
                .replace(
                    &format!("bytes = {}, digest = \"{digest}\"", right.len()),
                    &format!("bytes = {bytes}, digest = \"{digest}\""),
                );
            assert_ne!(wrong, lock);
            fs::write(project.join("ltcforge.lock"), wrong).expect("a lock file");
            let before = files_of(&project);
            for words in ways {
                let refused = run(&project, *words).exited(3);
                assert!(refused.stderr.contains(&format!("{bytes}")), "{words:?}: {refused:#?}");
                assert_eq!(files_of(&project), before, "{words:?}");
            }
        }
        fs::write(project.join("ltcforge.lock"), &lock).expect("a lock file");
        fs::write(project.join(file), right).expect("a file");
    }
    run(&project, ["pull", "--locked"]).exited(0);
}

#[test]
fn a_wrong_pin_leaves_the_files_of_previous_pins_unchanged() {
    let (_folder, project) = project();
    fs::write(project.join("other.json"), SMALL.replace("\"alpha\":2", "\"alpha\":3")).expect("a recipe");
    run(&project, ["lock", "third", "--recipe", "../small.json", "--to", "assets/third"]).exited(0);
    run(&project, ["lock", "other", "--recipe", "other.json", "--to", "other/table"]).exited(0);
    let right = read(&project.join("ltcforge.lock"));
    let digest = Digest::of(&fs::read(project.join("other/table")).expect("the table"));
    fs::remove_dir_all(project.join("assets")).expect("a folder");
    fs::remove_dir_all(project.join("other")).expect("a folder");
    // Fitting the recipe of the last pin does not give its pinned digest.
    let wrong = right.replace(&digest.to_string(), &Digest::of(b"other").to_string());
    fs::write(project.join("ltcforge.lock"), wrong).expect("a lock file");
    let before = files_of(&project);
    let refused = run(&project, ["pull", "--offline", "--fit"]).exited(3);
    assert!(refused.stderr.contains("other: ") && refused.stdout.is_empty(), "{refused:#?}");
    assert_eq!(files_of(&project), before);
    assert!(!project.join("assets").exists(), "a folder is left");
    fs::write(project.join("ltcforge.lock"), right).expect("a lock file");
    let output = run(&project, ["pull", "--offline", "--fit"]).exited(0);
    assert!(output.stdout.contains("metal fitted: ") && output.stdout.contains("other fitted: "), "{output:#?}");
    run(&project, ["pull", "--locked"]).exited(0);
}

/// A pin in a lock file of version 1.
fn old_pin(name: &str, path: &str, bytes: &[u8]) -> String {
    format!("[[table]]\nname = \"{name}\"\npath = \"{path}\"\ndigest = \"{}\"\n", Digest::of(bytes))
}

#[test]
fn links_in_a_checkout_cannot_lead_to_files_of_version_control_or_editors() {
    let (folder, project) = project();
    let table = fs::read(project.join("assets/metal.safetensors")).expect("the table");
    fs::create_dir(folder.path().join("tables")).expect("a folder");
    let copy = folder.path().join(format!("tables/{}.safetensors", Digest::of(&table).hex()));
    fs::write(copy, &table).expect("a copy");
    for kept in [".git", ".vscode", ".hg"] {
        fs::create_dir(project.join(kept)).expect("a folder");
        fs::write(project.join(kept).join("config"), "ours").expect("a file");
    }
    for (link, to) in [("git", ".git".into()), ("nested", "git".into()), ("editor", project.join(".vscode"))] {
        symlink::<std::path::PathBuf, _>(to, project.join(link)).expect("a link");
    }
    let before = files_of(&project);
    for path in ["git/config", "nested/config", "editor/config", "git/new/config", ".hg/config", ".vscode/x"] {
        fs::write(project.join("other.lock"), format!("version = 1\n{}", old_pin("metal", path, &table)))
            .expect("a lock file");
        for command in
            [&["pull", "--offline", "--from", "../tables"][..], &["lock", "--offline", "--from", "../tables"]]
        {
            let refused = run(&project, command.iter().chain(&["--lock", "other.lock"])).exited(2);
            assert!(refused.stderr.contains("keep their own files"), "{path}: {refused:#?}");
        }
        fs::remove_file(project.join("other.lock")).expect("a file");
        assert_eq!(files_of(&project), before, "{path}");
    }
}

#[test]
fn only_the_files_of_a_pin_are_written() {
    let (folder, project) = project();
    let right = read(&project.join("ltcforge.lock"));
    let table = fs::read(project.join("assets/metal.safetensors")).expect("the table");
    let script = b"#!/bin/sh\ntouch stranger\n";
    fs::write(folder.path().join("other.json"), SMALL.replace("\"alpha\":2", "\"alpha\":3")).expect("a recipe");
    run(folder.path(), ["lock", "other", "--recipe", "other.json", "--to", "other"]).exited(0);
    let other = fs::read(folder.path().join("other")).expect("a table");
    fs::create_dir(folder.path().join("tables")).expect("a folder");
    for bytes in [&script[..], &other] {
        let name = format!("tables/{}.safetensors", Digest::of(bytes).hex());
        fs::write(folder.path().join(name), bytes).expect("a file");
    }
    let table_as = |bytes: &[u8]| {
        right.replace(
            &format!("digest = \"{}\"\nbytes = {}\n", Digest::of(&table), table.len()),
            &format!("digest = \"{}\"\nbytes = {}\n", Digest::of(bytes), bytes.len()),
        )
    };
    let line = |path: &str, bytes: &[u8]| {
        format!("    {{ path = \"{path}\", bytes = {}, digest = \"{}\" }},\n", bytes.len(), Digest::of(bytes))
    };
    let export_as = |path: &str| {
        let old = right.lines().find(|line| line.contains(path)).expect("a line");
        right.replace(&format!("{old}\n"), &line(path, script))
    };
    let (first, _) = right.split_once("    { path").expect("an export");
    let added = format!("{first}{}{}", line("assets/ltc/Makefile", script), &right[first.len()..]);
    let before = files_of(&project);
    for (wrong, missing, said) in [
        (table_as(script), "assets/metal.safetensors", "metal.safetensors: "),
        (table_as(&other), "assets/metal.safetensors", "the table's recipe has digest"),
        (export_as("assets/ltc/ltc_terms.ktx2"), "assets/ltc/ltc_terms.ktx2", "not a file of export wgpu"),
        (export_as("assets/ltc/ltc.json"), "assets/ltc/ltc.json", "not a file of export wgpu"),
        (export_as("assets/ltc/ltcforge.json"), "assets/ltc/ltcforge.json", "not a file of export wgpu"),
        (added, "assets/ltc/Makefile", "does not make this file"),
    ] {
        assert_ne!(wrong, right, "{said}");
        fs::write(project.join("ltcforge.lock"), wrong).expect("a lock file");
        let _ = fs::remove_file(project.join(missing));
        let held = files_of(&project);
        let server = answering("200 OK", script);
        let refused = run(&project, ["pull", "--from", "../tables", "--from", &server]).exited(3);
        assert!(refused.stderr.contains(said), "{said}: {refused:#?}");
        assert_eq!(files_of(&project), held, "{said}");
        for (path, bytes) in &before {
            fs::write(path, bytes).expect("a file");
        }
    }
    run(&project, ["pull", "--locked"]).exited(0);
}
