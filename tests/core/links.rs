//! Checks that relative links, anchors, and the files and variables of commands in the documents exist.

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

/// Extensions of files that commands read and write.
const EXTENSIONS: [&str; 12] =
    ["json", "glb", "gltf", "csv", "png", "jpg", "safetensors", "npy", "exr", "hdr", "ies", "glsl"];

/// Options and redirections before the name of an output.
const OUTPUTS: [&str; 6] = ["-o", "-Lo", "--out", "--to", ">", ">>"];

/// The command in a line of a code block, without its comment. In a `console`, lines without a prompt are output.
fn command<'a>(language: &str, line: &'a str) -> Option<&'a str> {
    let line = match language {
        "sh" => line,
        "console" => line.strip_prefix("$ ")?,
        _ => return None,
    };
    line.split(" #").next().filter(|line| !line.starts_with('#'))
}

/// The names of the variables that a command reads.
fn variables(command: &str) -> impl Iterator<Item = &str> {
    let names = command.split('$').skip(1).map(|rest| rest.trim_start_matches('{'));
    let names = names.filter_map(|rest| rest.split(|c: char| !c.is_ascii_alphanumeric() && c != '_').next());
    names.filter(|name| !name.is_empty())
}

/// Files and variables of the commands in a document that are neither in the repository nor set by an earlier command.
/// Everything in a folder that a command writes counts as set.
fn missing(root: &Path, text: &str) -> Vec<String> {
    let text = text.replace("\\\n", " ");
    let (mut set, mut missing) = (Vec::new(), Vec::new());
    let blocks = text.split("```").skip(1).step_by(2).filter_map(|block| block.split_once('\n'));
    let lines = blocks.flat_map(|(language, block)| block.lines().filter_map(move |line| command(language, line)));
    for line in lines {
        missing.extend(variables(line).filter(|name| !set.contains(name)).map(|name| format!("${name}")));
        let words = line.split_whitespace().map(|word| word.trim_matches(['(', ')', '\'', '"', ';']));
        let words: Vec<&str> = words.collect();
        for (place, &word) in words.iter().enumerate() {
            let copied = words[0] == "cp" && place + 1 == words.len();
            if copied || place > 0 && OUTPUTS.contains(&words[place - 1]) {
                set.push(word);
            } else if let Some((name, _)) = word.split_once('=') {
                set.push(name);
            } else if word.chars().all(|c| c.is_ascii_alphanumeric() || "/._-".contains(c))
                && word.rsplit_once('.').is_some_and(|(_, extension)| EXTENSIONS.contains(&extension))
                && !set.iter().any(|path| Path::new(word).starts_with(path))
                && !root.join(word).exists()
            {
                missing.push(word.to_owned());
            }
        }
    }
    missing
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

/// The root of the repository, and its documents.
fn documents() -> (&'static Path, Vec<PathBuf>) {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut documents: Vec<PathBuf> =
        ["README.md", "CHANGELOG.md", "CONTRIBUTING.md"].map(|name| root.join(name)).into();
    for folder in ["docs", "deploy", "examples", "studies", "tests"] {
        add_documents(&root.join(folder), &mut documents);
    }
    (root, documents)
}

#[test]
fn commands_use_files_that_exist_or_make_them() {
    let (root, documents) = documents();
    let missing = documents.iter().flat_map(|document| {
        let missing = missing(root, &fs::read_to_string(document).expect("a document"));
        missing.into_iter().map(move |name| format!("{}: {name}", document.display()))
    });
    assert_eq!(missing.collect::<Vec<_>>(), [""; 0]);
}

#[test]
fn a_missing_file_is_noticed() {
    let (root, _) = documents();
    let text = "```sh\nA=1\necho $A > a.csv\n# b.csv\nltcforge light a.csv c.csv -o out  # d.csv\n```\n\
        ```sh\nltcforge report out/e.json $A.json ${F#x}.json\n```\n\
        ```console\n$ cp README.md g.json\nh.json\n$ ltcforge plan g.json \\\n  i.glb docs/recipes/asg.json\n```\n";
    assert_eq!(missing(root, text), ["c.csv", "$F", "i.glb"]);
}

#[test]
fn relative_links_and_anchors_lead_somewhere() {
    let (_, documents) = documents();
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
