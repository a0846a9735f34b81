//! The instructions of `docs/ci.md`, executed line by line.

use std::{env, fs, path::PathBuf, process::Command};

use serde_json::Value;

use crate::common::{
    documents::{self, run_in, shell},
    report_skipped,
};

/// The code blocks in one language of the document, in order.
fn blocks(language: &str) -> Vec<String> {
    documents::blocks("docs/ci.md", language)
}

/// A project that is pinned as in the document.
fn pinned() -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().expect("a folder");
    let project = folder.path().to_owned();
    shell(&project, &blocks("sh")[0]);
    (folder, project)
}

#[test]
fn the_lines_for_a_shell_run_as_they_are() {
    let (_folder, project) = pinned();
    let assets = project.join("assets");
    let before = fs::read(assets.join("ltc/ltc_terms.ktx2")).expect("a texture");
    fs::remove_dir_all(&assets).expect("a folder");
    let blocks = blocks("sh");
    assert!(blocks.len() > 1);
    let said = shell(&project, &blocks[1..].concat());
    assert!(said.contains("metal fitted: assets/metal.safetensors\n"), "{said}");
    assert_eq!(fs::read(assets.join("ltc/ltc_terms.ktx2")).expect("a texture"), before);
    assert_eq!(said.matches("unchanged").count() * 2, said.lines().count(), "the second run changes files: {said}");
}

/// All lines of a document that a CI runner passes to a shell.
fn lines_of(document: &Value) -> Vec<String> {
    match document {
        Value::Array(items) => items.iter().flat_map(lines_of).collect(),
        Value::Object(fields) => {
            let lines = fields.iter().map(|(key, value)| match (key.as_str(), value) {
                ("run", Value::String(line)) => vec![line.clone()],
                ("script", Value::Array(lines)) => {
                    lines.iter().map(|line| line.as_str().expect("a line").to_owned()).collect()
                }
                _ => lines_of(value),
            });
            lines.flatten().collect()
        }
        _ => vec![],
    }
}

#[test]
fn the_lines_for_github_and_gitlab_run() {
    let (_folder, project) = pinned();
    let documents = blocks("yaml");
    assert_eq!(documents.len(), 2);
    for document in documents {
        let document: Value = serde_saphyr::from_str(&document).expect("YAML");
        let lines = lines_of(&document);
        // The tested program is already installed.
        let (install, ours): (Vec<_>, Vec<_>) = lines.iter().partition(|line| line.starts_with("cargo install "));
        assert_eq!((install.len(), ours.len()), (1, 2), "{lines:?}");
        fs::remove_dir_all(project.join("assets")).expect("a folder");
        for line in ours {
            shell(&project, line);
        }
    }
}

#[test]
fn the_build_script_stops_a_build_with_a_changed_texture() {
    let (_folder, project) = pinned();
    fs::write(project.join("build.rs"), &blocks("rust")[0]).expect("a build script");
    let rustc = env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    if Command::new(&rustc).arg("--version").output().is_err() {
        return report_skipped("there is no rustc");
    }
    let compiled = run_in(&project, &rustc, &["--edition", "2024", "build.rs", "-o", "build"]);
    assert!(compiled.status.success(), "{}", String::from_utf8_lossy(&compiled.stderr));
    let build = project.join("build");
    assert!(run_in(&project, &build, &[]).status.success());
    fs::write(project.join("assets/ltc/ltc_terms.ktx2"), "other").expect("another texture");
    let stopped = run_in(&project, &build, &[]);
    assert!(!stopped.status.success());
    assert!(String::from_utf8_lossy(&stopped.stderr).contains("but sha256:"), "{stopped:?}");
}

#[test]
fn cmake_restores_the_textures() {
    let (_folder, project) = pinned();
    let head = "cmake_minimum_required(VERSION 3.18)\nproject(game NONE)\nadd_custom_target(game ALL)\n";
    fs::write(project.join("CMakeLists.txt"), format!("{head}{}", blocks("cmake")[0])).expect("a project");
    if Command::new("cmake").arg("--version").output().is_err() {
        return report_skipped("there is no cmake");
    }
    fs::remove_dir_all(project.join("assets")).expect("a folder");
    for args in [&["-S", ".", "-B", "out"][..], &["--build", "out"]] {
        let ran = run_in(&project, "cmake", args);
        assert!(ran.status.success(), "{}", String::from_utf8_lossy(&ran.stderr));
    }
    assert!(project.join("assets/ltc/ltc_terms.ktx2").exists());
}
