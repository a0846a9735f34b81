//! Runs the commands of documents as they are written.

use std::{
    env, fs,
    path::Path,
    process::{Command, Output},
};

use super::command::ltcforge;

/// The text of a document, by its path in the repository.
pub(crate) fn document(path: &str) -> String {
    fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(path))
        .unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// The code blocks in one language of a document, in order.
pub(crate) fn blocks(path: &str, language: &str) -> Vec<String> {
    let text = document(path);
    let fence = format!("```{language}\n");
    let blocks = text.split(&fence).skip(1);
    let blocks: Vec<String> =
        blocks.map(|rest| rest.split("```").next().expect("the end of a block").to_owned()).collect();
    assert!(!blocks.is_empty(), "{path} has no block of {language}");
    blocks
}

/// The lines of all `sh` blocks of a document, except lines with one of these prefixes.
pub(crate) fn commands(path: &str, except: &[&str]) -> String {
    let blocks = blocks(path, "sh").concat();
    let lines = blocks.lines().filter(|line| !except.iter().any(|start| line.starts_with(start)));
    lines.flat_map(|line| [line, "\n"]).collect()
}

/// Runs a program in a folder. The binary is in its `PATH`. Its environment has no ltcforge variables and no proxy.
pub(crate) fn run_in(folder: &Path, program: impl AsRef<Path>, args: &[&str]) -> Output {
    let binary = Path::new(env!("CARGO_BIN_EXE_ltcforge")).parent().expect("a folder");
    let path = env::var_os("PATH").unwrap_or_default();
    let folders = [binary.to_owned()].into_iter().chain(env::split_paths(&path));
    let clean = ltcforge::<&str>(folder, []);
    let mut command = Command::new(program.as_ref());
    for (name, value) in clean.get_envs() {
        match value {
            Some(value) => command.env(name, value),
            None => command.env_remove(name),
        };
    }
    command.env("PATH", env::join_paths(folders).expect("folders")).current_dir(folder).args(args);
    command.output().expect("the program runs")
}

/// Runs an `sh` script in a folder. Returns its standard output.
#[track_caller]
pub(crate) fn shell(folder: &Path, script: &str) -> String {
    let ran = run_in(folder, "sh", &["-euc", script]);
    assert!(ran.status.success(), "{script}\n{}", String::from_utf8_lossy(&ran.stderr));
    String::from_utf8(ran.stdout).expect("text")
}
