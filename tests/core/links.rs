//! Checks that relative links and anchors in the documents exist.

use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::{Path, PathBuf},
};

/// Adds all Markdown files below `folder`, except those of installed packages.
fn add_documents(folder: &Path, documents: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() && !path.ends_with("node_modules") {
            add_documents(&path, documents);
        } else if path.extension().is_some_and(|extension| extension == "md") {
            documents.push(path);
        }
    }
}

/// The text of a document without fenced code.
fn prose(text: &str) -> String {
    let parts = text.split("```").step_by(2);
    parts.collect::<Vec<_>>().join("\n")
}

/// The anchors of the headings, as on GitHub.
fn anchors(text: &str) -> BTreeSet<String> {
    let mut counts = BTreeMap::new();
    let headings = prose(text);
    let headings =
        headings.lines().filter_map(|line| line.strip_prefix('#')?.trim_start_matches('#').strip_prefix(' '));
    let anchor = |heading: &str| {
        let slug = heading.to_lowercase();
        let slug = slug.chars().filter(|c| c.is_alphanumeric() || [' ', '-', '_'].contains(c));
        slug.map(|c| if c == ' ' { '-' } else { c }).collect::<String>()
    };
    let numbered = headings.map(|heading| {
        let anchor = anchor(heading);
        let count: &mut usize = counts.entry(anchor.clone()).or_default();
        *count += 1;
        if *count == 1 { anchor } else { format!("{anchor}-{}", *count - 1) }
    });
    numbered.collect()
}

/// The targets of links and pictures outside code.
fn targets(text: &str) -> Vec<String> {
    let mut targets = Vec::new();
    for paragraph in prose(text).split("\n\n") {
        // Every second part is inline code. The others are text.
        let paragraph: String = paragraph.split('`').step_by(2).collect();
        for (start, end) in [("](", ')'), ("src=\"", '"'), ("href=\"", '"')] {
            let found = paragraph.split(start).skip(1).filter_map(|rest| rest.split_once(end));
            targets.extend(found.map(|(target, _)| target.to_owned()));
        }
    }
    targets
}

/// Whether a link in `document` leads to an existing file or heading.
fn leads_somewhere(document: &Path, target: &str) -> bool {
    if target.contains("://") || target.starts_with("mailto:") {
        return true;
    }
    let (file, anchor) = target.split_once('#').unwrap_or((target, ""));
    let path = if file.is_empty() { document.to_owned() } else { document.with_file_name("").join(file) };
    if anchor.is_empty() {
        return path.exists();
    }
    fs::read_to_string(path).is_ok_and(|text| anchors(&text).contains(anchor))
}

#[test]
fn relative_links_and_anchors_lead_somewhere() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut documents: Vec<PathBuf> =
        ["README.md", "CHANGELOG.md", "CONTRIBUTING.md"].map(|name| root.join(name)).into();
    for folder in ["docs", "deploy", "examples", "studies", "tests"] {
        add_documents(&root.join(folder), &mut documents);
    }
    let mut links = 0;
    let mut broken = Vec::new();
    for document in &documents {
        let text = fs::read_to_string(document).expect("a document");
        for target in targets(&text) {
            links += 1;
            if !leads_somewhere(document, &target) {
                broken.push(format!("{}: {target}", document.display()));
            }
        }
    }
    assert!(links > 100, "{links} links in {} documents", documents.len());
    assert_eq!(broken, [""; 0]);
}

#[test]
fn a_broken_link_is_noticed() {
    let folder = tempfile::tempdir().expect("a folder");
    let page = folder.path().join("page.md");
    let text = "# A page\n\n## Table or closed form?\n\n## `a` b_c\n\n## `a` b_c\n\n[`x`](page.md#a-b_c-1) ![](x.png) `[](y)`\n";
    fs::write(&page, text).expect("a page");
    assert_eq!(targets(text), ["page.md#a-b_c-1", "x.png"]);
    for target in ["#a-page", "page.md#table-or-closed-form", "page.md#a-b_c-1", "page.md", "https://example.org"] {
        assert!(leads_somewhere(&page, target), "{target}");
    }
    for target in ["x.png", "#b", "page.md#a-b_c-2", "other.md#a-page"] {
        assert!(!leads_somewhere(&page, target), "{target}");
    }
}
