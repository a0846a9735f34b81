//! CSV, read by the commands.

use std::{fs, time::Instant};

use crate::{common::command::run, target::Target};

/// What a command answers to a file: its results, or a complaint in few lines.
fn answer(args: &[&str], bytes: &[u8]) -> String {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("input.csv"), bytes).expect("a file");
    let started = Instant::now();
    let run = run(folder.path(), args);
    match run.code {
        Some(0) => "results".to_owned(),
        Some(2) => {
            let complaints = run.complaints();
            assert!(!complaints.is_empty() && run.stderr.len() < 10_000, "{run:#?} after {:?}", started.elapsed());
            complaints.join("\n")
        }
        _ => panic!("{run:#?}"),
    }
}

const WORDS: [&str; 8] = [",", "\n", "\r", "inf", "1e400", "\u{feff}", "\"", "theta"];

#[test]
fn points() {
    let folder = tempfile::tempdir().expect("a folder");
    let recipe = folder.path().join("recipe.json");
    fs::write(&recipe, crate::common::SMALL).expect("a recipe");
    run(folder.path(), ["fit", "recipe.json", "-o", "tables"]).exited(0);
    let tables = folder.path().join("tables");
    let made = fs::read_dir(&tables).expect("a folder").map(|file| file.expect("a file").path());
    let table =
        made.into_iter().find(|path| path.extension().is_some_and(|end| end == "safetensors")).expect("a table");
    let table = table.to_str().expect("UTF-8");
    let seeds = vec![b"alpha_x,alpha_y,theta,phi\n0.5,0.2,1.1,0.3\n1,1,0,-7\n".to_vec()];
    Target { name: "points", seeds, words: &WORDS, inputs: 60 }
        .survive(|bytes| answer(&["lookup", table, "--points", "input.csv"], bytes));
}

#[test]
fn lights() {
    let seeds = vec![b"0.5,0.25,0.7,-70,1,4,1,2,1,4,2,-1,4,2\n1,1,0,0,2,1,0,2,0,1,2,-1,0,2,0,-1,2\n".to_vec()];
    Target { name: "lights", seeds, words: &WORDS, inputs: 60 }.survive(|bytes| answer(&["light", "input.csv"], bytes));
}
