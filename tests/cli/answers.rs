//! The input and output of commands: points, JSON and errors.

use std::{
    fs,
    io::{BufRead as _, BufReader},
    os::unix::fs::symlink,
};

use rustix::fs::{CWD, FileType, Mode, mknodat};
use serde_json::Value;

use crate::common::{
    SMALL,
    command::{Run, ltcforge, run, run_with_stdin},
};

/// The error document of a run with `--json`: one line on standard error.
#[track_caller]
fn error(run: &Run) -> Value {
    let errors: Vec<Value> = run.stderr.lines().filter_map(|line| serde_json::from_str(line).ok()).collect();
    let [error] = errors.as_slice() else { panic!("{} documents: {run:#?}", errors.len()) };
    assert_eq!(error["exit"].as_i64(), run.code.map(i64::from));
    assert!(run.complaints().is_empty(), "{run:#?}");
    error.clone()
}

#[test]
fn with_json_an_error_is_one_document() {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("bad.json"), r#"{"preset":"draft","colour":1,"terms":7}"#).expect("a recipe");
    let cases: [(&[&str], i32, &str); 9] = [
        (&["fit"], 2, "required arguments"),
        (&["fit", "draft", "--colour"], 2, "--colour"),
        (&["fit", "./bad.json"], 2, "/colour"),
        (&["verify", "./none"], 1, "none"),
        (&["report", "./none"], 1, "none"),
        (&["pull"], 1, "ltcforge.lock"),
        (&["jobs", "list", "--server", "http://127.0.0.1:9"], 4, "unavailable"),
        (&["jobs", "list", "--server", "here"], 2, "here: this is not the URL"),
        (&["shader", "--language", "wgsl", "--layout", "kt2022", "-o", "none/s"], 1, "none/s"),
    ];
    for (words, code, said) in cases {
        let failed = run(folder.path(), words.iter().chain(&["--json"])).exited(code);
        let output = error(&failed);
        assert!(output["error"].as_str().is_some_and(|text| text.contains(said)), "{output}");
    }
    assert!(run(folder.path(), ["--json", "--help"]).exited(0).stdout.starts_with("Lookup tables (LTC)"));
}

#[test]
fn every_command_prints_json() {
    let folder = tempfile::tempdir().expect("a folder");
    let printed = run(folder.path(), ["completions", "bash", "--json"]).exited(0);
    let output: Value = serde_json::from_str(&printed.stdout).expect("JSON");
    assert_eq!(output["shell"], "bash");
    assert!(output["script"].as_str().is_some_and(|script| script.contains("ltcforge")));

    let words = ["serve", "--listen", "127.0.0.1:0", "--data", "data", "--json"];
    let mut child = ltcforge(folder.path(), words).spawn().expect("the binary runs");
    let line = BufReader::new(child.stdout.take().expect("a pipe")).lines().next();
    child.kill().expect("a running service");
    child.wait().expect("its end");
    let output: Value = serde_json::from_str(&line.expect("a line").expect("text")).expect("JSON");
    assert!(output["listening"].as_str().is_some_and(|url| url.starts_with("http://127.0.0.1:")), "{output}");
}

#[test]
fn a_bad_server_url_is_a_usage_error() {
    let folder = tempfile::tempdir().expect("a folder");
    for command in [&["jobs", "list"][..], &["pull"], &["jobs", "submit", "draft"]] {
        for url in ["here", "ftp://host", "http://", "http://host/?a=b"] {
            run(folder.path(), command.iter().chain(&["--server", url])).exited(2);
        }
    }
    assert_eq!(fs::read_dir(folder.path()).expect("the folder").count(), 0);
}

#[test]
fn points_may_begin_with_a_byte_order_mark_and_lines_have_a_limit() {
    let folder = tempfile::tempdir().expect("a folder");
    let digest = run_with_stdin(folder.path(), ["fit", "-"], SMALL).exited(0).last_line().to_owned();
    for points in ["\u{feff}alpha_x,alpha_y,theta,phi\r\n0.5,0.5,0,0\r\n", "\u{feff}0.5,0.5,0,0\n"] {
        let printed = run_with_stdin(folder.path(), ["lookup", &digest, "--points", "-"], points).exited(0);
        assert_eq!(printed.stdout.lines().count(), 2, "{printed:#?}");
    }

    let refused = run(folder.path(), ["lookup", &digest, "--points", "."]).exited(2);
    assert_eq!(refused.complaints(), [".: this is a folder, not a CSV file of points"]);

    let refused = run(folder.path(), ["lookup", &digest, "--points", "/dev/zero"]).exited(1);
    assert_eq!(refused.complaints(), ["/dev/zero: this is not a regular file"]);
    let padded = format!("0.5,0.5,0,0\n0.5,0.5,0,{}", "0".repeat(5000));
    let refused = run_with_stdin(folder.path(), ["lookup", &digest, "--points", "-"], &padded).exited(2);
    assert!(refused.complaints()[0].starts_with("standard input, line 2: the line is longer"), "{refused:#?}");
}

#[test]
fn files_that_block_or_never_end_are_rejected() {
    let folder = tempfile::tempdir().expect("a folder");
    let here = folder.path();
    fs::create_dir(here.join("export")).expect("a folder");
    fs::write(here.join("recipe.json"), r#"{"brdf": "tabulated", "tabulated": "odd.json"}"#).expect("a recipe");
    symlink("../odd.json", here.join("export/ltcforge.json")).expect("a link");
    symlink("odd.json", here.join("odd.gltf")).expect("a link");
    let commands: [(&[&str], i32); 12] = [
        (&["verify", "odd.json"], 1),
        (&["verify", "export"], 1),
        (&["report", "odd.json"], 1),
        (&["fit", "./odd.json"], 1),
        (&["fit", "./recipe.json"], 2),
        (&["light", "odd.json"], 1),
        (&["plan", "odd.json", "-o", "out"], 1),
        (&["plan", "odd.gltf", "-o", "out"], 1),
        (&["light-texture", "odd.json", "-o", "out"], 1),
        (&["jobs", "list", "--config", "odd.json"], 2),
        (&["pull", "--lock", "odd.json"], 1),
        (&["serve", "--tokens", "odd.json"], 2),
    ];
    let odd = here.join("odd.json");
    for is_endless in [false, true] {
        if is_endless {
            fs::remove_file(&odd).expect("a FIFO");
            symlink("/dev/zero", &odd).expect("a link");
        } else {
            mknodat(CWD, &odd, FileType::Fifo, Mode::RWXU, 0).expect("a FIFO");
        }
        for (command, code) in commands {
            let refused = run(here, command).exited(code);
            assert!(refused.stderr.contains("this is not a regular file"), "{command:?}: {refused:#?}");
        }
        let mut command = ltcforge(here, ["jobs", "list", "--server", "https://127.0.0.1:9"]);
        let refused = Run::from(command.env("SSL_CERT_FILE", &odd).output().expect("the binary runs")).exited(1);
        assert!(refused.stderr.contains("odd.json: this is not a regular file"), "{refused:#?}");
    }
    run_with_stdin(here, ["fit", "/dev/stdin"], SMALL).exited(0);
    // A file that reports a size over the limit is not read. This sparse file has a terabyte, but no blocks on the
    // disk.
    let sparse = fs::File::create(folder.path().join("sparse")).expect("a file");
    sparse.set_len(1 << 40).expect("a hole");
    let refused = run(folder.path(), ["verify", "./sparse"]).exited(1);
    assert!(refused.stderr.contains("longer than 1073741824 bytes, the limit"), "{refused:#?}");
}
