//! From a parsed command line to the command.

use clap::CommandFactory as _;
use serde_json::json;

use super::{
    Cli, Command, CommandFailure, Context, Exit,
    config_file::{ConfigFile, DEFAULT_SERVER},
    diff, export, fit, jobs, light, light_texture, lock, lookup, plan, plot, preview, print, pull, report, shader,
    sources::Sources,
    tabulated, tradeoff, verify,
};
use ltcforge_client::{Client, ServerTokens, ServerTokensError};

/// Runs a command.
///
/// # Errors
/// The exit code and the lines for standard error.
pub fn run(cli: Cli, context: &mut Context<'_>) -> Result<Exit, CommandFailure> {
    let file = ConfigFile::load(cli.config.as_deref())?;
    let Cli { command, server, token, json, .. } = cli;
    let tokens = || match &token {
        Some(text) => {
            text.parse().map_err(|error: ServerTokensError| CommandFailure::new(Exit::Usage, error.to_string()))
        }
        None => Ok(ServerTokens::NONE),
    };
    let connect = || Ok::<_, CommandFailure>(client(server.as_deref(), &file)?.with_tokens(&tokens()?));
    let sources = |args| Sources::new(args, server.as_deref(), &file, tokens()?);
    match command {
        #[cfg(unix)]
        Command::Service(command) => super::service::run(command, file.serve, json, context),
        Command::Fit(args) => fit::run(&args, json, context),
        Command::Lookup(args) => lookup::run(&args, json, context),
        Command::Light(args) => light::run(&args, json, context),
        Command::LightTexture(args) => light_texture::run(&args, json, context),
        Command::Report(args) => report::run(&args, json, context),
        Command::Preview(args) => preview::run(&args, json, context),
        Command::Plot(args) => plot::run(&args, json, context),
        Command::Tradeoff(args) => tradeoff::run(&args, json, context),
        Command::Plan(args) => plan::run(&args, json, context),
        Command::Shader(args) => shader::run(&args, json, context),
        Command::Tabulate(args) => tabulated::run(&args, json, context),
        Command::Export(args) => export::run(&args, json, context),
        Command::Jobs(args) => jobs::run(&args, json, &connect()?, context),
        Command::Lock(args) => lock::run(&args, &sources(&args.sources)?, json, context),
        Command::Pull(args) => pull::run(&args, &sources(&args.sources)?, json, context),
        Command::Verify(args) => verify::run(&args, &tokens()?, json, context),
        Command::Diff(args) => diff::run(&args, json, context),
        Command::Completions { shell } => {
            let mut script = Vec::new();
            clap_complete::generate(shell, &mut Cli::command(), "ltcforge", &mut script);
            let script = String::from_utf8_lossy(&script);
            let value = json!({ "shell": shell.to_string(), "script": script });
            print(context.stdout, json, &value, script.trim_end())?;
            Ok(Exit::Ok)
        }
    }
}

fn client(flag: Option<&str>, file: &ConfigFile) -> Result<Client, CommandFailure> {
    Ok(Client::new(flag.or(file.server.as_deref()).unwrap_or(DEFAULT_SERVER))?)
}
