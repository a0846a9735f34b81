//! The sources of tables for `lock` and `pull`, and their order.

use std::{
    ffi::OsString,
    num::NonZeroU64,
    path::{Path, PathBuf},
};

use clap::Args;

use super::{CommandFailure, ConfigFile, DEFAULT_SERVER, Interrupt, TableLimit, Threads, server_args::ServerArgs};
use ltcforge_client::{Access, ServerTokens, Source};

/// The sources of pinned tables.
#[derive(Debug, Args)]
pub struct SourceArgs {
    /// Lock file; paths are relative to its folder
    #[arg(long, value_name = "FILE", default_value = "ltcforge.lock")]
    pub lock: PathBuf,
    /// Service or folder to take tables from; repeatable, in order
    ///
    /// A folder contains `DIGEST.safetensors` files. Without this option, --server or the sources in lock file and
    /// configuration
    #[arg(long, value_name = "URL|DIR")]
    pub from: Vec<OsString>,
    /// The service
    #[command(flatten)]
    pub server: ServerArgs,
    /// Use folders only, no service
    #[arg(long)]
    pub offline: bool,
    /// Maximum size of a table whose size the lock file does not state
    #[command(flatten)]
    pub limit: TableLimit,
    /// Maximum entries of a table to fit [default: 2000000]
    #[arg(long, env = "LTCFORGE_ENTRY_LIMIT", value_name = "N")]
    pub entry_limit: Option<NonZeroU64>,
    /// Number of threads that fit and measure
    #[command(flatten)]
    pub threads: Threads,
}

/// The sources of tables that the lock file does not name.
pub(super) struct Sources {
    /// From the command line or the environment. If there are any, no other sources are used.
    chosen: Vec<Source>,
    /// From the configuration file. They come after the lock file's sources.
    usual: Vec<Source>,
    table_bytes: u64,
    offline: bool,
    tokens: ServerTokens,
}

impl Sources {
    /// The sources of the command line and the configuration.
    ///
    /// # Errors
    /// When a server's URL is invalid, even if the server is not used.
    pub(super) fn new(args: &SourceArgs, file: &ConfigFile) -> Result<Self, CommandFailure> {
        let tokens = args.server.token.tokens()?;
        let server = args.server.server.as_deref().map(Source::server).transpose()?;
        let usual_server = file.server.as_deref().map(Source::server).transpose()?;
        // Clap's error would show an invalid source with its password.
        let from: Vec<Source> = args.from.iter().cloned().map(Source::try_from).collect::<Result<_, _>>()?;
        let chosen = if from.is_empty() { server.into_iter().collect() } else { from };
        let usual = file.sources.iter().cloned().chain(usual_server).collect();
        Ok(Self { chosen, usual, table_bytes: args.limit.table_limit, offline: args.offline, tokens })
    }

    /// The sources of a pin, in order. `own` has the sources of the pin, then those of the lock file in `folder`.
    pub(super) fn of<'a>(&self, own: impl IntoIterator<Item = &'a Source>, folder: &Path) -> Vec<Source> {
        if !self.chosen.is_empty() {
            return self.chosen.clone();
        }
        let mut all: Vec<Source> = own.into_iter().map(|source| source.below(folder)).collect();
        all.extend(self.usual.iter().cloned());
        if all.is_empty() { vec![Source::Server(DEFAULT_SERVER.to_owned())] } else { all }
    }

    /// The sources that the user named for this run. A table from a source is pinned with the services among them.
    pub(super) fn chosen(&self) -> &[Source] {
        &self.chosen
    }

    /// Calls `work` with access to sources.
    pub(super) fn with_access<T>(&self, interrupt: &Interrupt, work: impl FnOnce(&Access<'_>) -> T) -> T {
        let Self { table_bytes, offline, ref tokens, .. } = *self;
        work(&Access { table_bytes, offline, tokens, should_stop: &|| interrupt.is_set() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn source(text: &str) -> Source {
        text.parse().expect("a source")
    }

    #[test]
    fn the_command_line_replaces_all_sources_and_pins_precede_the_configuration() {
        let usual = vec![source("cache"), source("http://usual")];
        let mut sources = Sources { chosen: vec![], usual, table_bytes: 9, offline: false, tokens: ServerTokens::NONE };
        let named = |sources: &Sources, own: &[Source]| {
            sources.of(own, Path::new("project")).iter().map(ToString::to_string).collect::<Vec<_>>()
        };
        let own = [source("http://pin"), source("../tables")];
        assert_eq!(named(&sources, &own), ["http://pin", "project/../tables", "cache", "http://usual"]);
        sources.chosen = vec![source("b"), source("a")];
        assert_eq!(named(&sources, &own), ["b", "a"]);
        (sources.chosen, sources.usual) = (vec![], vec![]);
        assert_eq!(named(&sources, &[]), [DEFAULT_SERVER]);
    }
}
