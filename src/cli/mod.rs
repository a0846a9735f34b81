//! The command line: parse, configure, run, exit code.
//!
//! Invariant: `cli` owns neither signals nor the environment; `main` hands both in. It holds no logic that
//! [`crate::server::service`] could hold.

mod args;
mod config_file;
mod exit;
mod fit;
mod input;
mod interrupt;
mod jobs;
mod lookup;
mod plot;
mod points;
mod preview;
mod preview_names;
mod progress;
mod pull;
mod report;
mod serve;
mod shader;
mod tradeoff;
mod verify;

use std::{io::Write, path::Path};

use clap::CommandFactory as _;
use tokio::runtime::Handle;

pub use args::{Cli, Command, OnInterrupt};
pub use exit::{Exit, Failure};
pub use interrupt::Interrupt;

use crate::client::Client;
use config_file::ConfigFile;

/// Where the client commands look for a service when nothing says otherwise.
const DEFAULT_SERVER: &str = "http://127.0.0.1:8317";

/// What a command is given by `main`.
pub struct Context<'a> {
    /// Standard output.
    pub stdout: &'a mut dyn Write,
    /// Whether that is a terminal: then nothing binary goes there.
    pub stdout_is_terminal: bool,
    /// Whether standard error is a terminal: then progress is drawn there.
    pub draws_progress: bool,
    /// Told when the user wants to stop.
    pub interrupt: Interrupt,
    /// Runs the HTTP server.
    pub runtime: Handle,
}

/// Runs a command.
///
/// # Errors
/// The exit code and the lines for standard error.
pub fn run(cli: Cli, context: &mut Context<'_>) -> Result<Exit, Failure> {
    let file = ConfigFile::load(cli.config.as_deref())?;
    let Cli { command, server, json, .. } = cli;
    let connect = || client(server.as_deref(), &file);
    match command {
        Command::Serve(args) => serve::run(args, file.serve, context),
        Command::Fit(args) => fit::run(&args, json, context),
        Command::Lookup(args) => lookup::run(&args, json, context),
        Command::Report(args) => report::run(&args, json, context),
        Command::Preview(args) => preview::run(&args, json, context),
        Command::Plot(args) => plot::run(&args, json, context),
        Command::Tradeoff(args) => tradeoff::run(&args, json, context),
        Command::Shader(args) => shader::run(&args, json, context),
        Command::Jobs(args) => jobs::run(&args, json, &connect()?, context),
        Command::Pull(args) => {
            let servers = pull::Servers { chosen: server.as_deref(), usual: file.server.as_deref() };
            pull::run(&args, servers, json, context)
        }
        Command::Verify(args) => verify::run(&args, json, context),
        Command::Completions { shell } => {
            let mut script = Vec::new();
            clap_complete::generate(shell, &mut Cli::command(), "ltcforge", &mut script);
            context.stdout.write_all(&script).map_err(|error| Failure::stdout(&error))?;
            Ok(Exit::Ok)
        }
    }
}

fn client(flag: Option<&str>, file: &ConfigFile) -> Result<Client, Failure> {
    Ok(Client::new(flag.or(file.server.as_deref()).unwrap_or(DEFAULT_SERVER))?)
}

/// Prints `value` as one line of JSON, or `text` as it is.
fn print(stdout: &mut dyn Write, json: bool, value: &serde_json::Value, text: &str) -> Result<(), Failure> {
    let written = if json { writeln!(stdout, "{value}") } else { writeln!(stdout, "{text}") };
    written.and_then(|()| stdout.flush()).map_err(|error| Failure::stdout(&error))
}

/// An error about the file at `path`, on one line.
fn file_failure(path: &Path, error: &dyn std::fmt::Display) -> Failure {
    Failure::new(Exit::Failed, format!("{}: {error}", path.display()))
}
