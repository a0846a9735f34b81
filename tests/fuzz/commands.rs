//! CSV files and manifests of exports, as commands read them.

use std::{
    fs,
    path::{Path, PathBuf},
};

use super::target::Target;
use crate::common::command::run;

/// The output of a command for a file with this name: results or a short error, with one of these exit codes.
fn answer(args: &[&str], name: &str, bytes: &[u8], codes: &[i32]) -> String {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join(name), bytes).expect("a file");
    let run = run(folder.path(), args);
    match run.code {
        Some(0) => "results".to_owned(),
        Some(code) if codes.contains(&code) => {
            let complaints = run.complaints();
            assert!(!complaints.is_empty() && run.stderr.len() < 10_000, "{run:#?}");
            complaints.join("\n")
        }
        _ => panic!("{run:#?}"),
    }
}

/// A fitted table in this folder.
fn table(folder: &Path) -> PathBuf {
    fs::write(folder.join("recipe.json"), crate::common::SMALL).expect("a recipe");
    run(folder, ["fit", "recipe.json", "-o", "tables"]).exited(0);
    let made = fs::read_dir(folder.join("tables")).expect("a folder").map(|file| file.expect("a file").path());
    made.into_iter().find(|path| path.extension().is_some_and(|end| end == "safetensors")).expect("a table")
}

const WORDS: [&str; 8] = [",", "\n", "\r", "inf", "1e400", "\u{feff}", "\"", "theta"];

#[test]
fn points() {
    let folder = tempfile::tempdir().expect("a folder");
    let table = table(folder.path());
    let table = table.to_str().expect("UTF-8");
    let seeds = vec![b"alpha_x,alpha_y,theta,phi\n0.5,0.2,1.1,0.3\n1,1,0,-7\n".to_vec()];
    Target { name: "points", seeds, words: &WORDS, inputs: 60 }
        .survive(|bytes| answer(&["lookup", table, "--points", "input.csv"], "input.csv", bytes, &[2]));
}

#[test]
fn lights() {
    let seeds = vec![b"0.5,0.25,0.7,-70,1,4,1,2,1,4,2,-1,4,2\n1,1,0,0,2,1,0,2,0,1,2,-1,0,2,0,-1,2\n".to_vec()];
    Target { name: "lights", seeds, words: &WORDS, inputs: 60 }
        .survive(|bytes| answer(&["light", "input.csv"], "input.csv", bytes, &[2]));
}

#[test]
fn manifests_of_exports() {
    let folder = tempfile::tempdir().expect("a folder");
    let table = table(folder.path());
    run(folder.path(), ["export", table.to_str().expect("UTF-8"), "--for", "wgpu", "--out", "export"]).exited(0);
    let seeds = vec![fs::read(folder.path().join("export/ltcforge.json")).expect("a manifest")];
    let words =
        ["\"path\":", "\"../x\"", "\"bytes\":", "\"sha256\":", "\"about\":", "\"table ", "[", "{", "}", ",", "null"];
    // The exit code is 1 if files of the manifest are missing, and 3 if the manifest is invalid.
    Target { name: "manifest", seeds, words: &words, inputs: 60 }
        .survive(|bytes| answer(&["verify", "ltcforge.json"], "ltcforge.json", bytes, &[1, 3]));
}
