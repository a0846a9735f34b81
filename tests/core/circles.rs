//! Checks that the files of a crate do not use each other in a circle, and that every file is in the module tree. Cargo
//! itself rejects circles of crates.
//!
//! The test reads files as text. It takes paths with `crate`, `super` or `self` outside of tests, from `use`
//! declarations and from code. It resolves them through modules and re-exports to the file that defines the item.

use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::{Path, PathBuf},
};

/// Modules by their path below the root of the crate. The root has an empty path.
type Modules = BTreeMap<Vec<String>, Module>;

#[derive(Debug, Default)]
struct Module {
    items: BTreeSet<String>,
    /// Paths of other items. The flag marks re-exports.
    uses: Vec<(Vec<String>, bool)>,
    text: String,
}

impl Module {
    fn of(text: &str) -> Self {
        let (mut module, mut lines) = (Self { text: text.to_owned(), ..Self::default() }, text.lines());
        while let Some(line) = lines.next() {
            if ["#[cfg(test", "#[cfg(any(test", "#[cfg(all(test"].iter().any(|start| line.starts_with(start)) {
                let item = lines.find(|line| !line.starts_with("#[")).unwrap_or_default();
                if item.contains("mod ") && item.ends_with('{') {
                    // Tests are at the end of the file.
                    break;
                }
                let is_end = |line: &str| !line.starts_with([' ', '#']) && line.ends_with([';', '}']);
                if !is_end(item) {
                    lines.find(|line| is_end(line));
                }
                continue;
            }
            let code = line.strip_prefix("pub").map_or(line, |rest| match rest.strip_prefix('(') {
                Some(rest) => rest.split_once(')').map_or(rest, |(_, rest)| rest),
                None => rest,
            });
            let is_handed_on = code.len() < line.len();
            if let Some(tree) = code.trim_start().strip_prefix("use ") {
                let mut tree = tree.to_owned();
                while !tree.contains(';') {
                    tree += lines.next().expect("a declaration ends");
                }
                let paths = spread(tree.split(';').next().unwrap_or_default(), &[]);
                module.uses.extend(paths.into_iter().map(|path| (path, is_handed_on)));
            } else {
                module.uses.extend(paths_of(code).map(|path| (path, false)));
                let mut words = code.split(|c: char| !c.is_alphanumeric() && c != '_').filter(|word| !word.is_empty());
                let kinds = ["fn", "struct", "enum", "trait", "const", "static", "type"];
                if words.find(|word| !["const", "unsafe", "async"].contains(word)).is_some_and(|w| kinds.contains(&w)) {
                    module.items.extend(words.next().map(str::to_owned));
                } else if let Some(name) = code.strip_prefix("const ") {
                    module.items.extend(name.split(':').next().map(str::to_owned));
                }
            }
        }
        module
    }
}

/// The paths in a line of code that is not a declaration.
fn paths_of(line: &str) -> impl Iterator<Item = Vec<String>> {
    let code = if line.trim_start().starts_with("//") { "" } else { line };
    code.split(|c: char| !c.is_alphanumeric() && c != '_' && c != ':')
        .filter(|path| ["crate::", "super::", "self::"].iter().any(|start| path.starts_with(start)))
        .map(|path| path.split("::").filter(|name| !name.is_empty()).map(str::to_owned).collect())
}

/// The paths in a tree such as `a::{b, c::{self, d as e}}`.
fn spread(tree: &str, before: &[String]) -> Vec<Vec<String>> {
    let (head, group) = tree.split_once('{').map_or((tree, None), |(head, group)| (head, group.rsplit_once('}')));
    let named = |part: &str| part.split(" as ").next().unwrap_or_default().trim().to_owned();
    let names = head.split("::").map(named).filter(|name| !name.is_empty() && name != "self" || before.is_empty());
    let path: Vec<String> = before.iter().cloned().chain(names.filter(|name| !name.is_empty())).collect();
    let Some((group, _)) = group else { return vec![path] };
    let (mut depth, mut parts) = (0, vec![String::new()]);
    for c in group.chars() {
        depth += i32::from(c == '{') - i32::from(c == '}');
        match c {
            ',' if depth == 0 => parts.push(String::new()),
            _ => parts.last_mut().expect("one at least").push(c),
        }
    }
    parts.iter().filter(|part| !part.trim().is_empty()).flat_map(|part| spread(part, &path)).collect()
}

/// The module that defines the item at `path`, which is relative to the module `from`.
fn owner(modules: &Modules, from: &[String], path: &[String], depth: u32) -> Option<Vec<String>> {
    let (first, rest) = path.split_first()?;
    let mut at = match first.as_str() {
        "crate" => Vec::new(),
        "self" => from.to_vec(),
        "super" => from.split_last()?.1.to_vec(),
        child => [from, &[child.to_owned()]].concat(),
    };
    for (index, name) in rest.iter().enumerate() {
        if name == "super" {
            at.pop()?;
            continue;
        }
        let child = [&at[..], std::slice::from_ref(name)].concat();
        if modules.contains_key(&child) {
            at = child;
            continue;
        }
        let module = modules.get(&at)?;
        if module.items.contains(name) || depth == 0 {
            return Some(at);
        }
        let handed_on = module.uses.iter().filter(|(_, is_handed_on)| *is_handed_on);
        let mut found = handed_on.filter_map(|(target, _)| match target.last()?.as_str() {
            last if last == name => owner(modules, &at, target, depth - 1),
            "*" => {
                let path = [&target[..target.len() - 1], &rest[index..]].concat();
                owner(modules, &at, &path, depth - 1).filter(|found| modules[found].items.contains(name))
            }
            _ => None,
        });
        return found.next();
    }
    modules.contains_key(&at).then_some(at)
}

/// All circles. Each is a list of modules.
fn circles(modules: &Modules) -> Vec<Vec<String>> {
    let edges: BTreeMap<&Vec<String>, BTreeSet<Vec<String>>> = modules
        .iter()
        .map(|(from, module)| {
            let used = module.uses.iter().filter(|(_, is_handed_on)| !is_handed_on);
            let owners = used.filter_map(|(path, _)| owner(modules, from, path, 8)).filter(|to| to != from);
            (from, owners.collect())
        })
        .collect();
    let reach = |from: &Vec<String>| {
        let (mut reached, mut next) = (BTreeSet::new(), vec![from]);
        while let Some(module) = next.pop() {
            next.extend(edges[module].iter().filter(|to| reached.insert((*to).clone())));
        }
        reached
    };
    let reached: BTreeMap<&Vec<String>, BTreeSet<Vec<String>>> =
        edges.keys().map(|from| (*from, reach(from))).collect();
    let on_circle = edges.keys().filter(|module| reached[*module].contains(**module));
    let groups: BTreeSet<Vec<String>> = on_circle
        .map(|module| {
            let members = reached[module].iter().filter(|other| reached[other].contains(*module));
            members.map(|member| member.join("::")).collect()
        })
        .collect();
    groups.into_iter().collect()
}

fn read(folder: &Path, path: &[String], modules: &mut Modules) {
    for entry in fs::read_dir(folder).expect("a folder") {
        let file: PathBuf = entry.expect("an entry").path();
        let stem = file.file_stem().expect("a name").to_string_lossy().into_owned();
        let below = [path, std::slice::from_ref(&stem)].concat();
        if file.is_dir() && !file.join("Cargo.toml").exists() && !file.is_symlink() && stem != "tests" {
            read(&file, &below, modules);
        } else if file.extension().is_some_and(|extension| extension == "rs") && stem != "tests" && stem != "main" {
            let below = if ["mod", "lib"].contains(&stem.as_str()) { path.to_vec() } else { below };
            modules.insert(below, Module::of(&fs::read_to_string(&file).expect("a source file")));
        }
    }
}

#[test]
fn files_do_not_use_each_other_in_a_circle() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let (mut uses, mut found, mut lost) = (0, vec![], vec![]);
    let folders = fs::read_dir(&src).expect("a folder").map(|entry| entry.expect("an entry").path());
    for folder in folders.chain([src.clone()]) {
        if folder == src || folder.join("Cargo.toml").exists() {
            let mut modules = Modules::new();
            read(&folder, &[], &mut modules);
            let name = folder.file_name().unwrap_or_default().to_string_lossy();
            uses += modules.values().map(|module| module.uses.len()).sum::<usize>();
            found.extend(circles(&modules).iter().map(|circle| format!("{name}: {}", circle.join(" "))));
            for path in modules.keys() {
                let Some((module, parent)) = path.split_last() else { continue };
                if !modules.get(parent).is_some_and(|parent| parent.text.contains(&format!("mod {module};"))) {
                    lost.push(format!("{name}: no `mod` reaches {}", path.join("::")));
                }
            }
        }
    }
    assert_eq!((found, lost), (vec![], vec![]));
    assert!(uses > 1000, "{uses} uses were found");
}

#[test]
fn a_path_in_code_closes_a_circle() {
    let text = |path: &str| {
        format!(
            "// super::one\npub fn f() {{\n    {path}::f(1);\n}}\n#[cfg(test)]\nmod tests {{\nsuper::super::one::f();"
        )
    };
    let of = |path| {
        let module = |name: &str, text: &str| (vec![name.to_owned()], Module::of(text));
        let root = (vec![], Module::of("mod one;\nmod two;"));
        circles(&[root, module("one", &text("super::two")), module("two", &text(path))].into())
    };
    assert_eq!((of("crate::one"), of("crate::none")), (vec![vec!["one".to_owned(), "two".to_owned()]], vec![]));
}

#[test]
fn a_circle_is_found_through_re_exports_and_globs() {
    let planted = [
        ("", "mod a;\nmod b;\npub use a::{One, Other as Another};"),
        ("a", "mod one;\nmod two;\npub use one::One;\npub(crate) use self::two::*;"),
        (
            "a::one",
            "#[cfg(test)]\nmod tests;\n#[cfg(test)]\nuse super::{\n    None,\n};\nuse super::{Two};\npub struct One(Two);",
        ),
        ("a::two", "use crate::{\n    b::{self, again},\n};\npub struct Two;"),
        ("b", "use crate::One;\npub fn again() {}\n#[cfg(test)]\nuse crate::a::Two;"),
    ];
    let module = |(path, text): (&str, &str)| {
        let path: Vec<String> = path.split("::").filter(|name| !name.is_empty()).map(str::to_owned).collect();
        (path, Module::of(text))
    };
    assert_eq!(circles(&planted.map(module).into()), [["a::one", "a::two", "b"]]);
    let open = [planted[0], planted[1], planted[2], planted[3], ("b", "pub fn again() {}")];
    assert_eq!(circles(&open.map(module).into()), Vec::<Vec<String>>::new());
}
