//! The commands of the service, which runs only on Unix.

#[cfg(feature = "cluster")]
mod cluster;
mod descriptors;
mod doors;
#[cfg(feature = "cluster")]
mod replica;
mod serve;
mod settings;
mod token;

use clap::Subcommand;

use super::{CommandFailure, Context, Exit, failed, named, usage};
use settings::ServeArgs;
pub(super) use settings::ServeSettings;
use token::TokenCommand;

#[derive(Debug, Subcommand)]
pub enum ServiceCommand {
    /// Run the HTTP service
    Serve(ServeArgs),
    /// Run a worker that fits shards from a shared queue
    #[cfg(feature = "cluster")]
    Work(cluster::WorkArgs),
    /// Make an access token for a service
    #[command(subcommand)]
    Token(TokenCommand),
}

impl ServiceCommand {
    /// Whether the command runs until it is interrupted.
    pub(super) fn runs_until_stopped(&self) -> bool {
        !matches!(self, Self::Token(_))
    }
}

/// Runs a command with the settings in `[serve]` of the configuration file.
pub(super) fn run(
    command: ServiceCommand,
    file: ServeSettings,
    context: &mut Context<'_>,
) -> Result<Exit, CommandFailure> {
    match command {
        ServiceCommand::Serve(args) => serve::run(&args.over(file)?, context),
        #[cfg(feature = "cluster")]
        ServiceCommand::Work(args) => cluster::work(args, &file, context),
        ServiceCommand::Token(command) => token::run(&command, context),
    }
}
