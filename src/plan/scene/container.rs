//! A scene's bytes: the JSON, the binary chunk of a GLB, and files beside it. Nothing outside the scene's folder is
//! read.

use std::{
    fs::File,
    io::Read as _,
    path::{Component, Path, PathBuf},
};

use base64::{Engine as _, prelude::BASE64_STANDARD};

use super::error::SceneError;

/// Bytes of a scene's file, and of all that it names together.
pub(super) const MOST_BYTES: u64 = 1 << 30;
/// Bytes of the document.
const MOST_JSON: u64 = 64 << 20;
const MAGIC: &[u8; 4] = b"glTF";
const JSON_CHUNK: &[u8; 4] = b"JSON";
const BINARY_CHUNK: &[u8; 4] = b"BIN\0";

/// A scene's document and where its other bytes are.
#[derive(Debug)]
pub(super) struct Container {
    pub(super) json: Vec<u8>,
    pub(super) binary: Option<Vec<u8>>,
    /// The folder of files that the document may name; `None` where it may name none.
    folder: Option<PathBuf>,
    /// Bytes that may still be read.
    left: u64,
}

/// Bytes that a document names.
#[derive(Debug, PartialEq)]
pub(super) enum Named {
    Bytes(Vec<u8>),
    /// They are not there.
    Missing(String),
}

impl Container {
    /// The scene of a file.
    pub(super) fn open(path: &Path) -> Result<Self, SceneError> {
        let refused = |error: &dyn std::fmt::Display| SceneError::Open { detail: error.to_string() };
        let bytes = read(path, MOST_BYTES).map_err(|error| match error {
            ReadError::Io(error) => refused(&error),
            ReadError::Long(is) => SceneError::TooMuch { what: "bytes of the file".to_owned(), is, most: MOST_BYTES },
        })?;
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let folder = folder.canonicalize().map_err(|error| refused(&error))?;
        Self::of_bytes(bytes, Some(folder))
    }

    /// A scene's bytes, GLB or JSON. Files beside it are in `folder`.
    pub(super) fn of_bytes(bytes: Vec<u8>, folder: Option<PathBuf>) -> Result<Self, SceneError> {
        let left = MOST_BYTES.saturating_sub(bytes.len() as u64);
        let (json, binary) = if bytes.starts_with(MAGIC) { chunks(&bytes)? } else { (bytes, None) };
        SceneError::above("bytes of the document", json.len() as u64, MOST_JSON)?;
        Ok(Self { json, binary, folder, left })
    }

    /// The bytes of a URI: data, or a file in the scene's folder.
    pub(super) fn named(&mut self, pointer: &str, uri: &str) -> Result<Named, SceneError> {
        let wrong = |detail: String| Err(SceneError::fault(pointer, detail));
        if let Some(data) = uri.strip_prefix("data:") {
            let Some((kind, data)) = data.split_once(',') else { return wrong("a data URI without a comma".into()) };
            if !kind.ends_with(";base64") {
                return wrong("a data URI has to be base64".into());
            }
            return match BASE64_STANDARD.decode(data) {
                Ok(bytes) => Ok(Named::Bytes(bytes)),
                Err(error) => wrong(format!("no base64: {error}")),
            };
        }
        let Some(name) = decoded(uri).filter(|name| is_below(name)) else {
            let shown: String = uri.chars().take(80).collect();
            return wrong(format!("\"{shown}\" is no file in the scene's folder: relative paths without .. are read"));
        };
        let Some(folder) = &self.folder else {
            return Ok(Named::Missing(format!("{name} is another file, and only this one was sent")));
        };
        let Ok(path) = folder.join(&name).canonicalize() else {
            return Ok(Named::Missing(format!("{name} is not there")));
        };
        if !path.starts_with(folder) {
            return wrong(format!("\"{name}\" leads out of the scene's folder"));
        }
        match read(&path, self.left) {
            Ok(bytes) => {
                self.left -= bytes.len() as u64;
                Ok(Named::Bytes(bytes))
            }
            Err(ReadError::Io(error)) => Ok(Named::Missing(format!("{name}: {error}"))),
            Err(ReadError::Long(_)) => {
                Err(SceneError::TooMuch { what: "bytes of the scene".into(), is: MOST_BYTES + 1, most: MOST_BYTES })
            }
        }
    }
}

enum ReadError {
    Io(std::io::Error),
    Long(u64),
}

/// The bytes of a regular file, if they are no more than `most`.
fn read(path: &Path, most: u64) -> Result<Vec<u8>, ReadError> {
    let file = File::open(path).map_err(ReadError::Io)?;
    let about = file.metadata().map_err(ReadError::Io)?;
    if !about.is_file() {
        return Err(ReadError::Io(std::io::Error::other("not a file")));
    }
    if about.len() > most {
        return Err(ReadError::Long(about.len()));
    }
    let mut bytes = Vec::new();
    file.take(most + 1).read_to_end(&mut bytes).map_err(ReadError::Io)?;
    if bytes.len() as u64 > most { Err(ReadError::Long(bytes.len() as u64)) } else { Ok(bytes) }
}

/// Whether a path stays below the folder that it starts from.
fn is_below(name: &str) -> bool {
    let is_plain = !name.contains(['\\', ':', '\0']) && !name.is_empty();
    is_plain && Path::new(name).components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir))
}

/// A URI's text with its escapes undone; `None` where it is not UTF-8.
fn decoded(uri: &str) -> Option<String> {
    let (mut bytes, mut out) = (uri.bytes(), Vec::new());
    while let Some(byte) = bytes.next() {
        out.push(match byte {
            b'%' => {
                let digits = [bytes.next()?, bytes.next()?];
                u8::from_str_radix(std::str::from_utf8(&digits).ok()?, 16).ok()?
            }
            plain => plain,
        });
    }
    String::from_utf8(out).ok()
}

/// The JSON and the binary chunk of a GLB of version 2.
fn chunks(bytes: &[u8]) -> Result<(Vec<u8>, Option<Vec<u8>>), SceneError> {
    let wrong = |detail: String| Err(SceneError::fault("", format!("GLB: {detail}")));
    let word = |at: usize| bytes.get(at..at + 4).map(|word| u32::from_le_bytes([word[0], word[1], word[2], word[3]]));
    let Some((version, length)) = word(4).zip(word(8)) else { return wrong("the header is cut short".into()) };
    if version != 2 {
        return wrong(format!("version {version}; version 2 is read"));
    }
    if length as usize > bytes.len() {
        return wrong(format!("{length} bytes by its header, {} in all", bytes.len()));
    }
    let (mut at, mut json, mut binary) = (12, None, None);
    while let Some((size, kind)) = word(at).zip(bytes.get(at + 4..at + 8)) {
        let Some(chunk) = bytes.get(at + 8..at + 8 + size as usize) else {
            return wrong(format!("a chunk of {size} bytes at {at} goes beyond the end"));
        };
        match kind {
            kind if kind == JSON_CHUNK && json.is_none() => json = Some(chunk.to_vec()),
            kind if kind == BINARY_CHUNK && binary.is_none() => binary = Some(chunk.to_vec()),
            _ => {}
        }
        at += 8 + (size as usize).next_multiple_of(4);
    }
    match json {
        Some(json) => Ok((json, binary)),
        None => wrong("it has no JSON".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_that_leave_the_folder_are_refused() {
        let folder = tempfile::tempdir().expect("a folder");
        std::fs::create_dir(folder.path().join("scene")).expect("a folder");
        std::fs::write(folder.path().join("secret.bin"), b"secret").expect("a file");
        std::fs::write(folder.path().join("scene/a b.bin"), b"mine").expect("a file");
        let inside = folder.path().join("scene").canonicalize().expect("a folder");
        let mut container = Container::of_bytes(b"{}".to_vec(), Some(inside.clone())).expect("a container");
        let mut named = |uri: &str| container.named("/buffers/0/uri", uri);
        assert_eq!(named("a%20b.bin").expect("inside"), Named::Bytes(b"mine".to_vec()));
        assert!(matches!(named("c.bin"), Ok(Named::Missing(_))));
        for out in ["../secret.bin", "%2e%2e/secret.bin", "/etc/passwd", "file:///etc/passwd", "a/../../secret.bin", ""]
        {
            assert!(matches!(named(out), Err(SceneError::Faults(_))), "{out}");
        }
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink("../secret.bin", inside.join("link.bin")).expect("a link");
            assert!(matches!(named("link.bin"), Err(SceneError::Faults(_))));
        }
    }

    #[test]
    fn any_start_of_a_glb_gives_an_answer() {
        let mut glb = b"glTF\x02\0\0\0\x1c\0\0\0\x08\0\0\0JSON{}      ".to_vec();
        glb.truncate(28);
        assert_eq!(Container::of_bytes(glb.clone(), None).expect("a scene").json, b"{}      ");
        for end in 4..28 {
            let cut = Container::of_bytes(glb[..end].to_vec(), None);
            assert!(cut.is_err(), "{end}");
        }
    }
}
