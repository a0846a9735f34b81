//! Tests the files of the page.

use crate::common::server::Server;

/// Largest size of the first view in bytes, uncompressed.
const FIRST_VIEW_BYTES: usize = 60_000;

#[test]
fn the_page_and_its_files_are_served_with_entity_tags() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = Server::start(folder.path(), &[]);
    let page = server.get("/").with_status(200);
    let html = String::from_utf8(page.body).expect("UTF-8");
    let roots: Vec<String> = links(&html, "\"page/", '"').map(str::to_owned).collect();
    // The files that the list of tables imports immediately, and all files of the page.
    let first: Vec<String> = roots.iter().cloned().chain(["pages/tables.js".to_owned()]).collect();
    let (names, bytes) = loaded(&server, first, "from '");
    assert!(html.len() + bytes < FIRST_VIEW_BYTES, "{bytes} bytes");
    let (all, _) = loaded(&server, roots, "'");
    assert!(all.len() > 30 && names.len() > 8 && names.iter().all(|name| all.contains(name)), "{all:?}");
    server.get("/page/nothing.js").with_status(404);
    server.get("/page/../main.rs").with_status(404);
    server.get("/?theme=dark").with_status(400);
}

/// Loads files and, recursively, the files whose names follow `before` in them. Returns all names and the total bytes.
fn loaded(server: &Server, mut left: Vec<String>, before: &str) -> (Vec<String>, usize) {
    let (mut names, mut bytes) = (Vec::new(), 0);
    while let Some(name) = left.pop() {
        if names.contains(&name) {
            continue;
        }
        let file = server.get(&format!("/page/{name}")).with_status(200);
        bytes += file.body.len();
        let tag = file.header("etag").expect("a tag").to_owned();
        let again = server.request("GET", &format!("/page/{name}"), &[("if-none-match", &tag)], None);
        assert!(again.with_status(304).body.is_empty(), "{name}");
        if name.rsplit('.').next() == Some("js") {
            let text = String::from_utf8(file.body).expect("UTF-8");
            left.extend(links(&text, before, '\'').filter_map(|path| resolved(&name, path)));
        }
        names.push(name);
    }
    (names, bytes)
}

/// The file that `from` imports by a relative path. `None` for other texts.
fn resolved(from: &str, path: &str) -> Option<String> {
    if !path.starts_with("./") && !path.starts_with("../") {
        return None;
    }
    let mut parts: Vec<&str> = from.split('/').collect();
    parts.pop();
    for part in path.split('/') {
        match part {
            "." => {}
            ".." => drop(parts.pop()),
            name => parts.push(name),
        }
    }
    Some(parts.join("/"))
}

/// The texts between `before` and `end`.
fn links<'a>(text: &'a str, before: &'a str, end: char) -> impl Iterator<Item = &'a str> {
    text.split(before).skip(1).filter_map(move |rest| rest.split(end).next())
}
