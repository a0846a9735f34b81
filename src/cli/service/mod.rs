//! The commands of the service, which runs on Unix alone.

mod args;
mod backup;
mod cluster;
mod descriptors;
mod doors;
mod fsck;
mod serve;
mod settings;
mod token;

use clap::Subcommand;

use super::{CommandFailure, Context, Exit, print};
use args::{FsckArgs, GcArgs, MigrateArgs, WorkArgs};
use backup::{BackupArgs, RestoreArgs};
use settings::ServeArgs;
pub(super) use settings::ServeSettings;
use token::TokenCommand;

#[derive(Debug, Subcommand)]
pub enum ServiceCommand {
    /// Run the HTTP service
    Serve(ServeArgs),
    /// Fit what the queue of a shared database has
    Work(WorkArgs),
    /// Tell the files of a store that go: beyond its size, used longest ago; of a shared one also what nothing refers to
    Gc(GcArgs),
    /// Take the tables and jobs of a data folder along into a shared database and store
    Migrate(MigrateArgs),
    /// Make a token for a service, which keeps only its hash
    #[command(subcommand)]
    Token(TokenCommand),
    /// Check the data folder of a service that is not running, and tell what its next start would mend
    Fsck(FsckArgs),
    /// Copy the data folder of a service, which may be running
    Backup(BackupArgs),
    /// Make a data folder of a copy by `backup`
    Restore(RestoreArgs),
}

/// Runs a command with the section `[serve]` of the configuration file.
pub(super) fn run(
    command: ServiceCommand,
    file: ServeSettings,
    json: bool,
    context: &mut Context<'_>,
) -> Result<Exit, CommandFailure> {
    match command {
        ServiceCommand::Serve(args) => serve::run(&args.over(file)?, json, context),
        ServiceCommand::Work(args) => cluster::work(args, &file, json, context),
        ServiceCommand::Gc(args) => cluster::gc(args, &file, json, context),
        ServiceCommand::Migrate(args) => cluster::migrate(args, &file, json, context),
        ServiceCommand::Token(command) => token::run(&command, json, context),
        ServiceCommand::Fsck(args) => fsck::run(args, file, json, context),
        ServiceCommand::Backup(args) => backup::back_up_to(args, file, json, context),
        ServiceCommand::Restore(args) => backup::restore_from(args, file, json, context),
    }
}
