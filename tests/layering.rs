//! The folder tree is the architecture: arrows between top-level modules point down only, the core stays pure, and no
//! file lies beside the tree.

use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::{Path, PathBuf},
};

/// Each top-level module and those it may use, upper layers last. `digest`, a leaf, is everyone's.
const ALLOWED: &[(&str, &[&str])] = &[
    ("digest", &[]),
    ("math", &[]),
    ("brdf", &["math"]),
    ("ltc", &["brdf", "math"]),
    ("fit", &["ltc", "brdf", "math"]),
    ("recipe", &["fit", "ltc"]),
    ("picture", &[]),
    ("plots", &["picture", "fit", "ltc"]),
    ("preview", &["picture", "ltc", "brdf", "math"]),
    ("export", &["recipe", "fit", "ltc", "math"]),
    ("tradeoff", &["recipe", "fit", "ltc"]),
    ("store", &[]),
    ("queue", &["store"]),
    ("service", &["export", "picture", "plots", "preview", "recipe", "fit", "ltc", "queue", "store"]),
    ("http", &["service", "plots", "preview", "recipe", "fit", "queue"]),
    ("client", &["recipe", "queue"]),
    ("cli", &["http", "client", "service", "tradeoff", "export", "plots", "preview", "recipe", "fit", "ltc", "queue"]),
];

/// What a module must not name, beyond other modules.
const ABSENT: &[(&[&str], &[&str])] = &[
    (
        &["math", "brdf", "ltc", "fit"],
        &["serde_json", "tokio", "std::fs", "std::env", "std::time", "std::thread", "std::net", "num_threads"],
    ),
    (&["tradeoff"], &["std::fs", "std::env", "std::time", "std::thread", "rustix"]),
    (&["queue", "store"], &["axum", "tower_http", "ureq"]),
    (&["picture", "plots", "preview"], &["axum", "tokio", "sled", "serde_json"]),
    (&["client"], &["axum", "tokio", "sled"]),
    (&["http", "cli"], &["sled"]),
];

fn src() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("src")
}

/// Every source file below `folder`.
fn sources(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path());
    let files = entries.flat_map(|path| if path.is_dir() { sources(&path) } else { vec![path] });
    files.filter(|path| path.extension().is_some_and(|extension| extension == "rs")).collect()
}

/// A file's text without its comments. A `//` within a string cuts its line short, which hides no module's name.
fn code(path: &Path) -> String {
    let text = fs::read_to_string(path).expect("a source file");
    text.lines()
        .map(|line| line.split("//").next().unwrap_or_default())
        .fold(String::new(), |code, line| code + line + "\n")
}

/// The top-level module that a file belongs to; `None` for the roots.
fn module_of(path: &Path) -> Option<String> {
    let relative = path.strip_prefix(src()).expect("a file of the crate");
    let first = relative.components().next()?.as_os_str().to_str()?.trim_end_matches(".rs");
    (!["lib", "main", "bin"].contains(&first)).then(|| first.to_owned())
}

/// The names that follow `prefix` in `code`: `crate::a`, and each of `crate::{a, b::{c}}`.
fn names_after(code: &str, prefix: &str) -> BTreeSet<String> {
    let identifier =
        |text: &str| -> String { text.trim_start().chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect() };
    let mut names = BTreeSet::new();
    for (start, _) in code.match_indices(prefix) {
        let is_part_of_a_name = code[..start].ends_with(|c: char| c.is_alphanumeric() || c == '_' || c == ':');
        let rest = &code[start + prefix.len()..];
        if is_part_of_a_name {
            continue;
        }
        let Some(group) = rest.strip_prefix('{') else {
            names.insert(identifier(rest));
            continue;
        };
        let (mut depth, mut begins) = (0, true);
        for (at, c) in group.char_indices() {
            if begins && depth == 0 {
                names.insert(identifier(&group[at..]));
            }
            begins = false;
            match c {
                '{' => depth += 1,
                '}' if depth == 0 => break,
                '}' => depth -= 1,
                ',' => begins = true,
                _ => {}
            }
        }
    }
    names.remove("");
    names
}

#[test]
fn arrows_point_down_only() {
    let allowed: BTreeMap<&str, &[&str]> = ALLOWED.iter().copied().collect();
    let mut faults = Vec::new();
    let mut edges = 0;
    for path in sources(&src()) {
        let Some(module) = module_of(&path) else { continue };
        let targets = allowed.get(module.as_str()).unwrap_or_else(|| panic!("{module} is not in the table"));
        let code = code(&path);
        for target in names_after(&code, "crate::").into_iter().filter(|name| allowed.contains_key(name.as_str())) {
            edges += 1;
            if target != module && target != "digest" && !targets.contains(&target.as_str()) {
                faults.push(format!("{}: {module} -> {target}", path.display()));
            }
        }
        // `super::super::queue` would be a way around the table.
        let own: BTreeSet<String> = names_after(&code, "mod ").into_iter().collect();
        let folder = src().join(&module);
        for name in names_after(&code, "super::super::").into_iter().chain(names_after(&code, "super::")) {
            let is_own =
                own.contains(&name) || folder.join(format!("{name}.rs")).exists() || folder.join(&name).is_dir();
            if allowed.contains_key(name.as_str()) && !is_own {
                faults.push(format!("{}: super::{name} leaves {module}", path.display()));
            }
        }
    }
    assert_eq!(faults, [""; 0]);
    assert!(edges > 20, "{edges} edges were found");
}

#[test]
fn the_table_itself_has_no_cycle() {
    for (index, (module, targets)) in ALLOWED.iter().enumerate() {
        let below: Vec<&str> = ALLOWED[..index].iter().map(|(name, _)| *name).collect();
        for target in *targets {
            assert!(below.contains(target), "{module} -> {target} points up");
        }
    }
}

#[test]
fn the_core_is_pure_and_the_layers_know_only_their_own_world() {
    let mut looked_at = 0;
    for path in sources(&src()) {
        let Some(module) = module_of(&path) else { continue };
        let code = code(&path);
        for (_, words) in ABSENT.iter().filter(|(modules, _)| modules.contains(&module.as_str())) {
            looked_at += 1;
            for word in *words {
                assert!(!code.contains(word), "{}: {module} must not know {word}", path.display());
            }
        }
    }
    assert!(looked_at > 10, "{looked_at} files were found");
}

#[test]
fn the_binary_uses_the_command_line_alone() {
    assert_eq!(names_after(&code(&src().join("main.rs")), "ltcforge::"), BTreeSet::from(["cli".to_owned()]));
}

#[test]
fn every_file_is_reached_by_a_mod() {
    let src = src();
    let mut reached = BTreeSet::new();
    let roots = sources(&src).into_iter().filter(|path| {
        path.parent() == Some(&src.join("bin")) || [src.join("lib.rs"), src.join("main.rs")].contains(path)
    });
    let mut queue: Vec<PathBuf> = roots.collect();
    while let Some(path) = queue.pop() {
        let folder = path.parent().expect("a file lies in a folder");
        let is_head = path.ends_with("mod.rs") || folder == src || folder == src.join("bin");
        let below = if is_head { folder.to_owned() } else { path.with_extension("") };
        let declared = code(&path);
        let modules = declared.lines().filter_map(|line| {
            let (_, name) = line.trim_end().strip_suffix(';')?.split_once("mod ")?;
            name.chars().all(|c| c.is_alphanumeric() || c == '_').then(|| name.to_owned())
        });
        for name in modules {
            let candidates = [below.join(format!("{name}.rs")), below.join(&name).join("mod.rs")];
            queue.extend(candidates.into_iter().filter(|candidate| candidate.exists()));
        }
        reached.insert(path);
    }
    let beside: Vec<PathBuf> = sources(&src).into_iter().filter(|path| !reached.contains(path)).collect();
    assert_eq!(beside, Vec::<PathBuf>::new(), "files that no mod reaches");
}

#[test]
fn names_are_found_in_all_their_forms() {
    let code = "use crate::{\n    digest::{Digest, crate_like},\n    queue::Job,\n};\nlet x = crate::fit::f(); my_crate::no();";
    let expected = ["digest", "queue", "fit"].map(str::to_owned);
    assert_eq!(names_after(code, "crate::"), BTreeSet::from(expected));
}
