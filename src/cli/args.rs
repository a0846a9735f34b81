//! The command-line arguments. A flag overrides its environment variable, a variable overrides the configuration file,
//! and the file overrides the default.

use std::{error, ffi::OsString, path::PathBuf};

use clap::{
    CommandFactory as _, FromArgMatches as _, Parser, Subcommand,
    error::{ContextKind, ErrorKind},
};
use clap_complete::Shell;

#[cfg(unix)]
use super::service::ServiceCommand;
use super::{
    diff::DiffArgs, export::ExportArgs, fit::FitArgs, jobs::JobsArgs, light_args::LightArgs,
    light_texture::LightTextureArgs, lock::LockArgs, lookup::LookupArgs, plan::PlanArgs, plot::PlotArgs,
    preview::PreviewArgs, pull::PullArgs, report::ReportArgs, sample::SampleArgs, shader::ShaderArgs,
    tabulated::TabulateArgs, tradeoff::TradeoffArgs, verify::VerifyArgs,
};

/// Lookup tables (LTC) and closed forms for area lights on GGX materials.
#[derive(Debug, Parser)]
#[command(name = "ltcforge", version, propagate_version = true, after_help = EXIT_CODES)]
pub struct Cli {
    /// Configuration file [default: `ltcforge.toml`, if it exists]
    #[arg(long, global = true, env = "LTCFORGE_CONFIG", value_name = "FILE")]
    pub config: Option<PathBuf>,
    /// Print JSON, one document per line
    #[arg(long, global = true)]
    pub json: bool,
    /// The command
    #[command(subcommand)]
    pub command: Command,
}

const EXIT_CODES: &str = "Exit codes: 0 ok, 1 failed, 2 usage, 3 verification mismatch, 4 server unavailable, \
                          5 job failed, 130 interrupted.";

/// The commands by subject, as the help lists them.
const GROUPS: [(&str, &[&str]); 6] = [
    ("Tables", &["fit", "report", "diff", "tradeoff", "lookup", "export", "tabulate"]),
    ("Lights and pictures", &["light", "sample", "shader", "light-texture", "preview", "plot"]),
    ("Scenes", &["plan"]),
    ("Service", &["serve", "work", "jobs", "token"]),
    ("CI", &["lock", "pull", "verify"]),
    ("Other", &["completions", "help"]),
];

impl Cli {
    /// Parses the arguments of the process. The first argument is the program's name.
    ///
    /// # Errors
    /// When the arguments are invalid, or request the help or the version.
    pub fn from_args(arguments: impl Iterator<Item = OsString>) -> Result<Self, clap::Error> {
        Self::from_arg_matches(&grouped().try_get_matches_from(arguments).map_err(explained)?)
    }
}

/// Replaces messages of the standard library by messages with an example, such as for `--bytes 20kB`.
fn explained(error: clap::Error) -> clap::Error {
    let context = |kind| error.get(kind).map(ToString::to_string).unwrap_or_default();
    let (argument, value) = (context(ContextKind::InvalidArg), context(ContextKind::InvalidValue));
    let source = error::Error::source(&error).map(ToString::to_string).unwrap_or_default();
    let advice = match (error.kind(), &*source) {
        (ErrorKind::UnknownArgument, _) if argument == "--preset" => "name the preset alone: ltcforge fit paper",
        (_, "invalid digit found in string" | "cannot parse integer from empty string") => {
            "use a whole number without a unit, such as 20000"
        }
        (_, "number too large to fit in target type") => "use a smaller number, such as 20000",
        (_, "invalid float literal" | "cannot parse float from empty string") => "use a number, such as 0.04",
        (_, "invalid socket address syntax") => "use an address and a port, such as 127.0.0.1:8317",
        _ => return error,
    };
    let of = if value.is_empty() { String::new() } else { format!("invalid value '{value}' for ") };
    clap::Error::raw(error.kind(), format!("{of}'{argument}': {advice}\n"))
}

/// The commands that use the configuration file.
const CONFIGURED: [&str; 5] = ["serve", "work", "jobs", "lock", "pull"];

/// The command, with `--config` left out of its help.
fn without_config(command: clap::Command) -> clap::Command {
    let hide = |arg: clap::Arg| if arg.get_id() == "config" { arg.hide(true) } else { arg };
    command.mut_args(hide).mut_subcommands(without_config)
}

/// The command-line parser. Its help lists the commands by subject, and `--config` only for commands that use it.
fn grouped() -> clap::Command {
    let mut command = Cli::command();
    command.build();
    let below = |of: clap::Command| if CONFIGURED.contains(&of.get_name()) { of } else { without_config(of) };
    let command = command.mut_subcommands(below);
    let about = |name: &str| command.find_subcommand(name)?.get_about();
    let line = |name: &&str| about(name).map(|about| format!("  {name:15}{about}\n"));
    let group =
        |(title, names): (&str, &[&str])| format!("{title}:\n{}\n", names.iter().filter_map(line).collect::<String>());
    let groups: String = GROUPS.into_iter().map(group).collect();
    command.help_template(format!(
        "{{about}}\n\n{{usage-heading}} {{usage}}\n\n{groups}Options:\n{{options}}{{after-help}}"
    ))
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// A command of the service
    #[cfg(unix)]
    #[command(flatten)]
    Service(ServiceCommand),
    /// Fit a table on this machine; the last output line is its digest
    Fit(FitArgs),
    /// Print the matrices that a shader reads from a table, as CSV
    Lookup(LookupArgs),
    /// Print the light that surfaces reflect from area lights, as CSV
    Light(LightArgs),
    /// Draw directions to area lights where surfaces reflect them, as CSV
    Sample(SampleArgs),
    /// Prefilter a picture for a textured light: a pyramid of blurred levels
    LightTexture(LightTextureArgs),
    /// Measure the error of a table
    Report(ReportArgs),
    /// Render surfaces under an area light as PNG
    Preview(Box<PreviewArgs>),
    /// Draw the errors or the entries of a table as PNG
    Plot(PlotArgs),
    /// Measure accuracy against fitting time and size for many recipes
    Tradeoff(TradeoffArgs),
    /// Find the table that a scene needs, within a budget
    Plan(Box<PlanArgs>),
    /// Write shader code for area lights
    Shader(ShaderArgs),
    /// Sample a scattering model into a BRDF file
    Tabulate(TabulateArgs),
    /// Write a table as the files that an engine loads
    Export(ExportArgs),
    /// Submit, list, follow and cancel the jobs of a service
    Jobs(JobsArgs),
    /// Pin a table and its exported files in ltcforge.lock
    Lock(Box<LockArgs>),
    /// Download or make the pinned files that are missing or changed
    Pull(PullArgs),
    /// Check tables, exports and data folders against their digests
    Verify(VerifyArgs),
    /// Compare two tables
    Diff(DiffArgs),
    /// Print a completion script for a shell
    Completions {
        /// The shell
        shell: Shell,
    },
}

/// The effect of an interrupt on a command.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OnInterrupt {
    /// The process ends at once.
    Ends,
    /// The command is notified, and has two seconds to clean up.
    Notified,
    /// The command is notified, and takes as long as it needs.
    Finishes,
}

impl Command {
    /// Whether this command may open a Vulkan device.
    #[must_use]
    pub fn opens_vulkan(&self) -> bool {
        match self {
            #[cfg(unix)]
            Self::Service(ServiceCommand::Serve(_)) => true,
            _ => matches!(self, Self::Preview(_)),
        }
    }

    /// The default level of the log.
    #[must_use]
    pub fn log_level(&self) -> &'static str {
        match self {
            #[cfg(unix)]
            Self::Service(command) if command.runs_until_stopped() => "info",
            _ => "warn",
        }
    }

    /// The effect of an interrupt on this command.
    #[must_use]
    pub fn on_interrupt(&self) -> OnInterrupt {
        match self {
            #[cfg(unix)]
            Self::Service(command) if command.runs_until_stopped() => OnInterrupt::Finishes,
            Self::Fit(_) | Self::Plan(_) | Self::Tradeoff(_) | Self::Lock(_) | Self::Pull(_) => OnInterrupt::Notified,
            _ => OnInterrupt::Ends,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ltcforge_files::digest::Digest;

    fn parse(line: &str) -> Result<Cli, clap::Error> {
        Cli::try_parse_from(line.split(' '))
    }

    #[test]
    fn the_command_line_is_consistent() {
        Cli::command().debug_assert();
    }

    /// Checks the help of a command and of its subcommands.
    fn check_help(command: &clap::Command, path: &str) {
        let path = format!("{path} {}", command.get_name());
        let check = |of: &str, help: Option<&clap::builder::StyledStr>| {
            let help = help.map(ToString::to_string).unwrap_or_default();
            // `[default: ...]` follows the sentence.
            let line = help.split(" [default").next().unwrap_or_default();
            assert!(!line.is_empty() && line.chars().count() <= 70, "{path} {of}: {} characters: {line}", line.len());
        };
        check("", command.get_about());
        for argument in command.get_arguments() {
            check(argument.get_id().as_str(), argument.get_help());
        }
        for below in command.get_subcommands() {
            check_help(below, &path);
        }
    }

    #[test]
    fn a_line_of_help_has_at_most_70_characters() {
        check_help(&Cli::command(), "");
    }

    #[test]
    fn every_command_has_its_place_in_the_help() {
        let help = grouped().render_help().to_string();
        for command in Cli::command().get_subcommands() {
            let line = help.lines().find(|line| line.starts_with(&format!("  {} ", command.get_name())));
            assert!(line.is_some(), "{}: {help}", command.get_name());
        }
    }

    #[test]
    fn global_options_are_listed_where_they_are_used() {
        for command in grouped().get_subcommands_mut() {
            let help = command.clone().render_help().to_string();
            let has = |name: &str| help.contains(&format!(" --{name} <"));
            let name = command.get_name();
            assert_eq!(has("config"), ["serve", "work", "jobs", "lock", "pull"].contains(&name), "{name}");
            assert_eq!(has("server"), ["jobs", "lock", "pull"].contains(&name), "{name}");
            assert_eq!(has("token"), ["jobs", "lock", "pull", "verify"].contains(&name), "{name}");
        }
    }

    /// Gives `wrong` to every option of a command and of its subcommands, and collects the messages.
    fn messages(command: &clap::Command, path: &str, wrong: &str, found: &mut Vec<(String, String)>) {
        for flag in command.get_arguments().filter(|argument| argument.get_action().takes_values()) {
            let Some(flag) = flag.get_long() else { continue };
            let line = format!("{path} --{flag}={wrong}");
            if let Err(error) = Cli::from_args(line.split(' ').map(OsString::from)) {
                found.push((flag.to_owned(), error.to_string()));
            }
        }
        for below in command.get_subcommands() {
            messages(below, &format!("{path} {}", below.get_name()), wrong, found);
        }
    }

    /// The messages of Rust's parsers, such as "invalid digit found in string", do not help a user.
    #[test]
    fn an_invalid_value_is_reported_with_its_option_and_an_example() {
        let mut found = vec![];
        for wrong in ["20kB", "", "-1", "99999999999999999999999"] {
            messages(&Cli::command(), "ltcforge", wrong, &mut found);
        }
        let of_rust =
            ["invalid digit", "cannot parse integer", "number too", "invalid float", "invalid socket address syntax"];
        for (flag, message) in &found {
            assert!(!of_rust.iter().any(|text| message.contains(text)), "--{flag}: {message}");
            assert!(
                !message.contains("invalid value") || message.contains(&format!("--{flag}")),
                "--{flag}: {message}"
            );
        }
        for (flag, advice) in [("bytes", "such as 20000"), ("listen", "such as 127.0.0.1:8317"), ("f0", "such as 0.04")]
        {
            let said = |(of, message): &(String, String)| of == flag && message.contains(advice);
            assert!(found.iter().any(said), "--{flag}: {advice}");
        }
        for (line, said) in [
            ("ltcforge fit --preset paper", "ltcforge fit paper"),
            // Our own messages stay.
            ("ltcforge jobs show zz", "a job id is 32 hex digits"),
            ("ltcforge verify --digest zz file", "digest"),
        ] {
            let error = Cli::from_args(line.split(' ').map(OsString::from)).expect_err(line).to_string();
            assert!(error.contains(said) && !error.contains("whole number"), "{line}: {error}");
        }
    }

    #[test]
    fn a_pin_has_a_table_and_sources_in_order() {
        let line = format!("ltcforge lock metal {} --to a/b --from http://h --from ../t", Digest::of(b""));
        let Command::Lock(args) = parse(&line).expect("a good line").command else { panic!("not lock: {line}") };
        assert_eq!(args.table, Some(Digest::of(b"").to_string().into()));
        assert_eq!(args.to, Some("a/b".into()));
        assert_eq!(args.sources.from, ["http://h", "../t"]);
    }

    #[test]
    fn wrong_lines_are_usage_errors() {
        let lines = [
            "ltcforge",
            "ltcforge fit",
            "ltcforge pull --locked --fit",
            "ltcforge pull --locked --from a",
            "ltcforge lock --to a",
            "ltcforge lock a b --recipe c",
            "ltcforge lock a b --plan c",
            "ltcforge lock a --plan c --recipe d",
            "ltcforge lock a --for wgpu",
            "ltcforge lock --for wgpu --out b",
            "ltcforge lock a --for wgpu --layout reflected --container ktx2 --out b",
            "ltcforge lock a b --remove",
            "ltcforge lock --remove",
            "ltcforge jobs show xyz",
            "ltcforge jobs list --state finished",
            "ltcforge serve --workers 0",
            "ltcforge verify",
            "ltcforge verify --refit",
            "ltcforge diff a",
            "ltcforge diff a b c",
            "ltcforge diff a b --points 7",
            "ltcforge light",
            "ltcforge tabulate tabulated -o b",
            "ltcforge tabulate ggx -o b --theta 1",
            "ltcforge tabulate ggx -o b --phi-o 5",
            "ltcforge export table -o out",
            "ltcforge export table --for three",
            "ltcforge export table --for unity -o out",
            "ltcforge export table --for three --layout kt2022 --container ktx2 -o out",
            "ltcforge export table --layout kt2022 -o out",
            "ltcforge export table --container compact",
            "ltcforge export table --for three --container compact -o out",
            "ltcforge export table --layout kt2022 --container ktx2 --precision double -o out",
            "ltcforge light - --model sum",
            "ltcforge light - --rule most",
            "ltcforge plan",
            "ltcforge plan scene.glb --bytes 1 --error 0.1",
            "ltcforge plan scene.glb --bytes 0",
            "ltcforge plan scene.glb --error -1",
            "ltcforge plan scene.glb --seconds NaN",
            "ltcforge plan scene.glb table",
            "ltcforge plan scene.glb --check",
            "ltcforge plan scene.glb table --check --fit",
            "ltcforge tradeoff paper",
            "ltcforge plot table colours -o x.png",
            "ltcforge plot table error -o x.png --ratio 1.5",
            "ltcforge plot table error -o x.png --phi NaN",
            "ltcforge tradeoff --threads 0",
            "ltcforge fit draft --threads 513",
            "ltcforge serve --workers 99999",
            "ltcforge verify --digest 12 file",
            "ltcforge serve --allow-host http://farm",
            "ltcforge serve --allow-origin farm",
            "ltcforge serve --requests 0",
            "ltcforge serve --client-seconds 0",
            "ltcforge serve --picture-seconds 0",
            "ltcforge serve --client-seconds 18446744073709551615",
        ];
        for line in lines {
            assert_eq!(parse(line).expect_err(line).exit_code(), 2, "{line}");
        }
    }
}
