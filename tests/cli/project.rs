//! A project with a pinned table.

use std::{
    fs,
    path::{Path, PathBuf},
    time::SystemTime,
};

use crate::common::{
    SMALL,
    command::{Run, run},
};

/// The URL of a server that does not exist.
pub(crate) const NOBODY: &str = "http://127.0.0.1:9";

pub(crate) fn pull(project: &Path, server: &str, args: &[&str]) -> Run {
    run(project, ["pull", "--server", server].iter().chain(args))
}

pub(crate) fn modified(path: &Path) -> SystemTime {
    fs::metadata(path).and_then(|data| data.modified()).expect("a time")
}

pub(crate) fn read(path: &Path) -> String {
    fs::read_to_string(path).expect("a text")
}

/// Every file below a folder, with its bytes.
pub(crate) fn files_of(folder: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let mut files = Vec::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).expect("a folder") {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                folders.push(path);
            } else {
                files.push((path.clone(), fs::read(&path).expect("a file")));
            }
        }
    }
    files.sort();
    files
}

/// A project that pins the table of [`SMALL`] and its textures, and a folder that contains the table.
pub(crate) fn project() -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().expect("a folder");
    let project = folder.path().join("project");
    fs::create_dir(&project).expect("a project");
    fs::write(folder.path().join("small.json"), SMALL).expect("a recipe");
    let words = ["lock", "metal", "--recipe", "../small.json", "--to", "assets/metal.safetensors"];
    run(&project, words.iter().chain(&["--for", "wgpu", "--out", "assets/ltc"])).exited(0);
    (folder, project)
}

/// The digest in a project's lock file.
pub(crate) fn pinned(project: &Path) -> String {
    let lock = read(&project.join("ltcforge.lock"));
    let line = lock.lines().find(|line| line.starts_with("digest = ")).expect("a digest");
    line.split('"').nth(1).expect("a digest in quotes").to_owned()
}
