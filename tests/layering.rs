//! The folder tree is the architecture: arrows between top-level modules point down only, the core stays pure, and no
//! file lies beside the tree.

use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::{Path, PathBuf},
};

/// Each layer, a folder of `src`, and those that it may use, upper layers last.
const ALLOWED: &[(&str, &[&str])] = &[
    ("fit::math", &[]),
    ("fit::brdf", &["fit::math"]),
    ("fit::ltc", &["fit::brdf", "fit::math"]),
    ("fit", &["fit::ltc", "fit::brdf", "fit::math"]),
    ("files", &["fit", "fit::math"]),
    ("view::parameters", &[]),
    ("view::picture", &[]),
    ("view::plots", &["view::parameters", "view::picture", "fit"]),
    ("view::shaders", &["fit", "fit::math"]),
    ("view::preview", &["view::shaders", "view::parameters", "view::picture", "fit", "fit::brdf", "fit::math"]),
    ("view::tradeoff", &["files", "fit"]),
    ("server::store", &["files"]),
    ("server::queue", &["server::store", "files"]),
    (
        "server::service",
        &["server::queue", "server::store", "view::picture", "view::plots", "view::preview", "files", "fit"],
    ),
    (
        "server::http",
        &["server::service", "server::queue", "view::parameters", "view::plots", "view::preview", "files", "fit"],
    ),
    ("client", &["files"]),
    (
        "cli",
        &[
            "server::http",
            "server::service",
            "client",
            "view::plots",
            "view::preview",
            "view::shaders",
            "view::tradeoff",
            "files",
            "fit",
        ],
    ),
];

/// What a layer must not name, beyond other layers.
const ABSENT: &[(&[&str], &[&str])] = &[
    (
        &["fit", "fit::math", "fit::brdf", "fit::ltc"],
        &["serde_json", "tokio", "std::fs", "std::env", "std::time", "std::thread", "std::net", "num_threads"],
    ),
    (&["view::tradeoff"], &["std::fs", "std::env", "std::time", "std::thread", "rustix"]),
    (&["server::queue", "server::store"], &["axum", "tower_http", "ureq"]),
    (&["view::picture", "view::plots", "view::preview"], &["axum", "tokio", "sled", "serde_json", "naga"]),
    (&["view::shaders"], &["axum", "tokio", "sled", "serde_json", "wgpu", "png", "embedded_graphics"]),
    (&["client"], &["axum", "tokio", "sled"]),
    (&["server::http", "cli"], &["sled"]),
];

/// The layer that a path of names below the crate belongs to: the longest that it begins with.
fn layer_of(names: &[&str]) -> Option<&'static str> {
    let layers = ALLOWED.iter().map(|(layer, _)| *layer);
    let begins = |layer: &&str| layer.split("::").eq(names.iter().copied().take(layer.split("::").count()));
    layers.filter(begins).max_by_key(|layer| layer.len())
}

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

/// The names of the modules that a file lies in; none for the roots and for a world's own list of its layers.
fn modules_of(path: &Path) -> Vec<String> {
    let relative = path.strip_prefix(src()).expect("a file of the crate").with_extension("");
    let names = relative.components().map(|name| name.as_os_str().to_str().expect("a name").to_owned());
    names.filter(|name| !["lib", "main", "mod"].contains(&name.as_str())).collect()
}

fn layer_of_file(path: &Path) -> Option<&'static str> {
    let modules = modules_of(path);
    layer_of(&modules.iter().map(String::as_str).collect::<Vec<_>>())
}

/// The full paths that follow `crate::` in `code`, groups spelled out.
fn paths_in(code: &str) -> BTreeSet<String> {
    let identifier = |c: char| c.is_alphanumeric() || c == '_';
    let mut paths = BTreeSet::new();
    for (start, _) in code.match_indices("crate::") {
        if code[..start].ends_with(|c: char| identifier(c) || c == ':') {
            continue;
        }
        let (mut prefixes, mut path) = (Vec::new(), String::new());
        for c in code[start + "crate::".len()..].chars().filter(|c| !c.is_whitespace()) {
            match c {
                '{' => prefixes.push(path.clone()),
                ',' | '}' if !prefixes.is_empty() => {
                    paths.insert(path);
                    path = prefixes.last().cloned().unwrap_or_default();
                    if c == '}' {
                        prefixes.pop();
                    }
                }
                _ if identifier(c) || c == ':' => path.push(c),
                _ => break,
            }
            if prefixes.is_empty() && c == '}' {
                break;
            }
        }
        paths.insert(path);
    }
    paths
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
        let Some(layer) = layer_of_file(&path) else { continue };
        for used in paths_in(&code(&path)) {
            let names: Vec<&str> = used.split("::").collect();
            let Some(target) = layer_of(&names).filter(|_| !used.ends_with("::")) else { continue };
            edges += 1;
            // A world's own layers are chosen among inside it.
            if target != layer && !allowed[layer].contains(&target) {
                faults.push(format!("{}: {layer} -> {used}", path.display()));
            }
        }
    }
    assert_eq!(faults, [""; 0]);
    assert!(edges > 100, "{edges} edges were found");
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
        let Some(module) = layer_of_file(&path) else { continue };
        let code = code(&path);
        for (_, words) in ABSENT.iter().filter(|(modules, _)| modules.contains(&module)) {
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
fn paths_are_found_in_all_their_forms() {
    let code = "use crate::{\n    files::digest::{Digest, crate_like},\n    server::queue::Job,\n};\nlet x = crate::fit::f(); my_crate::no();";
    let expected = ["files::digest::Digest", "files::digest::crate_like", "server::queue::Job", "fit::f"];
    let found = paths_in(code).into_iter().filter(|path| !path.is_empty() && !path.ends_with("::"));
    assert_eq!(found.collect::<BTreeSet<_>>(), BTreeSet::from(expected.map(str::to_owned)));
}
