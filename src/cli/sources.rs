//! Where `lock` and `pull` look for tables, and in which order.

use std::path::Path;

use super::{CommandFailure, Interrupt, args::SourceArgs, config_file::ConfigFile, config_file::DEFAULT_SERVER};
use ltcforge_client::{Access, Limits, Source};

/// The places that a table may come from, besides those that the lock file names.
#[derive(Debug)]
pub(super) struct Sources {
    /// Named on the command line or in the environment: these alone are asked.
    chosen: Vec<Source>,
    /// Named in the configuration file: asked after those of the lock file.
    usual: Vec<Source>,
    limits: Limits,
    offline: bool,
}

impl Sources {
    /// What the command line and the configuration say.
    ///
    /// # Errors
    /// When a server's URL is none, whether it will be asked or not.
    pub(super) fn new(args: &SourceArgs, server: Option<&str>, file: &ConfigFile) -> Result<Self, CommandFailure> {
        let server = server.map(Source::server).transpose()?;
        let usual_server = file.server.as_deref().map(Source::server).transpose()?;
        let chosen = if args.from.is_empty() { server.into_iter().collect() } else { args.from.clone() };
        let usual = file.sources.iter().cloned().chain(usual_server).collect();
        let limits = Limits { table_bytes: args.limit.table_limit, ..Limits::USUAL };
        Ok(Self { chosen, usual, limits, offline: args.offline })
    }

    /// The sources of a pin, in their order: `own` are its own and then the lock file's, whose folder is `folder`.
    pub(super) fn of<'a>(&self, own: impl IntoIterator<Item = &'a Source>, folder: &Path) -> Vec<Source> {
        if !self.chosen.is_empty() {
            return self.chosen.clone();
        }
        let mut all: Vec<Source> = own.into_iter().map(|source| source.below(folder)).collect();
        all.extend(self.usual.iter().cloned());
        if all.is_empty() { vec![Source::Server(DEFAULT_SERVER.to_owned())] } else { all }
    }

    /// What the user named for this run: pinned with a table that came from there.
    pub(super) fn chosen(&self) -> &[Source] {
        &self.chosen
    }

    /// Calls `work` with how sources are asked.
    pub(super) fn with_access<T>(&self, interrupt: &Interrupt, work: impl FnOnce(&Access<'_>) -> T) -> T {
        let Self { limits, offline, .. } = *self;
        work(&Access { limits, offline, should_stop: &|| interrupt.is_set() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn source(text: &str) -> Source {
        text.parse().expect("a source")
    }

    #[test]
    fn the_command_line_goes_before_the_pin_before_the_configuration() {
        let usual = vec![source("cache"), source("http://usual")];
        let mut sources = Sources { chosen: vec![], usual, limits: Limits::USUAL, offline: false };
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
