//! Runs the command of a parsed command line.

use clap::CommandFactory as _;
use serde_json::json;

use super::{
    Cli, Command, CommandFailure, ConfigFile, Context, DEFAULT_SERVER, Exit, Sources, diff, export, fit, jobs, light,
    light_texture, lock, lookup, plan, plot, preview, pull, report, sample, shader, tabulated, tradeoff, verify,
};
use ltcforge_client::Client;

/// Runs a command.
///
/// # Errors
/// The exit code and the lines for standard error.
pub fn run(cli: Cli, context: &mut Context<'_>) -> Result<Exit, CommandFailure> {
    let file = ConfigFile::load(cli.config.as_deref())?;
    context.json = cli.json;
    match cli.command {
        #[cfg(unix)]
        Command::Service(command) => super::service::run(command, file.serve, context),
        Command::Fit(args) => fit::run(&args, context),
        Command::Lookup(args) => lookup::run(&args, context),
        Command::Light(args) => light::run(&args, context),
        Command::Sample(args) => sample::run(&args, context),
        Command::LightTexture(args) => light_texture::run(&args, context),
        Command::Report(args) => report::run(&args, context),
        Command::Preview(args) => preview::run(&args, context),
        Command::Plot(args) => plot::run(&args, context),
        Command::Tradeoff(args) => tradeoff::run(&args, context),
        Command::Plan(args) => plan::run(&args, context),
        Command::Shader(args) => shader::run(&args, context),
        Command::Tabulate(args) => tabulated::run(&args, context),
        Command::Export(args) => export::run(&args, context),
        Command::Jobs(args) => {
            let server = args.server.server.as_deref().or(file.server.as_deref()).unwrap_or(DEFAULT_SERVER);
            jobs::run(&args.action, &Client::new(server, &args.server.token.tokens()?)?, context)
        }
        Command::Lock(args) => lock::run(&args, &Sources::new(&args.sources, &file)?, context),
        Command::Pull(args) => pull::run(&args, &Sources::new(&args.sources, &file)?, context),
        Command::Verify(args) => verify::run(&args, context),
        Command::Diff(args) => diff::run(&args, context),
        Command::Completions { shell } => {
            let mut script = Vec::new();
            clap_complete::generate(shell, &mut Cli::command(), "ltcforge", &mut script);
            let script = String::from_utf8_lossy(&script);
            context.print(&json!({ "shell": shell.to_string(), "script": script }), script.trim_end())
        }
    }
}
