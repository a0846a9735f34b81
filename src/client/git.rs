//! Changes that Git makes to pinned files: other line ends, and pointers of Git LFS.

use std::{fs, path::Path};

use ltcforge_files::{bounded::read_file, digest::Digest, replace::folder_of, text::other_form};

/// The longest file that is looked at for what Git changed.
const LIMIT_BYTES: u64 = 256 << 20;

/// Why the file at `path` below `folder` does not have its pinned digest, where Git is to blame, and what to do.
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
        format!(
            "its line ends were changed, as Git does with core.autocrlf: the line «{line}» in .gitattributes keeps them"
        )
    })
}

/// The lines of `.gitattributes` in the lock file's `folder` that keep Git from changing line ends of these files, by
/// path and bytes, and that are not there. None outside of a checkout.
#[must_use]
pub fn missing_attributes<'a>(files: impl Iterator<Item = (&'a Path, &'a [u8])>, folder: &Path) -> Vec<String> {
    /// As many bytes as Git looks at.
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
    // Git takes a bracket for a pattern, and a blank for the end of the path.
    let pattern = format!("/{}", super::pin::plain(path).display()).replace('[', "[[]");
    if pattern.contains(' ') { format!("\"{pattern}\" -text") } else { format!("{pattern} -text") }
}

/// Whether a line of `.gitattributes` keeps Git from changing a file: one of [`attribute_of`], or a common pattern.
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
    fn line_ends_that_git_changed_are_told_from_other_changes() {
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
    fn lines_of_attributes_are_named_once_and_in_a_checkout_only() {
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
