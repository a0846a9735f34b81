//! The sources of pinned tables: services, and folders of `<digest>.safetensors` files.

use std::{
    ffi::OsString,
    fmt,
    io::{self, Write},
    path::{Path, PathBuf},
    str::FromStr,
};

use serde::Deserialize;

use super::{
    Access, Client, ClientError, SourcesError, Wanted,
    base::parse_base,
    download::copy,
    error::{bad_url, is_hidden},
};
use ltcforge_files::bounded::open_regular;

/// A place that may have a table, written as a URL or as the path of a folder.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[serde(try_from = "String")]
pub enum Source {
    /// A service, by its URL.
    Server(String),
    /// A folder with tables that are named by their digests, as `fit` writes them.
    Folder(PathBuf),
}

impl FromStr for Source {
    type Err = ClientError;

    /// A text with `://` is a URL.
    fn from_str(text: &str) -> Result<Self, ClientError> {
        if text.contains("://") {
            return Self::server(text);
        }
        if text.is_empty() || text.contains(is_hidden) {
            return Err(bad_url(text, NO_SOURCE));
        }
        Ok(Self::Folder(text.into()))
    }
}

const NO_SOURCE: &str = "a source is the URL of a server or the path of a folder";

impl TryFrom<OsString> for Source {
    type Error = ClientError;

    /// A name that is not UTF-8 is the path of a folder.
    fn try_from(name: OsString) -> Result<Self, ClientError> {
        let text = name.to_string_lossy();
        if name.to_str().is_some() {
            text.parse()
        } else if text.contains("://") || text.contains(is_hidden) {
            Err(bad_url(&text, NO_SOURCE))
        } else {
            Ok(Self::Folder(name.into()))
        }
    }
}

impl TryFrom<String> for Source {
    type Error = ClientError;

    fn try_from(text: String) -> Result<Self, ClientError> {
        text.parse()
    }
}

impl fmt::Display for Source {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Server(url) => f.write_str(url),
            Self::Folder(folder) => fmt::Display::fmt(&folder.display(), f),
        }
    }
}

impl Source {
    /// The service at `url`.
    ///
    /// # Errors
    /// [`ClientError::BadUrl`] when `url` is not an http or https URL, or has a user.
    pub fn server(url: &str) -> Result<Self, ClientError> {
        parse_base(url.trim_end_matches('/'))?;
        Ok(Self::Server(url.to_owned()))
    }

    /// This source, with a relative folder resolved below `folder`.
    #[must_use]
    pub fn below(&self, folder: &Path) -> Self {
        match self {
            Self::Server(_) => self.clone(),
            Self::Folder(path) => Self::Folder(folder.join(path)),
        }
    }

    /// Writes the wanted file to `sink` as it arrives, and checks its size and hash.
    fn write_to(&self, wanted: &Wanted, access: &Access<'_>, sink: &mut dyn Write) -> Result<(), SourcesError> {
        match self {
            Self::Server(url) if access.offline => {
                let reason = "--offline sends no request to a server".to_owned();
                Err(ClientError::Unavailable { url: url.clone(), reason }.into())
            }
            Self::Server(url) => Client::new(url, access.tokens)?.download(wanted, access, sink),
            Self::Folder(folder) => {
                let path = folder.join(format!("{}.safetensors", wanted.digest.hex()));
                let place = path.display().to_string();
                let failed =
                    |error: io::Error| ClientError::Unreadable { place: place.clone(), reason: error.to_string() };
                copy((&place, open_regular(&path).map_err(failed)?), wanted, access, failed, sink)
            }
        }
    }
}

/// Writes a file to a sink.
type Download<'a> = dyn FnMut(&mut dyn Write) -> Result<(), SourcesError> + 'a;

/// Tries `sources` in order until one delivers the wanted file. Calls `attempt` once for each source, with a function
/// that writes the file to a sink. Each attempt starts with an empty sink.
///
/// # Errors
/// When no source has the file, `attempt` fails to write it, or the user stopped the download.
pub(super) fn from_first<T>(
    sources: &[Source],
    wanted: &Wanted,
    access: &Access<'_>,
    attempt: &mut dyn FnMut(&mut Download<'_>) -> Result<T, SourcesError>,
) -> Result<T, SourcesError> {
    let mut failures = Vec::new();
    for source in sources {
        match attempt(&mut |sink: &mut dyn Write| source.write_to(wanted, access, sink)) {
            Err(SourcesError::NoneHasIt(errors)) => failures.extend(errors),
            ended => return ended,
        }
    }
    Err(SourcesError::NoneHasIt(failures))
}

/// The bytes of the wanted file, from the first of `sources` that has it.
///
/// # Errors
/// When no source has the file, or the user stopped the download.
pub fn fetch(sources: &[Source], wanted: &Wanted, access: &Access<'_>) -> Result<Vec<u8>, SourcesError> {
    from_first(sources, wanted, access, &mut |write| {
        let mut bytes = Vec::new();
        write(&mut bytes)?;
        Ok(bytes)
    })
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;
    use crate::{ServerTokens, TABLE_BYTES};
    use ltcforge_files::digest::Digest;

    const ACCESS: Access<'static> =
        Access { table_bytes: TABLE_BYTES, offline: false, tokens: &ServerTokens::NONE, should_stop: &|| false };

    fn fetched(sources: &[Source], digest: Digest, stated_bytes: Option<u64>) -> Result<Vec<u8>, SourcesError> {
        fetch(sources, &Wanted::table(digest, stated_bytes), &ACCESS)
    }

    #[test]
    fn a_url_is_a_server_and_anything_else_a_folder() {
        assert_eq!("https://h/ltc".parse::<Source>().expect("a URL"), Source::Server("https://h/ltc".into()));
        assert_eq!("../cache".parse::<Source>().expect("a folder"), Source::Folder("../cache".into()));
        for wrong in ["", "ftp://h", "http://", "a\0b", "a\nb", "a\u{202e}b"] {
            assert!(wrong.parse::<Source>().is_err(), "{wrong:?}");
        }
        let below = Source::Folder("cache".into()).below(Path::new("project"));
        assert_eq!(below, Source::Folder("project/cache".into()));
    }

    #[test]
    fn sources_are_tried_in_order_until_one_has_the_right_bytes() {
        let folder = tempfile::tempdir().expect("a folder");
        let digest = Digest::of(b"right");
        let sources: Vec<Source> =
            ["none", "wrong", "right"].map(|name| Source::Folder(folder.path().join(name))).into();
        for (name, bytes) in [("wrong", "other"), ("right", "right")] {
            fs::create_dir(folder.path().join(name)).expect("a folder");
            fs::write(folder.path().join(name).join(format!("{}.safetensors", digest.hex())), bytes).expect("a file");
        }
        assert_eq!(fetched(&sources, digest, None).expect("the third"), b"right");
        let refused = fetched(&sources[..2], digest, None).expect_err("none of two");
        let SourcesError::NoneHasIt(errors) = refused else { panic!("{refused}") };
        assert!(matches!(errors[..], [ClientError::Unreadable { .. }, ClientError::Mismatch { .. }]), "{errors:?}");
        assert_eq!(fetched(&sources, digest, Some(5)).expect("the third"), b"right");
        let long = fetched(&sources[2..], digest, Some(6)).expect_err("too short");
        assert!(long.to_string().contains("has 5 bytes, but the lock file states 6"), "{long}");
        let short = fetched(&sources[2..], digest, Some(4)).expect_err("too long");
        assert!(short.to_string().contains("longer than 4 bytes, the size that the lock file states"), "{short}");
    }

    #[cfg(unix)]
    #[test]
    fn an_endless_file_is_not_read_and_no_server_is_called_offline() {
        let folder = tempfile::tempdir().expect("a folder");
        let digest = Digest::of(b"");
        std::os::unix::fs::symlink("/dev/zero", folder.path().join(format!("{}.safetensors", digest.hex())))
            .expect("a link");
        let endless = Source::Folder(folder.path().into());
        let refused = fetched(&[endless], digest, None).expect_err("a device");
        assert!(refused.to_string().contains("not a regular file"), "{refused}");
        let server = [Source::Server("http://127.0.0.1:9".into())];
        let refused =
            fetch(&server, &Wanted::table(digest, None), &Access { offline: true, ..ACCESS }).expect_err("offline");
        assert!(refused.to_string().contains("--offline"), "{refused}");
    }
}
