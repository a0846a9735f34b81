//! The commands of the service, which runs on Unix alone.

mod args;
mod backup;
mod cluster;
mod descriptors;
mod doors;
mod fsck;
mod place;
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
    /// Check a whole store and change nothing: the data folder of a service that is not running, or what processes share while they run
    Fsck(FsckArgs),
    /// Copy the data folder of a service, which may be running
    #[command(mut_arg("database", hidden), mut_arg("blobs", hidden))]
    Backup(BackupArgs),
    /// Make a data folder of a copy by `backup`
    #[command(mut_arg("database", hidden), mut_arg("blobs", hidden))]
    Restore(RestoreArgs),
}

/// An option of [`place::Place`] whose store a command refuses.
fn hidden(option: clap::Arg) -> clap::Arg {
    option.hide(true)
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
        ServiceCommand::Fsck(args) => fsck::run(args, &file, json, context),
        ServiceCommand::Backup(args) => backup::back_up_to(args, file, json, context),
        ServiceCommand::Restore(args) => backup::restore_from(args, file, json, context),
    }
}
