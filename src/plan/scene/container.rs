//! A scene's bytes: the JSON, the binary chunk of a GLB, and the files that the JSON names. Only files in the scene's
//! folder are read.

use std::{
    io::ErrorKind,
    path::{Component, Path, PathBuf},
};

use base64::{Engine as _, prelude::BASE64_STANDARD};

use super::error::{SceneError, shown};
use ltcforge_files::bounded::read_file;

/// Maximum bytes of a scene's file and all files that it names, together.
pub(super) const MOST_BYTES: u64 = 1 << 30;
/// Maximum bytes of the document.
const MOST_JSON: u64 = 64 << 20;

/// A scene's document and where its other bytes are.
#[derive(Debug)]
pub(super) struct Container {
    pub(super) json: Vec<u8>,
    pub(super) binary: Option<Vec<u8>>,
    /// The folder of files that the document may name; `None` if it may not name files.
    pub(super) folder: Option<PathBuf>,
    /// Bytes that may still be read.
    left: u64,
}

impl Container {
    /// Reads a scene's file.
    pub(super) fn open(path: &Path) -> Result<Self, SceneError> {
        let bytes = read_file(path, MOST_BYTES).map_err(|error| match error.kind() {
            ErrorKind::FileTooLarge => SceneError::fault("", error.to_string()),
            _ => SceneError::Open(error),
        })?;
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        Self::of_bytes(bytes, Some(folder.canonicalize().map_err(SceneError::Open)?))
    }

    /// A scene's bytes, GLB or JSON. The document may name files in `folder`.
    pub(super) fn of_bytes(bytes: Vec<u8>, folder: Option<PathBuf>) -> Result<Self, SceneError> {
        let left = MOST_BYTES.saturating_sub(bytes.len() as u64);
        let (json, binary) = if bytes.starts_with(b"glTF") { chunks(&bytes)? } else { (bytes, None) };
        SceneError::above("bytes of the document", json.len() as u64, MOST_JSON)?;
        Ok(Self { json, binary, folder, left })
    }

    /// The bytes of a URI: data, or a file in the scene's folder.
    pub(super) fn named(&mut self, pointer: &str, uri: &str) -> Result<Vec<u8>, SceneError> {
        let fault = |detail: String| SceneError::fault(pointer, detail);
        if let Some(data) = uri.strip_prefix("data:") {
            let data = data.split_once(',').filter(|(kind, _)| kind.ends_with(";base64"));
            let (_, data) = data.ok_or_else(|| fault("a data URI must have base64 data".to_owned()))?;
            return BASE64_STANDARD.decode(data).map_err(|error| fault(format!("invalid base64: {error}")));
        }
        let Some(name) = decoded(uri).filter(|name| is_below(name)) else {
            return Err(fault(format!("\"{}\" is not a relative path within the scene's folder", shown(uri))));
        };
        let missing = |why: &str| SceneError::Missing(format!("{name} {why}"));
        let folder = self.folder.as_ref().ok_or_else(|| missing("is another file, and only one file was sent"))?;
        let path = folder.join(&name).canonicalize().map_err(|_| missing("does not exist"))?;
        if !path.starts_with(folder) {
            return Err(fault(format!("\"{name}\" is a link that leaves the scene's folder")));
        }
        let bytes = read_file(&path, self.left).map_err(|error| match error.kind() {
            ErrorKind::FileTooLarge => fault(format!("the files of the scene have more than {MOST_BYTES} bytes")),
            _ => missing(&format!("cannot be read: {error}")),
        })?;
        self.left -= bytes.len() as u64;
        Ok(bytes)
    }
}

/// Whether a path stays below the folder that it starts from.
fn is_below(name: &str) -> bool {
    let is_plain = !name.contains(['\\', ':', '\0']) && !name.is_empty();
    is_plain && Path::new(name).components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir))
}

/// A URI without escapes; `None` if an escape is invalid or the text is not UTF-8.
fn decoded(uri: &str) -> Option<String> {
    let mut parts = uri.split('%');
    let mut bytes = parts.next()?.as_bytes().to_vec();
    for part in parts {
        bytes.push(u8::from_str_radix(part.get(..2)?, 16).ok()?);
        bytes.extend(&part.as_bytes()[2..]);
    }
    String::from_utf8(bytes).ok()
}

/// The JSON and the binary chunk of a GLB of version 2.
fn chunks(bytes: &[u8]) -> Result<(Vec<u8>, Option<Vec<u8>>), SceneError> {
    let fault = |detail: String| SceneError::fault("", format!("GLB: {detail}"));
    let word = |at: usize| Some(u32::from_le_bytes(*bytes.get(at..)?.first_chunk()?));
    let header = word(4).zip(word(8)).ok_or_else(|| fault("the header is incomplete".to_owned()))?;
    match header {
        (2, length) if length as usize <= bytes.len() => {}
        (2, length) => {
            return Err(fault(format!("the header states {length} bytes, but the file has {}", bytes.len())));
        }
        (version, _) => return Err(fault(format!("version {version}; only version 2 is supported"))),
    }
    let (mut at, mut json, mut binary) = (12, None, None);
    while let Some((size, kind)) = word(at).zip(bytes.get(at + 4..at + 8)) {
        let end = at + 8 + size as usize;
        let chunk = bytes.get(at + 8..end);
        let chunk = chunk.ok_or_else(|| fault(format!("a chunk of {size} bytes at {at} is incomplete")))?;
        match kind {
            b"JSON" => json = json.or_else(|| Some(chunk.to_vec())),
            b"BIN\0" => binary = binary.or_else(|| Some(chunk.to_vec())),
            _ => {}
        }
        at = end.next_multiple_of(4);
    }
    Ok((json.ok_or_else(|| fault("it has no JSON".to_owned()))?, binary))
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
        assert_eq!(named("a%20b.bin").expect("inside"), b"mine");
        assert!(matches!(named("c.bin"), Err(SceneError::Missing(_))));
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
