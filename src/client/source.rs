//! The sources of pinned tables: services, and folders of `<digest>.safetensors` files.

use std::{
    ffi::OsString,
    fmt,
    fs::File,
    io::{self, Read as _, Write},
    path::{Path, PathBuf},
    str::FromStr,
};

use serde::Deserialize;

use super::{
    Client, ClientError, DownloadError, Limits, ServerTokens,
    download::{HashingWriter, size_limit},
    error::{is_hidden, shown},
};
use ltcforge_files::digest::Digest;

/// A place that may have a table. Written as a URL, or as the path of a folder.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[serde(try_from = "String")]
pub enum Source {
    /// A service, by its URL.
    Server(String),
    /// A folder of tables under their digests, as `fit` writes them.
    Folder(PathBuf),
}

impl FromStr for Source {
    type Err = ClientError;

    /// A text with `://` in it is a URL.
    fn from_str(text: &str) -> Result<Self, ClientError> {
        if text.contains("://") {
            return Self::server(text);
        }
        if text.is_empty() || text.contains(is_hidden) {
            return Err(ClientError::BadSource { source_name: shown(text) });
        }
        Ok(Self::Folder(text.into()))
    }
}

impl TryFrom<OsString> for Source {
    type Error = ClientError;

    /// A name that is not UTF-8 is the path of a folder.
    fn try_from(name: OsString) -> Result<Self, ClientError> {
        let name = match name.into_string() {
            Ok(text) => return text.parse(),
            Err(name) => name,
        };
        let text = name.to_string_lossy();
        if text.contains("://") || text.contains(is_hidden) {
            return Err(ClientError::BadSource { source_name: shown(&text) });
        }
        Ok(Self::Folder(name.into()))
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
    /// [`ClientError::BadUrl`] when that is not an http or https URL.
    pub fn server(url: &str) -> Result<Self, ClientError> {
        Client::new(url)?;
        Ok(Self::Server(url.to_owned()))
    }

    /// The same, with the path of a folder relative to `folder`.
    #[must_use]
    pub fn below(&self, folder: &Path) -> Self {
        match self {
            Self::Server(_) => self.clone(),
            Self::Folder(path) => Self::Folder(folder.join(path)),
        }
    }

    /// Writes the wanted file to `sink` as it arrives, and checks its hash. Its greatest length is the one that the
    /// lock file states, or else the limit of `access`.
    ///
    /// # Errors
    /// See [`DownloadError`]. The bytes that are in `sink` by then must not be used.
    fn write_to(&self, wanted: &Wanted<'_>, access: &Access<'_>, sink: &mut dyn Write) -> Result<(), DownloadError> {
        let Wanted { digest, stated_bytes, of } = *wanted;
        match self {
            Self::Server(url) if access.offline => {
                let reason = "--offline sends no request to a server".to_owned();
                Err(ClientError::Unavailable { url: url.clone(), reason }.into())
            }
            Self::Server(url) => {
                let client = Client::with_limits(url, access.limits)?.with_tokens(access.tokens);
                let download = match of {
                    None => client.table(digest)?,
                    Some(Exported { table, export, path }) => client.exported(table, export, path, digest)?,
                };
                download.write_to(stated_bytes, access.should_stop, sink)
            }
            Self::Folder(folder) => {
                let path = folder.join(format!("{}.safetensors", digest.hex()));
                copy_file(&path, digest, stated_bytes, access, sink)
            }
        }
    }
}

/// A file to request from sources.
#[derive(Debug, Clone, Copy)]
pub(super) struct Wanted<'a> {
    /// Its digest.
    pub(super) digest: Digest,
    /// Its size, as the lock file says.
    pub(super) stated_bytes: Option<u64>,
    /// The export that it belongs to; `None` for a table.
    pub(super) of: Option<Exported<'a>>,
}

/// A file that a service makes from a table.
#[derive(Debug, Clone, Copy)]
pub(super) struct Exported<'a> {
    /// The table.
    pub(super) table: Digest,
    /// The name of the export.
    pub(super) export: &'a str,
    /// The file's path in it.
    pub(super) path: &'a str,
}

/// How sources are accessed.
#[derive(Clone, Copy)]
pub struct Access<'a> {
    /// Limits on their answers.
    pub limits: Limits,
    /// Send no request to a server.
    pub offline: bool,
    /// Tokens of servers.
    pub tokens: &'a ServerTokens,
    /// Called repeatedly while a table arrives.
    pub should_stop: &'a dyn Fn() -> bool,
}

impl fmt::Debug for Access<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Access").field("limits", &self.limits).field("offline", &self.offline).finish_non_exhaustive()
    }
}

/// Copies the file of a table that is named after its digest.
fn copy_file(
    path: &Path,
    expected: Digest,
    stated_bytes: Option<u64>,
    access: &Access<'_>,
    sink: &mut dyn Write,
) -> Result<(), DownloadError> {
    let place = || path.display().to_string();
    let refused = |error: io::Error| ClientError::Unreadable { place: place(), reason: error.to_string() };
    let size = size_limit(stated_bytes, access.limits);
    // Pipes and devices may have no end, and opening a pipe may block.
    if !path.metadata().map_err(refused)?.is_file() {
        return Err(refused(io::Error::new(io::ErrorKind::InvalidInput, "this is not a regular file")).into());
    }
    let mut file = File::open(path).map_err(refused)?;
    let mut sink = HashingWriter::new(sink);
    let mut chunk = vec![0; 1 << 16];
    let mut total = 0;
    loop {
        if (access.should_stop)() {
            return Err(DownloadError::Stopped);
        }
        match file.read(&mut chunk) {
            Ok(0) => break size.check(&place(), total)?,
            Ok(read) => {
                total += read as u64;
                if total > size.bytes {
                    return Err(
                        ClientError::TooLong { url: place(), limit_bytes: size.bytes, origin: size.origin }.into()
                    );
                }
                sink.write_all(&chunk[..read])?;
            }
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) => return Err(refused(error).into()),
        }
    }
    let actual = sink.digest();
    if actual == expected { Ok(()) } else { Err(ClientError::Mismatch { url: place(), expected, actual }.into()) }
}

/// The reason that no source delivered a table.
#[derive(Debug, thiserror::Error)]
pub enum SourcesError {
    /// None of them has it. The errors are in the order of the sources.
    #[error("{}", list(.0))]
    NoneHasIt(Vec<ClientError>),
    /// The table could not be written.
    #[error(transparent)]
    Write(#[from] io::Error),
    /// The user stopped it.
    #[error("it was stopped")]
    Stopped,
}

fn list(errors: &[ClientError]) -> String {
    if errors.is_empty() {
        return "there is no source to get it from".to_owned();
    }
    errors.iter().map(ToString::to_string).collect::<Vec<_>>().join("; ")
}

/// Writes a table to a sink.
type Download<'a> = dyn FnMut(&mut dyn Write) -> Result<(), DownloadError> + 'a;

/// Tries `sources` in order until one delivers the wanted file. `attempt` is called once for each source that is tried,
/// with a function that writes the file to a sink, and begins with an empty sink each time.
///
/// # Errors
/// When no source has it, `attempt` fails to write it, or the user stopped it.
pub(super) fn from_first<T>(
    sources: &[Source],
    wanted: &Wanted<'_>,
    access: &Access<'_>,
    attempt: &mut dyn FnMut(&mut Download<'_>) -> Result<T, DownloadError>,
) -> Result<T, SourcesError> {
    let mut failures = Vec::new();
    for source in sources {
        match attempt(&mut |sink: &mut dyn Write| source.write_to(wanted, access, sink)) {
            Ok(done) => return Ok(done),
            Err(DownloadError::Client(error)) => failures.push(error),
            Err(DownloadError::Write(error)) => return Err(SourcesError::Write(error)),
            Err(DownloadError::Stopped) => return Err(SourcesError::Stopped),
        }
    }
    Err(SourcesError::NoneHasIt(failures))
}

/// The bytes of the table `digest`, from the first of `sources` that has it.
///
/// # Errors
/// As `from_first`.
pub fn fetch(
    sources: &[Source],
    digest: Digest,
    stated_bytes: Option<u64>,
    access: &Access<'_>,
) -> Result<Vec<u8>, SourcesError> {
    from_first(sources, &Wanted { digest, stated_bytes, of: None }, access, &mut |write| {
        let mut bytes = Vec::new();
        write(&mut bytes)?;
        Ok(bytes)
    })
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    fn access() -> Access<'static> {
        static NONE: ServerTokens = ServerTokens::NONE;
        Access { limits: Limits::USUAL, offline: false, tokens: &NONE, should_stop: &|| false }
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
        assert_eq!(fetch(&sources, digest, None, &access()).expect("the third"), b"right");
        let refused = fetch(&sources[..2], digest, None, &access()).expect_err("none of two");
        let SourcesError::NoneHasIt(said) = refused else { panic!("{refused}") };
        assert!(matches!(said[..], [ClientError::Unreadable { .. }, ClientError::Mismatch { .. }]), "{said:?}");
        assert_eq!(fetch(&sources, digest, Some(5), &access()).expect("the third"), b"right");
        let long = fetch(&sources[2..], digest, Some(6), &access()).expect_err("too short");
        assert!(long.to_string().contains("has 5 bytes, the lock file states 6"), "{long}");
        let short = fetch(&sources[2..], digest, Some(4), &access()).expect_err("too long");
        assert!(short.to_string().contains("longer than 4 bytes, the size that the lock file states"), "{short}");
    }

    #[cfg(unix)]
    #[test]
    fn nothing_endless_is_read_and_no_server_asked_offline() {
        let folder = tempfile::tempdir().expect("a folder");
        let digest = Digest::of(b"");
        std::os::unix::fs::symlink("/dev/zero", folder.path().join(format!("{}.safetensors", digest.hex())))
            .expect("a link");
        let endless = Source::Folder(folder.path().into());
        let refused = fetch(&[endless], digest, None, &access()).expect_err("a device");
        assert!(refused.to_string().contains("not a regular file"), "{refused}");
        let server = [Source::Server("http://127.0.0.1:9".into())];
        let refused = fetch(&server, digest, None, &Access { offline: true, ..access() }).expect_err("offline");
        assert!(refused.to_string().contains("--offline"), "{refused}");
    }
}
