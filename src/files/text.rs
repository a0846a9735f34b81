//! Changes that editors and version control make to texts and files.

/// The byte-order mark that some editors put before UTF-8 text.
const MARK: &[u8] = b"\xef\xbb\xbf";
/// The first line of a Git LFS pointer, which replaces a file.
const LFS: &[u8] = b"version https://git-lfs.github.com/spec/";
/// Maximum size of a text that is searched for merge markers.
const TEXT_LIMIT_BYTES: usize = 4 << 20;

/// A text without a byte-order mark.
#[must_use]
pub fn without_mark(text: &[u8]) -> &[u8] {
    text.strip_prefix(MARK).unwrap_or(text)
}

/// If rejected bytes are a Git LFS pointer, UTF-16 text, or text with merge markers, returns a message that names the
/// problem and its fix. `None` for other bytes.
#[must_use]
pub fn other_form(bytes: &[u8]) -> Option<String> {
    if without_mark(bytes).starts_with(LFS) {
        return Some("this is a Git LFS pointer, not the file: fetch the file with `git lfs pull`".to_owned());
    }
    if bytes.starts_with(b"\xff\xfe") || bytes.starts_with(b"\xfe\xff") {
        return Some("the text is in UTF-16: save it as UTF-8".to_owned());
    }
    let text = str::from_utf8(bytes).ok().filter(|text| text.len() <= TEXT_LIMIT_BYTES)?;
    let is_marker = |line: &str| ["<<<<<<<", "=======", ">>>>>>>", "|||||||"].iter().any(|mark| line.starts_with(mark));
    let line = text.lines().position(is_marker)? + 1;
    Some(format!("line {line} is a merge marker: resolve the conflict, and delete the lines with markers"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn changes_by_editors_and_git_are_recognised() {
        assert_eq!(without_mark(b"\xef\xbb\xbf{}"), b"{}");
        assert_eq!(without_mark(b"{}"), b"{}");
        let pointer = b"version https://git-lfs.github.com/spec/v1\noid sha256:00\nsize 7\n";
        assert!(other_form(pointer).expect("a pointer").contains("git lfs pull"));
        assert!(other_form(b"\xff\xfe{\0}\0").expect("UTF-16").contains("UTF-8"));
        for text in ["<<<<<<< HEAD\r\na\r\n=======\r\nb\r\n>>>>>>> other\r\n", "||||||| base", "a\n=======\n"] {
            assert!(other_form(text.as_bytes()).expect(text).contains("merge marker"), "{text}");
        }
        assert!(other_form(b"a\n\n<<<<<<< HEAD").expect("a marker").starts_with("line 3 "));
        for other in [&b""[..], b"{", b"# <<<<<<<", b"<<<<<<", b"\xef\xbb\xbf{", b"\0\0<<<<<<<", b"version = 2"] {
            assert_eq!(other_form(other), None, "{other:?}");
        }
    }
}
