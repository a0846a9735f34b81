//! Changes that Git makes to pinned files: other line endings, and Git LFS pointers.

use std::{fs, path::Path};

use ltcforge_files::{bounded::read_file, digest::Digest, replace::folder_of, text::other_form};

/// Maximum size of a file that is checked for changes by Git.
const LIMIT_BYTES: u64 = 256 << 20;

/// Describes how Git changed the file at `path` below `folder`, and what to do. `None` if Git is not the cause.
#[must_use]
pub fn change_of_git(path: &Path, digest: Digest, folder: &Path) -> Option<String> {
    let bytes = read_file(&folder.join(path), LIMIT_BYTES).ok()?;
    if let Some(form) = other_form(&bytes) {
        return Some(form);
    }
    let mut before = Vec::with_capacity(bytes.len());
    for (i, byte) in bytes.iter().enumerate() {
        if *byte != b'\r' || bytes.get(i + 1) != Some(&b'\n') {
            before.push(*byte);
        }
    }
    (before.len() < bytes.len() && Digest::of(&before) == digest).then(|| {
        let line = attribute_of(path);
        format!("Git changed the line endings (core.autocrlf): add the line «{line}» to .gitattributes")
    })
}

/// The lines to add to `.gitattributes` in the lock file's `folder`, so that Git keeps the line endings of these files.
/// Each file is a path and its bytes. The list is empty outside of a checkout.
#[must_use]
pub fn missing_attributes<'a>(files: impl Iterator<Item = (&'a Path, &'a [u8])>, folder: &Path) -> Vec<String> {
    /// Git checks this many bytes to decide whether a file is text.
    const BEGINNING: usize = 8000;
    let Ok(root) = fs::canonicalize(folder_of(&folder.join("lock"))) else { return vec![] };
    if !root.ancestors().any(|folder| folder.join(".git").exists()) {
        return vec![];
    }
    let present = read_file(&folder.join(".gitattributes"), 1 << 20).unwrap_or_default();
    let present = String::from_utf8_lossy(&present);
    let is_text = |bytes: &[u8]| !bytes.is_empty() && !bytes[..bytes.len().min(BEGINNING)].contains(&0);
    let texts = files.filter(|(path, bytes)| is_text(bytes) && !present.lines().any(|line| is_kept_by(line, path)));
    texts.map(|(path, _)| attribute_of(path)).collect()
}

/// The line that keeps Git from changing one file.
fn attribute_of(path: &Path) -> String {
    // Git reads a bracket as a pattern, and a blank as the end of the path.
    let pattern = format!("/{}", super::pin::plain(path).display()).replace('[', "[[]");
    if pattern.contains(' ') { format!("\"{pattern}\" -text") } else { format!("{pattern} -text") }
}

/// Whether a line of `.gitattributes` keeps Git from changing a file: the line of [`attribute_of`], or a common
/// pattern.
fn is_kept_by(line: &str, path: &Path) -> bool {
    let line = line.trim();
    if line == attribute_of(path) {
        return true;
    }
    let mut words = line.split_ascii_whitespace();
    let pattern = words.next().unwrap_or_default();
    let keeps = words.any(|word| matches!(word, "-text" | "binary"));
    let (anchored, path) = (pattern.trim_start_matches('/'), super::pin::plain(path).display().to_string());
    let folder = anchored.strip_suffix("/**").filter(|folder| !folder.contains(['*', '?', '[']));
    let ending = pattern.strip_prefix('*').filter(|ending| !ending.contains(['*', '?', '[', '/']));
    keeps
        && (anchored == path
            || folder.is_some_and(|folder| path.strip_prefix(folder).is_some_and(|rest| rest.starts_with('/')))
            || ending.is_some_and(|ending| path.ends_with(ending)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn line_endings_that_git_changed_are_recognised() {
        let folder = tempfile::tempdir().expect("a folder");
        let digest = Digest::of(b"a\nb\n");
        let cause = |bytes: &[u8]| {
            fs::write(folder.path().join("x y"), bytes).expect("a file");
            change_of_git(Path::new("x y"), digest, folder.path())
        };
        let said = cause(b"a\r\nb\r\n").expect("line ends");
        assert!(said.contains("core.autocrlf") && said.contains("«\"/x y\" -text»"), "{said}");
        assert!(cause(b"version https://git-lfs.github.com/spec/v1\n").expect("a pointer").contains("git lfs pull"));
        for other in [&b"a\nb\n"[..], b"a\nc\n", b"a\r\nc\r\n", b"a\rb\r", b""] {
            assert_eq!(cause(other), None, "{other:?}");
        }
    }

    #[test]
    fn missing_attributes_are_listed_once_and_only_in_a_checkout() {
        let folder = tempfile::tempdir().expect("a folder");
        let project = folder.path().join("project");
        fs::create_dir(&project).expect("a folder");
        let files = [("a/x.json", &b"{}\n"[..]), ("./a/b [1].js", b"x"), ("a/y.ktx2", b"\xabKTX\0"), ("empty", b"")];
        let missing = || missing_attributes(files.iter().map(|(path, bytes)| (Path::new(path), *bytes)), &project);
        assert!(missing().is_empty(), "no checkout");
        fs::write(folder.path().join(".git"), "gitdir: elsewhere").expect("a file");
        let all = ["/a/x.json -text", "\"/a/b [[]1].js\" -text"];
        assert_eq!(missing(), all);
        for (present, left) in [
            ("/a/x.json -text\n", &all[1..]),
            ("a/x.json binary", &all[1..]),
            ("# c\n*.json\t-text", &all[1..]),
            ("/a/** -text", &[]),
            ("* -text", &[]),
            ("\"/a/b [[]1].js\" -text\r\n", &all[..1]),
            ("*.json text\n/b/** -text\n/a/*/** -text", &all),
        ] {
            fs::write(project.join(".gitattributes"), present).expect("a file");
            assert_eq!(missing(), left, "{present}");
        }
    }
}
