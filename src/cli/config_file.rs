//! `ltcforge.toml`: settings that are the same for each run.
//!
//! ```toml
//! server = "http://farm:8317"
//! sources = ["../tables", "https://ltc.example.org"]
//!
//! [serve]
//! listen = "0.0.0.0:8317"
//! data = "/srv/ltcforge"
//! workers = 8
//! queue_limit = 64
//! entry_limit = 2000000
//! job_seconds = 86400
//! job_days = 90
//! adapter = "cpu"
//! picture_seconds = 30
//! allow_host = ["farm", "farm.example"]
//! allow_origin = ["https://wiki.example"]
//! tokens = "/etc/ltcforge/tokens"
//! requests = 256
//! client_seconds = 30
//! ```

use std::{io, path::Path};

use serde::Deserialize;

#[cfg(unix)]
use super::service::ServeSettings;
use super::{CommandFailure, exit::usage};
use ltcforge_client::{Source, without_passwords};
use ltcforge_files::{
    bounded::read_file,
    text::{other_form, without_mark},
};

/// Builds without the service ignore its settings, so that a project can have one file for all systems.
#[cfg(not(unix))]
type ServeSettings = serde::de::IgnoredAny;

/// The configuration file to read if the user names no file.
const DEFAULT_FILE: &str = "ltcforge.toml";

/// Maximum size of a configuration file.
const LIMIT_BYTES: u64 = 1 << 20;

/// The service that the client commands call by default.
pub(super) const DEFAULT_SERVER: &str = "http://127.0.0.1:8317";

/// The settings of a file, with defaults for missing settings.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct ConfigFile {
    pub(super) server: Option<String>,
    /// Sources that `lock` and `pull` try before `server`.
    pub(super) sources: Vec<Source>,
    pub(super) serve: ServeSettings,
}

impl ConfigFile {
    /// Reads the file `named`, or else the default file if it exists.
    ///
    /// # Errors
    /// When `named` does not exist, or the file is invalid.
    pub(super) fn load(named: Option<&Path>) -> Result<Self, CommandFailure> {
        let path = named.unwrap_or(Path::new(DEFAULT_FILE));
        let refuse = |reason: String| usage(format!("{}: {reason}", path.display()));
        match read_file(path, LIMIT_BYTES) {
            Ok(bytes) => {
                let other = |error: String| refuse(other_form(&bytes).unwrap_or(error));
                let text = str::from_utf8(without_mark(&bytes)).map_err(|error| other(error.to_string()))?;
                Self::parse(text).map_err(other)
            }
            Err(error) if error.kind() == io::ErrorKind::NotFound && named.is_none() => Ok(Self::default()),
            Err(error) => Err(refuse(error.to_string())),
        }
    }

    fn parse(text: &str) -> Result<Self, String> {
        toml_edit::de::from_str(text).map_err(|error| without_passwords(error.to_string().trim_end()))
    }
}

#[cfg(all(test, unix))]
mod tests {
    use std::net::SocketAddr;

    use super::*;
    use ltcforge_view::preview::Adapter;

    #[test]
    fn settings_are_read_and_unknown_ones_refused() {
        let file = ConfigFile::parse("server = 'http://h'\n[serve]\nlisten = '[::1]:80'\nworkers = 3\nadapter = 'gpu'")
            .expect("good");
        assert_eq!(file.server.as_deref(), Some("http://h"));
        assert_eq!(file.serve.listen, SocketAddr::from(([0, 0, 0, 0, 0, 0, 0, 1], 80)));
        assert_eq!(file.serve.workers, "3".parse().ok());
        assert_eq!(file.serve.adapter, Adapter::Gpu);
        for text in [
            "colour = 1",
            "[serve]\nport = 1",
            "[serve]\nworkers = 0",
            "[serve]\nworkers = 513",
            "[serve]\ndatabase = 'postgres://h/d'",
            "[serve]\nlisten = 'x'",
            "[serve]\nadapter = 'x'",
            "[serve]\nclient_seconds = 86401",
            "[serve]\npicture_seconds = 0",
            "[serve]\npicture_queue = 0",
            "[serve]\nallow_host = ['http://farm']",
            "[serve]\nallow_origin = 'https://farm'",
            "sources = 'tables'",
            "sources = ['ftp://h']",
            "=",
        ] {
            assert!(ConfigFile::parse(text).is_err(), "{text}");
        }
    }

    #[test]
    fn only_a_named_file_must_be_there() {
        let folder = tempfile::tempdir().expect("a folder");
        let missing = folder.path().join("none.toml");
        let refused = ConfigFile::load(Some(&missing)).expect_err("it is missing");
        assert_eq!(refused.exit, super::super::Exit::Usage);
        assert!(refused.message.contains("none.toml"), "{}", refused.message);
    }
}
