//! Texts and URLs with changes that people, editors and Git make.

use std::fs;

use super::project::{project, read};
use crate::common::{
    SMALL,
    command::{Run, run, run_with_stdin},
    server::Server,
};

#[test]
fn changes_of_git_to_pinned_files_are_reported_by_name() {
    let (_folder, project) = project();
    let manifest = project.join("assets/ltc/ltcforge.json");
    let right = read(&manifest);
    fs::write(&manifest, right.replace('\n', "\r\n")).expect("a file");
    let output = run(&project, ["pull", "--locked"]).exited(3);
    let line = "/assets/ltc/ltcforge.json -text";
    assert!(output.stderr.contains("core.autocrlf") && output.stderr.contains(&format!("«{line}»")), "{output:#?}");
    run(&project, ["pull", "--offline"]).exited(0);
    assert_eq!(read(&manifest), right);

    // In a Git checkout, `lock` prints lines for .gitattributes until the file contains them.
    fs::create_dir(project.join(".git")).expect("a folder");
    let output = run(&project, ["lock"]).exited(0);
    let (_, lines) = output.stdout.split_once("line endings:\n").expect("lines");
    assert!(lines.contains(line) && !lines.contains("ktx2") && !lines.contains("safetensors"), "{output:#?}");
    let json = run(&project, ["lock", "--json"]).exited(0);
    assert!(json.last_line().contains(r#""gitattributes":["#), "{json:#?}");
    fs::write(project.join(".gitattributes"), lines).expect("a file");
    let output = run(&project, ["lock"]).exited(0);
    assert!(!output.stdout.contains("-text"), "{output:#?}");

    // Pointers of Git LFS, of tables, exports and recipes.
    let pointer = "version https://git-lfs.github.com/spec/v1\noid sha256:00\nsize 7\n";
    let table = project.join("assets/metal.safetensors");
    fs::write(&table, pointer).expect("a file");
    fs::write(project.join("x.npy"), pointer).expect("a file");
    fs::write(project.join("brdf.safetensors"), pointer).expect("a file");
    fs::write(project.join("recipe.json"), pointer).expect("a file");
    fs::write(project.join("of.json"), r#"{"brdf":"tabulated","tabulated":"brdf.safetensors","layout":"kt2022"}"#)
        .expect("a recipe");
    for words in [
        &["pull", "--locked"][..],
        &["lock", "--offline"],
        &["verify", "assets/metal.safetensors"],
        &["export", "x.npy", "--for", "wgpu", "-o", "out"],
        &["fit", "recipe.json"],
        &["fit", "of.json"],
    ] {
        let output = run(&project, words);
        assert!(output.code != Some(0) && output.stderr.contains("git lfs pull"), "{words:?}: {output:#?}");
    }
    fs::write(project.join("recipe.json"), format!("<<<<<<< HEAD\n{SMALL}\n=======\n{SMALL}\n>>>>>>> other\n"))
        .expect("a recipe");
    let output = run(&project, ["fit", "recipe.json"]).exited(2);
    assert!(output.stderr.contains("merge marker"), "{output:#?}");
    let lock = read(&project.join("ltcforge.lock"));
    fs::write(project.join("ltcforge.lock"), format!("{lock}<<<<<<< HEAD\n=======\n>>>>>>> other\n")).expect("a file");
    let output = run(&project, ["pull"]).exited(2);
    assert!(output.stderr.contains("ltcforge.lock: line ") && output.stderr.contains("merge marker"), "{output:#?}");
}

#[test]
fn a_byte_order_mark_is_skipped() {
    let folder = tempfile::tempdir().expect("a folder");
    let marked = format!("\u{feff}{}", SMALL.replace('\n', "\r\n"));
    fs::write(folder.path().join("small.json"), &marked).expect("a recipe");
    fs::write(folder.path().join("ltcforge.toml"), "\u{feff}sources = ['tables']\r\n").expect("a configuration");
    run(folder.path(), ["fit", "small.json", "-o", "file"]).exited(0);
    run_with_stdin(folder.path(), ["fit", "-", "-o", "stdin"], &marked).exited(0);
    let server = Server::start(&folder.path().join("data"), &[]);
    let submitted = run(folder.path(), ["jobs", "submit", "small.json", "--server", &server.url]);
    submitted.exited(0);
    let utf_16: Vec<u8> = marked.encode_utf16().flat_map(u16::to_le_bytes).collect();
    fs::write(folder.path().join("small.json"), utf_16).expect("a recipe");
    let output = run(folder.path(), ["fit", "small.json"]).exited(2);
    assert!(output.stderr.contains("save it as UTF-8"), "{output:#?}");
}

/// For all errors, and for all places that contain the URL.
#[test]
fn no_error_shows_a_password_and_no_port_becomes_another() {
    let (_folder, project) = project();
    fs::remove_file(project.join("assets/metal.safetensors")).expect("a file");
    for url in ["http://127.0.0.1:99999", "http://127.0.0.1:0", "http://[::1]:65536"] {
        for words in [&["pull", "--from", url][..], &["pull", "--server", url], &["jobs", "list", "--server", url]] {
            let output = run(&project, words).exited(2);
            assert!(output.stderr.contains("the port must be a number from 1 to 65535"), "{output:#?}");
        }
    }
    let other = run(&project, ["pull", "--from", "ftp://host"]).exited(2);
    assert!(other.stderr.contains("ftp://host: this is not the URL of a server"), "{other:#?}");
    let lock = read(&project.join("ltcforge.lock"));
    for url in [
        "http://user:secret@127.0.0.1:9",
        "http://user:secret@127.0.0.1:99999",
        "http://user:sec ret@127.0.0.1:9",
        "ftp://user:secret@h",
        "http://user:secret/x@h",
    ] {
        let hidden = |output: &Run| {
            assert!(!output.stderr.contains("ret") && !output.stdout.contains("ret"), "{output:#?}");
        };
        let from = format!("--from={url}");
        for words in [
            &["pull", "--from", url][..],
            &["pull", &from],
            &["pull", "--server", url],
            &["pull", "--server", url, "--json"],
            &["lock", "--from", url],
            &["jobs", "list", "--server", url],
            &["pull", url],
            &["pull", url, "--json"],
            &["pull", &from, "--locked"],
        ] {
            let output = run(&project, words).exited(2);
            hidden(&output);
        }
        fs::write(
            project.join("ltcforge.lock"),
            lock.replace("version = 2", &format!("version = 2\nsources = [\"{url}\"]")),
        )
        .expect("a lock file");
        hidden(&run(&project, ["pull"]).exited(2));
        fs::write(project.join("ltcforge.lock"), &lock).expect("a lock file");
        for text in [format!("sources = [\"{url}\"]"), format!("server = \"{url}\"")] {
            fs::write(project.join("ltcforge.toml"), text).expect("a configuration");
            hidden(&run(&project, ["pull"]).exited(2));
        }
        fs::remove_file(project.join("ltcforge.toml")).expect("a file");
    }
}
