//! The rules find what is planted.

use std::{
    collections::{BTreeMap, BTreeSet},
    path::Path,
};

use crate::{circles::Graph, forbidden_arrows, forbidden_names, tree::Tree};

/// A crate of these files.
fn planted(files: &[(&str, &str)]) -> Tree {
    let files: BTreeMap<&str, &str> = files.iter().copied().collect();
    Tree::read(Path::new("lib.rs"), &|path| files.get(path.to_str()?).map(|text| (*text).to_owned()))
}

/// The edges of a graph as `from -> to: items`.
fn edges(graph: &Graph) -> BTreeSet<String> {
    let edges = graph.0.iter().flat_map(|(from, to)| to.iter().map(move |(to, items)| (from, to, items)));
    let told = edges.map(|(from, to, items)| {
        let items: Vec<&str> = items.iter().map(String::as_str).collect();
        format!("{} -> {}: {}", from.display(), to.display(), items.join(" "))
    });
    told.collect()
}

fn set<const N: usize>(texts: [&str; N]) -> BTreeSet<String> {
    texts.map(str::to_owned).into()
}

#[test]
fn a_circle_is_found_through_re_exports_children_and_members() {
    let tree = planted(&[
        ("lib.rs", "pub mod a; pub mod b;"),
        ("a/mod.rs", "mod one; mod two; pub use one::One; pub use self::two::*;"),
        ("a/one.rs", "use super::Two; pub struct One(Two);"),
        ("a/two.rs", "pub struct Two; impl Two { pub fn of() -> u32 { crate::b::again() } }"),
        ("b.rs", "use crate::a; pub fn again() -> u32 { a::One::make() } impl a::One { pub fn make() -> u32 { 1 } }"),
    ]);
    let graph = Graph::of(&tree);
    let expected = ["a/one.rs -> a/two.rs: Two", "a/two.rs -> b.rs: again", "b.rs -> a/one.rs: One"];
    assert_eq!(edges(&graph), set(expected));
    let told: BTreeSet<String> = graph.circles().values().map(|circle| graph.told(circle)).collect();
    let circle = "  a/one.rs uses Two of a/two.rs\n  a/two.rs uses again of b.rs\n  b.rs uses One of a/one.rs\n";
    assert_eq!(told, set([circle]));
}

#[test]
fn a_function_counts_where_it_is_written_and_tests_do_not_count() {
    let tree = planted(&[
        ("lib.rs", "mod kind; mod more; mod user;"),
        ("kind.rs", "pub struct Kind; #[cfg(test)] mod tests { use crate::user::run; fn t() { run(); } }"),
        ("more.rs", "use crate::kind::Kind; impl Kind { pub fn more() {} } #[cfg(test)] use crate::user::run;"),
        ("user.rs", "pub fn run() { use crate::kind::Kind as K; K::more(); #[cfg(test)] let _ = crate::lost::no(); }"),
    ]);
    let graph = Graph::of(&tree);
    let expected = ["more.rs -> kind.rs: Kind", "user.rs -> kind.rs: Kind", "user.rs -> more.rs: Kind::more"];
    assert_eq!(edges(&graph), set(expected));
    assert!(graph.circles().is_empty());
}

#[test]
fn a_name_may_be_a_module_and_a_function() {
    let tree = planted(&[
        ("lib.rs", "mod port; mod user;"),
        ("port/mod.rs", "mod port; pub use port::port;"),
        ("port/port.rs", "pub fn port() {} pub fn part() {}"),
        ("user.rs", "use crate::port::{self, port}; fn f() { assert!(port() == port::port()); let part = 1; part; }"),
    ]);
    assert_eq!(edges(&Graph::of(&tree)), set(["user.rs -> port/port.rs: port"]));
}

#[test]
fn an_arrow_up_is_found_in_each_of_its_forms() {
    let forms = [
        "use crate::cli::Exit;",
        "use crate::{fit::Table, cli::{self}};",
        "use super::super::cli as up;",
        "fn f() { crate::cli::run(); }",
        "use crate::cli; fn f() -> u32 { cli::run() }",
        "fn f() { println!(\"{}\", crate::cli::run()); }",
        "#[derive(Debug)] struct S { #[serde(with = x, default(crate::cli::run))] s: u32 }",
        "#[cfg(test)] mod tests { use crate::cli::run; }",
        "mod deep { use super::super::super::cli::run; }",
        "pub use crate::cli::run;",
    ];
    let clean = "// crate::cli\nuse crate::fit::Table; fn f() { my_crate::cli::run(\"crate::cli\"); }";
    for (form, expected) in forms.map(|form| (form, true)).into_iter().chain([(clean, false)]) {
        let tree = planted(&[
            ("lib.rs", "mod cli; mod files; mod fit;"),
            ("cli.rs", "pub fn run() {}"),
            ("fit.rs", "pub struct Table;"),
            ("files/mod.rs", "mod job;"),
            ("files/job.rs", form),
        ]);
        let (faults, _) = forbidden_arrows(&tree);
        assert_eq!(!faults.is_empty(), expected, "{form}: {faults:?}");
        assert!(faults.iter().all(|fault| fault.starts_with("files/job.rs: files -> cli")), "{faults:?}");
    }
}

#[test]
fn a_forbidden_name_is_found_in_each_of_its_forms() {
    let forms = [
        "use std::fs;",
        "use std::{collections::BTreeMap, env as e};",
        "fn f() { std::fs::read(\"x\"); }",
        "use std as s; fn f() { s::fs::read(\"x\"); }",
        "fn f() { assert!(std::env::args().count() == 1); }",
        "fn f(pool: P) { pool.num_threads(); }",
        "#[cfg(test)] mod tests { use tokio::sync::watch; }",
    ];
    let clean = "use std::{fmt, collections}; /// std::fs\nfn f() -> &str { \"tokio\" }";
    for (form, expected) in forms.map(|form| (form, true)).into_iter().chain([(clean, false)]) {
        let tree = planted(&[("lib.rs", "mod fit;"), ("fit.rs", form)]);
        let (faults, _) = forbidden_names(&tree);
        assert_eq!(!faults.is_empty(), expected, "{form}: {faults:?}");
    }
}

#[test]
fn a_path_that_leads_nowhere_is_seen() {
    let tree = planted(&[("lib.rs", "mod a; mod b;"), ("a.rs", "pub fn f() {}"), ("b.rs", "use crate::a::g;")]);
    let path: Vec<String> = ["crate", "a", "g"].map(str::to_owned).into();
    assert!(tree.resolve(2, &path).is_empty());
}
