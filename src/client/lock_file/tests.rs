use super::*;
use crate::{FilePin, with_pins};

/// The canonical JSON of a recipe.
fn recipe() -> String {
    let read = recipe_document::parse(br#"{"preset": "draft"}"#, u64::MAX).expect("a recipe");
    recipe_document::canonical_json(&read)
}

fn pin(name: &str, path: &str) -> Pin {
    Pin {
        name: name.into(),
        digest: Digest::of(name.as_bytes()),
        path: path.into(),
        bytes: Some(7),
        recipe: Some(recipe()),
        sources: vec![],
        exports: vec![],
    }
}

fn export(files: &[&str]) -> ExportPin {
    let file = |path: &&str| FilePin { path: path.into(), bytes: 3, digest: Digest::of(path.as_bytes()) };
    ExportPin {
        engine: Some("wgpu".into()),
        layout: None,
        container: None,
        precision: None,
        to: "out".into(),
        file: files.iter().map(file).collect(),
    }
}

fn pins(text: &str) -> Result<Vec<Pin>, LockFileError> {
    parse(text).map(|(pins, _)| pins)
}

/// A lock file of version 1 of the format, with comments.
fn old() -> String {
    let (a, b) = (Digest::of(b"a"), Digest::of(b"b"));
    format!(
        "# ours\nversion = 1\n\n# the metal\n[[table]]\nname = \"a\"\ndigest = \"{a}\" # fitted in May\npath = \"x\"\n\
         server = \"http://h\"\n\n[[table]]\nname = \"b\"\ndigest = \"{b}\"\npath = \"y\"\nbytes = 7\n"
    )
}

#[test]
fn pins_are_written_and_read_back() {
    let a = Pin { exports: vec![export(&["out/1", "out/2"]), export(&["out/3"])], ..pin("a", "ltc/a.safetensors") };
    let b = Pin { sources: vec!["http://h".parse().expect("a URL")], ..pin("b", "b.safetensors") };
    let both = [a, b];
    let text = with_pins("", &both).expect("a new file");
    assert_eq!(pins(&text).expect("a lock file"), both, "{text}");
    // The same pins give the same text. Removing a pin leaves the other as it was.
    assert_eq!(with_pins(&text, &both).expect("the same"), text);
    let one = with_pins(&text, &both[..1]).expect("one pin");
    assert_eq!(pins(&one).expect("a lock file"), both[..1], "{one}");
    assert!(text.starts_with(one.trim_end()), "{one}");
}

#[test]
fn version_1_is_read_and_rewritten_with_its_comments() {
    let mut read = pins(&old()).expect("a lock file");
    assert_eq!((read[0].sources.len(), read[0].bytes, read[1].bytes), (1, None, Some(7)));
    let refused = with_pins(&old(), &read).expect_err("no recipe");
    assert!(matches!(refused, LockFileError::Incomplete { field: "recipe", .. }), "{refused}");
    for pin in &mut read {
        (pin.recipe, pin.bytes) = (Some(recipe()), Some(9));
    }
    read[0].exports = vec![export(&["out/1"])];
    let new = with_pins(&old(), &read).expect("a lock file");
    assert_eq!(pins(&new).expect("a lock file"), read, "{new}");
    for kept in ["# ours\nversion = 2\n", "# the metal\n[[table]]\n", "# fitted in May\n", "sources = [\"http://h\"]"] {
        assert!(new.contains(kept), "{kept} is not in {new}");
    }
    assert!(!new.contains("server"), "{new}");
}

#[test]
fn a_newer_version_is_named_whatever_else_it_has() {
    for text in ["version = 3", "version = 3\ncolour = 2\n[[table]]\nshade = 1", "table = 7\nversion = 99"] {
        let refused = parse(text).expect_err(text);
        assert!(refused.to_string().contains("this program reads versions 1 to 2"), "{refused}");
        assert!(matches!(with_pins(text, &[]), Err(LockFileError::Version(_))), "{text}");
    }
    assert!(matches!(parse("version = 0"), Err(LockFileError::Version(0))));
}

#[test]
fn paths_and_names_with_tricks_are_refused() {
    for path in [
        "/etc/passwd",
        "../x",
        "a/../../x",
        "",
        ".",
        "a/..",
        "a\0b",
        "a\nb",
        ".git/config",
        "CON.safetensors",
        "a\\b",
        "a\u{202e}b",
    ] {
        let refused = with_pins("", &[pin("a", path)]);
        assert!(matches!(refused, Err(LockFileError::Path { .. })), "{path:?}: {refused:?}");
        if path != "." {
            let refused = with_pins("", &[Pin { exports: vec![export(&[path])], ..pin("a", "x") }]);
            assert!(matches!(refused, Err(LockFileError::Path { .. })), "{path:?}: {refused:?}");
        }
    }
    for name in ["", "a\0", "a\u{1b}[2J"] {
        assert!(matches!(with_pins("", &[pin(name, "x")]), Err(LockFileError::Name(_))), "{name:?}");
    }
    let text = with_pins("", &[pin("a", "sub/../x").clone()]);
    assert!(matches!(text, Err(LockFileError::Path { .. })), "{text:?}");
    // A table may not replace the lock file itself.
    let text = with_pins("", &[pin("a", "./my.lock")]).expect("a lock file");
    assert!(LockFile::parse(&text, Path::new("p/other.lock")).is_ok());
    assert!(matches!(LockFile::parse(&text, Path::new("p/my.lock")), Err(LockFileError::Path { .. })));
}

#[cfg(unix)]
#[test]
fn a_path_that_is_no_text_is_refused() {
    use std::{ffi::OsStr, os::unix::ffi::OsStrExt as _};

    let path = OsStr::from_bytes(b"a\xffb").into();
    let refused = with_pins("", &[Pin { path, ..pin("a", "x") }]);
    assert!(matches!(refused, Err(LockFileError::NotText(_))), "{refused:?}");
}

#[test]
fn two_pins_share_neither_name_nor_path() {
    let refused = with_pins("", &[pin("a", "x"), pin("b", "./x")]);
    assert!(matches!(refused, Err(LockFileError::Twice { what: "path", .. })), "{refused:?}");
    let refused = with_pins("", &[Pin { exports: vec![export(&["x"])], ..pin("a", "x") }]);
    assert!(matches!(refused, Err(LockFileError::Twice { what: "path", .. })), "{refused:?}");
    let one = with_pins("", &[pin("a", "x")]).expect("a lock file");
    let twice = format!("{one}\n{}", one.replace("version = 2\n", "").replace("\"x\"", "\"y\""));
    assert!(matches!(parse(&twice), Err(LockFileError::Twice { what: "name", .. })), "{twice}");
}

#[test]
fn a_recipe_must_match_its_digest() {
    let text = with_pins("", &[pin("a", "x")]).expect("a lock file");
    let other = text.replace(r#""seed":"#, r#""seed":1"#);
    assert_ne!(other, text);
    assert!(matches!(parse(&other), Err(LockFileError::RecipeDigest { .. })), "{other}");
    let none = text.replace("ggx", "gloss");
    assert_ne!(none, text);
    let refused = parse(&none).expect_err("no recipe");
    assert!(matches!(refused, LockFileError::Recipe { .. }) && refused.to_string().contains("gloss"), "{refused}");
}

#[test]
fn other_files_are_refused() {
    for text in [
        "",
        "version = 1\ncolour = 2",
        "version = 1\n[[table]]\nname = \"a\"",
        "{",
        "version = 1\ntable = 3",
        "version = \"2\"",
        "version = 2\nsources = [\"ftp://h\"]",
        "version = 2\n[[table]]\nname = \"a\"\npath = \"x\"",
    ] {
        assert!(matches!(parse(text), Err(LockFileError::Syntax(_))), "{text}");
    }
}

#[test]
fn two_names_that_some_systems_treat_as_equal_are_refused() {
    for (one, other) in [
        ("Metal", "metal"),
        ("caf\u{e9}", "cafe\u{301}"),
        ("CAF\u{c9}", "cafe\u{301}"),
        ("stra\u{df}e", "STRASSE"),
        ("\u{3a3}\u{3c2}", "\u{3c3}\u{3a3}"),
        ("\u{212b}", "\u{e5}"),
    ] {
        let message = |refused: Result<String, LockFileError>| {
            let refused = refused.expect_err(one);
            assert!(matches!(refused, LockFileError::Alike { .. }), "{refused}");
            refused.to_string()
        };
        let names = message(with_pins("", &[pin(one, "x"), pin(other, "y")]));
        assert!(names.contains(one) && names.contains(other) && names.contains("two tables have the names"), "{names}");
        let paths = message(with_pins("", &[pin("a", &format!("d/{one}")), pin("b", &format!("./d/{other}"))]));
        assert!(paths.contains("two files have the paths"), "{paths}");
        message(with_pins("", &[Pin { exports: vec![export(&[other])], ..pin("a", one) }]));
        with_pins("", &[pin("a", &format!("{one}/x")), pin("b", &format!("{other}/y"))]).expect("other files");
    }
}

#[test]
fn changes_by_git_and_editors_to_a_lock_file_are_named() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("ltcforge.lock");
    let right = with_pins("", &[pin("a", "x")]).expect("a lock file");
    std::fs::write(&path, format!("\u{feff}{}", right.replace('\n', "\r\n"))).expect("a file");
    assert_eq!(LockFile::read(&path).expect("a mark and line ends").pins, [pin("a", "x")]);
    let merged = format!("{right}<<<<<<< HEAD\n# a\n=======\n# b\n>>>>>>> other\n");
    let utf_16: Vec<u8> = "\u{feff}version = 2".encode_utf16().flat_map(u16::to_le_bytes).collect();
    let pointer = b"version https://git-lfs.github.com/spec/v1\noid sha256:00\nsize 7\n";
    for (bytes, message) in [(merged.as_bytes(), "merge marker"), (&utf_16, "UTF-16"), (&pointer[..], "git lfs pull")] {
        std::fs::write(&path, bytes).expect("a file");
        let refused = LockFile::read(&path).expect_err(message).to_string();
        assert!(refused.contains(message), "{refused}");
    }
    let secret = "version = 2\nsources = [\"http://user:secret@h:99999\"]\n";
    let refused = parse(secret).expect_err("a password").to_string();
    assert!(!refused.contains("secret"), "{refused}");
}
