//! The folder tree is the architecture: layers use only what lies below them, the core stays pure, files do not use
//! each other in circles, and no file lies beside the tree.

mod circles;
mod planted;
mod resolve;
mod rules;
mod tree;
mod uses;

use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::{Path, PathBuf},
    sync::LazyLock,
};

use circles::Graph;
use rules::{ABSENT, ALLOWED, layer_of};
use tree::Tree;

fn src() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("src")
}

/// The library.
static LIBRARY: LazyLock<Tree> = LazyLock::new(|| read("lib.rs"));

/// The crate with this root, a file of `src`.
fn read(root: &str) -> Tree {
    Tree::read(Path::new(root), &|path| fs::read_to_string(src().join(path)).ok())
}

/// Every source file below `folder`, relative to `src`.
fn sources(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path());
    let files = entries.flat_map(|path| if path.is_dir() { sources(&path) } else { vec![path] });
    let files = files.filter(|path| path.extension().is_some_and(|extension| extension == "rs"));
    files.map(|path| path.strip_prefix(src()).map_or(path.clone(), Path::to_owned)).collect()
}

/// What the layers of `tree` use against the table, and how many paths between layers there are.
fn forbidden_arrows(tree: &Tree) -> (Vec<String>, usize) {
    let allowed: BTreeMap<&str, &[&str]> = ALLOWED.iter().copied().collect();
    let (mut faults, mut arrows) = (Vec::new(), 0);
    for (index, module) in tree.modules.iter().enumerate() {
        let Some(layer) = layer_of(&module.path) else { continue };
        // The core's own list of what it offers names all of its layers.
        if module.path == ["fit"] {
            continue;
        }
        for named in &module.uses.paths {
            let Ok(path) = tree.spelled_out(index, &named.path) else { continue };
            let Some(target) = layer_of(&path).filter(|target| *target != layer) else { continue };
            arrows += 1;
            if !allowed[layer].contains(&target) {
                faults.push(format!("{}: {layer} -> {}", module.file.display(), path.join("::")));
            }
        }
    }
    (faults, arrows)
}

/// What the layers of `tree` name although they must not, and how many modules were looked at.
fn forbidden_names(tree: &Tree) -> (Vec<String>, usize) {
    let (mut faults, mut looked_at) = (Vec::new(), 0);
    for (index, module) in tree.modules.iter().enumerate() {
        let Some(layer) = layer_of(&module.path) else { continue };
        let used = &module.uses;
        let outside: BTreeSet<Vec<String>> =
            used.paths.iter().filter_map(|named| tree.spelled_out(index, &named.path).err()).collect();
        for (_, absent) in ABSENT.iter().filter(|(layers, _)| layers.contains(&layer)) {
            looked_at += 1;
            for path in *absent {
                let names: Vec<&str> = path.split("::").collect();
                let is_below = |found: &Vec<String>| found.iter().take(names.len()).eq(names.iter().copied());
                if outside.iter().any(is_below) || used.words.contains(*path) {
                    faults.push(format!("{}: {layer} must not know {path}", module.file.display()));
                }
            }
        }
    }
    (faults, looked_at)
}

#[test]
fn arrows_point_down_only() {
    let (faults, arrows) = forbidden_arrows(&LIBRARY);
    assert_eq!(faults, [""; 0]);
    assert!(arrows > 100, "{arrows} arrows were found");
}

#[test]
fn the_table_itself_has_no_circle() {
    for (index, (module, targets)) in ALLOWED.iter().enumerate() {
        let below: Vec<&str> = ALLOWED[..index].iter().map(|(name, _)| *name).collect();
        for target in *targets {
            assert!(below.contains(target), "{module} -> {target} points up");
        }
    }
}

#[test]
fn the_core_is_pure_and_the_layers_know_only_their_own_world() {
    let (faults, looked_at) = forbidden_names(&LIBRARY);
    assert_eq!(faults, [""; 0]);
    assert!(looked_at > 10, "{looked_at} modules were looked at");
}

#[test]
fn files_use_each_other_in_no_circle() {
    let graph = Graph::of(&LIBRARY);
    assert!(graph.edges() > 200, "{} edges were found", graph.edges());
    let found = graph.circles();
    let told: BTreeSet<String> = found.values().map(|circle| graph.told(circle)).collect();
    let told: Vec<String> = told.into_iter().collect();
    assert!(told.is_empty(), "files use each other in {} circles:\n{}", told.len(), told.join("\n"));
}

/// A fault that the loss and the report shared would stay hidden, so they share nothing but the table and the BRDF.
#[test]
fn what_judges_shares_nothing_with_what_is_judged() {
    let folder = src().join("fit/measure");
    let mut files = 0;
    for entry in fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        let text = fs::read_to_string(&path).expect("a source file");
        let code = text.split("#[cfg(test)]").next().expect("a part");
        if path.ends_with("tests.rs") {
            continue;
        }
        files += 1;
        for line in code.lines().map(|line| line.split("//").next().unwrap_or_default()) {
            for word in ["loss", "target", "solve", "guess", "entry::", "metric", "Fitter", "Lattice", "_hemisphere"] {
                assert!(!line.contains(word), "{}: {line}", path.display());
            }
        }
    }
    assert!(files > 10, "{files} files were found");
}

#[test]
fn every_path_within_the_crate_is_understood() {
    let mut faults = Vec::new();
    for (index, module) in LIBRARY.modules.iter().enumerate() {
        let lost = module.uses.paths.iter().filter(|named| LIBRARY.resolve(index, &named.path).is_empty());
        faults.extend(lost.map(|named| format!("{}: {}", module.file.display(), named.path.join("::"))));
    }
    assert_eq!(faults, [""; 0]);
}

#[test]
fn the_binary_uses_the_command_line_alone() {
    let tree = read("main.rs");
    let paths = tree.modules.iter().flat_map(|module| &module.uses.paths);
    let of_ours = paths.filter(|named| named.path[0] == "ltcforge");
    let used: BTreeSet<String> = of_ours.filter_map(|named| named.path.get(1).cloned()).collect();
    assert_eq!(used, BTreeSet::from(["cli".to_owned()]));
}

#[test]
fn every_file_is_reached_by_a_mod() {
    let binary = read("main.rs");
    let reached: BTreeSet<&Path> = LIBRARY.files().into_iter().chain(binary.files()).collect();
    let beside: Vec<PathBuf> = sources(&src()).into_iter().filter(|path| !reached.contains(path.as_path())).collect();
    assert_eq!(beside, Vec::<PathBuf>::new(), "files that no mod reaches");
    assert!(reached.len() > 100, "{} files were found", reached.len());
}
