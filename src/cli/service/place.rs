//! Where `fsck`, `backup` and `restore` work.

use std::path::PathBuf;

use clap::{ArgMatches, Args, Command, FromArgMatches, error::ErrorKind, parser::ValueSource};

use ltcforge_server::service::DatabaseUrl;

/// A whole store: the data folder that `--data` names on the command line; else the database and the store of tables that flags or the
/// environment name; else the data folder of the environment, of the configuration file, or the usual one. So the variables of a
/// process in a cluster, with that of its cache, name what it works on.
#[derive(Debug)]
pub enum Place {
    /// The database and store that processes share; one of the two may be missing.
    Shared {
        /// The database.
        database: Option<DatabaseUrl>,
        /// The URL of the store of tables.
        blobs: Option<String>,
    },
    /// A data folder; `None` for that of the configuration file.
    Folder(Option<PathBuf>),
}

#[derive(Debug, Args)]
struct PlaceArgs {
    /// PostgreSQL database of the queue and the catalogue; without it, the store is that of the data folder
    #[arg(long, env = "LTCFORGE_DATABASE", hide_env_values = true, value_name = "URL")]
    database: Option<DatabaseUrl>,
    /// Store of the tables: `s3://BUCKET/PREFIX`, `gs://`, `az://` or `file:///FOLDER`
    #[arg(long, env = "LTCFORGE_BLOBS", value_name = "URL")]
    blobs: Option<String>,
    /// Folder of jobs and tables, whatever database the environment names [default: ltcforge-data]
    #[arg(long, env = "LTCFORGE_DATA", value_name = "DIR")]
    data: Option<PathBuf>,
}

impl FromArgMatches for Place {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let PlaceArgs { database, blobs, data } = PlaceArgs::from_arg_matches(matches)?;
        let is_named = |flag| matches.value_source(flag) == Some(ValueSource::CommandLine);
        match (is_named("data"), is_named("database") || is_named("blobs")) {
            (true, true) => {
                let both = "--data is a store of its own, and --database with --blobs another: name one of them\n";
                Err(clap::Error::raw(ErrorKind::ArgumentConflict, both))
            }
            (false, _) if database.is_some() || blobs.is_some() => Ok(Self::Shared { database, blobs }),
            _ => Ok(Self::Folder(data)),
        }
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

impl Args for Place {
    fn augment_args(command: Command) -> Command {
        PlaceArgs::augment_args(command)
    }

    fn augment_args_for_update(command: Command) -> Command {
        PlaceArgs::augment_args_for_update(command)
    }
}
