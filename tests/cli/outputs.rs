//! Output paths of commands. Any path is possible, errors are reported before the work, and a failed write leaves the
//! old file.

use std::{
    ffi::{OsStr, OsString},
    fs,
    os::unix::ffi::OsStrExt as _,
    path::Path,
    process::Command,
};

use crate::common::{
    ENDLESS, SMALL,
    command::{Run, run, run_with_stdin},
};

/// A file name that is not UTF-8, with an extension.
fn odd(extension: &str) -> OsString {
    let mut name = OsStr::from_bytes(b"odd\xff").to_owned();
    name.push(extension);
    name
}

/// A command line of words and paths.
fn line(words: &[&dyn AsRef<OsStr>]) -> Vec<OsString> {
    words.iter().map(|word| (*word).as_ref().to_owned()).collect()
}

/// Runs the binary with a file size limit of zero bytes.
fn run_without_room(folder: &Path, args: &[&str]) -> Run {
    let script = r#"trap "" XFSZ; ulimit -f 0; exec "$0" "$@""#;
    let mut command = Command::new("sh");
    command.args(["-c", script, env!("CARGO_BIN_EXE_ltcforge")]).args(args).current_dir(folder);
    command.output().expect("a shell").into()
}

#[test]
fn paths_that_are_not_utf_8_work_in_every_command() {
    let folder = tempfile::tempdir().expect("a folder");
    let here = folder.path();
    fs::write(here.join(odd(".json")), SMALL).expect("a recipe");
    fs::write(here.join(odd(".csv")), "0.5,0.5,0,0\n").expect("points");
    let fitted = run(here, line(&[&"fit", &odd(".json"), &"-o", &odd("")])).exited(0);
    let hex = &fitted.last_line()["sha256:".len()..];
    let table = Path::new(&odd("")).join(format!("{hex}.safetensors"));
    assert!(here.join(&table).exists());

    let output = run(here, line(&[&"fit", &odd(".json"), &"-o", &odd(""), &"--json"])).exited(0);
    assert!(output.stdout.contains("odd\u{fffd}/"), "{}", output.stdout);
    for json in [&[][..], &["--json"]] {
        for words in [
            line(&[&"verify", &table]),
            line(&[&"verify", &"--tables", &odd(""), &hex]),
            line(&[&"report", &table]),
            line(&[&"lookup", &table, &"--points", &odd(".csv")]),
            line(&[&"preview", &table, &"-o", &odd(".png"), &"--size", &"64", &"--adapter", &"cpu"]),
            line(&[&"plot", &table, &"matrix", &"-o", &odd("-plot.png")]),
            line(&[&"shader", &"--language", &"wgsl", &"--layout", &"reflected", &"-o", &odd(".wgsl")]),
        ] {
            run(here, words.into_iter().chain(json.iter().map(Into::into))).exited(0);
        }
        run(here, line(&[&"verify", &odd("-none")]).into_iter().chain(json.iter().map(Into::into))).exited(1);
    }
    for name in [odd(".png"), odd("-plot.png"), odd(".wgsl")] {
        assert!(here.join(&name).exists(), "{}", name.display());
    }
}

#[test]
fn an_output_that_cannot_be_written_is_reported_before_the_work() {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("file"), "x").expect("a file");
    fs::write(folder.path().join("r.json"), ENDLESS).expect("a recipe");
    let shader = ["shader", "--language", "wgsl", "--layout", "reflected", "-o"];
    // The table does not exist either. The output is checked first, so the error is about the output.
    let pictures: [&[&str]; 3] = [&["preview", "./none", "-o"], &["plot", "./none", "matrix", "-o"], &shader];
    for command in pictures {
        for (out, said) in [
            ("none/p", "none/p: there is no folder none"),
            (".", ".: this is a folder"),
            ("file/p", "file/p: Not a directory"),
            ("/proc/p", "/proc/p: cannot write to its folder"),
        ] {
            let refused = run(folder.path(), command.iter().chain(&[out])).exited(1);
            assert!(refused.complaints()[0].starts_with(said), "{refused:#?}");
        }
    }
    // These fits would take hours.
    for command in [["fit", "r.json", "-o"].as_slice(), &["tradeoff", "--recipe", "./r.json", "-o"]] {
        for out in ["file", "file/below", "/proc/below"] {
            let refused = run(folder.path(), command.iter().chain(&[out])).exited(1);
            assert!(refused.complaints()[0].starts_with(out), "{refused:#?}");
        }
    }
    let recipe = ["lock", "a", "--recipe", "r.json"];
    fs::create_dir(folder.path().join("folder")).expect("a folder");
    for (more, said) in [
        (["--lock", "none/l"].as_slice(), "none/l: there is no folder none"),
        (&["--to", "folder"], "folder: this is not a regular file"),
        (&["--to", "file/a.safetensors"], "file/a.safetensors: Not a directory"),
        (&["--for", "wgpu", "--out", "file"], "file: cannot write to this folder"),
    ] {
        let refused = run(folder.path(), recipe.iter().chain(more)).exited(1);
        assert!(refused.complaints()[0].contains(said), "{refused:#?}");
    }
    assert_eq!(fs::read_dir(folder.path()).expect("the folder").count(), 3, "a file was made");
}

#[test]
fn a_write_that_fails_leaves_the_old_file() {
    let folder = tempfile::tempdir().expect("a folder");
    let fitted = run_with_stdin(folder.path(), ["fit", "-"], SMALL).exited(0);
    let table = fitted.last_line();
    let commands: [&[&str]; 3] = [
        &["preview", table, "--size", "64", "--adapter", "cpu", "-o", "out"],
        &["plot", table, "matrix", "-o", "out"],
        &["shader", "--language", "wgsl", "--layout", "reflected", "-o", "out"],
    ];
    let count = || fs::read_dir(folder.path()).expect("the folder").count();
    let out = folder.path().join("out");
    for command in commands {
        fs::write(&out, "old").expect("an old file");
        let before = count();
        let failed = run_without_room(folder.path(), command).exited(1);
        assert!(failed.stderr.contains("File too large"), "{failed:#?}");
        assert_eq!(fs::read(&out).expect("the old file"), b"old", "{command:?}");
        assert_eq!(count(), before, "a temporary file is left");
        run(folder.path(), command).exited(0);
        assert_ne!(fs::read(&out).expect("the new file"), b"old");
    }
}

#[test]
fn a_table_that_cannot_be_written_leaves_no_manifest() {
    let folder = tempfile::tempdir().expect("a folder");
    let fitted = run_with_stdin(folder.path(), ["fit", "-", "-o", "good"], SMALL).exited(0);
    let name = format!("{}.safetensors", &fitted.last_line()["sha256:".len()..]);
    fs::create_dir_all(folder.path().join("blocked").join(&name)).expect("a folder in the way");
    let failed = run_with_stdin(folder.path(), ["fit", "-", "-o", "blocked"], SMALL).exited(1);
    assert!(failed.stderr.contains(&name), "{failed:#?}");
    assert_eq!(fs::read_dir(folder.path().join("blocked")).expect("the folder").count(), 1);
}
