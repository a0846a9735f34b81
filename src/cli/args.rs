//! The arguments of the command line. A flag goes before its environment variable, that before the configuration
//! file, that before the default.

use std::path::PathBuf;

use clap::{Parser, Subcommand};
use clap_complete::Shell;

#[cfg(unix)]
use super::service::ServiceCommand;
use super::{
    diff::DiffArgs, export::ExportArgs, fit::FitArgs, jobs::JobsArgs, light_args::LightArgs,
    light_texture::LightTextureArgs, lock::LockArgs, lookup::LookupArgs, plan::PlanArgs, plot::PlotArgs,
    preview::PreviewArgs, pull::PullArgs, report::ReportArgs, shader::ShaderArgs, tabulated::TabulateArgs,
    tradeoff::TradeoffArgs, verify::VerifyArgs,
};

/// Fits, stores and serves Linearly Transformed Cosine tables for area lights on GGX materials.
#[derive(Debug, Parser)]
#[command(name = "ltcforge", version, propagate_version = true, after_help = EXIT_CODES)]
pub struct Cli {
    /// Configuration file; `ltcforge.toml` in the working folder if there is one
    #[arg(long, global = true, env = "LTCFORGE_CONFIG", value_name = "FILE")]
    pub config: Option<PathBuf>,
    /// Server of the commands `jobs`, `lock` and `pull` [default: <http://127.0.0.1:8317>]
    #[arg(long, global = true, env = "LTCFORGE_SERVER", value_name = "URL")]
    pub server: Option<String>,
    /// Token for one server, `URL TOKEN`, and of others behind `;`; others see flags of this machine's processes, so put it into
    /// the environment
    #[arg(long, global = true, env = "LTCFORGE_TOKEN", hide_env_values = true, value_name = "URL TOKEN")]
    pub token: Option<String>,
    /// Print JSON, one document a line
    #[arg(long, global = true)]
    pub json: bool,
    /// The command
    #[command(subcommand)]
    pub command: Command,
}

const EXIT_CODES: &str = "Exit codes: 0 ok, 1 failed, 2 usage, 3 verification mismatch, 4 server unavailable, \
                          5 job failed, 130 interrupted.";

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// A command of the service
    #[cfg(unix)]
    #[command(flatten)]
    Service(ServiceCommand),
    /// Fit a table without a server; the last line of stdout is its digest
    Fit(FitArgs),
    /// Print the matrices that a shader would fetch from a table, as CSV
    Lookup(LookupArgs),
    /// Print what surfaces reflect of area lights, as CSV: in closed form, by a table, and the truth
    Light(LightArgs),
    /// Prefilter a picture on a light for a renderer: all its blurred levels, as KTX2 or in other formats
    LightTexture(LightTextureArgs),
    /// Measure how good a table is
    Report(ReportArgs),
    /// Render metal under an area light with a table, or compare it with Monte Carlo integration, as PNG
    Preview(Box<PreviewArgs>),
    /// Draw where a table's errors are, or all its numbers, as PNG
    Plot(PlotArgs),
    /// Fit a family of recipes and show what speed and size cost in accuracy
    Tradeoff(TradeoffArgs),
    /// Find the recipe that a scene needs, within a budget of error, bytes or seconds
    Plan(Box<PlanArgs>),
    /// Write the lookup and the area light as a shader, with how to bind it and values to check it against
    Shader(ShaderArgs),
    /// Write a scattering model as the file of a tabulated one
    Tabulate(TabulateArgs),
    /// Write a table as the textures that an engine loads, and say where they go
    Export(ExportArgs),
    /// Work with the jobs of a server
    Jobs(JobsArgs),
    /// Pin a table, and files that are made of it, in ltcforge.lock: with its recipe, by hash
    Lock(Box<LockArgs>),
    /// Bring in the pinned tables that are missing or have other bytes, and make the files that are pinned with them
    Pull(PullArgs),
    /// Check that files are tables and have the digests in their names
    Verify(VerifyArgs),
    /// Tell how far two tables are apart, and how good each is
    Diff(DiffArgs),
    /// Print a completion script
    Completions {
        /// For this shell
        shell: Shell,
    },
}

/// The effect of an interrupt on a command.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OnInterrupt {
    /// The process ends at once.
    Ends,
    /// The command is notified, and has two seconds to clean up.
    Told,
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
            Self::Fit(_) | Self::Plan(_) | Self::Tradeoff(_) | Self::Lock(_) | Self::Pull(_) => OnInterrupt::Told,
            _ => OnInterrupt::Ends,
        }
    }
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory as _;

    use super::*;
    use ltcforge_files::digest::Digest;

    fn parse(line: &str) -> Result<Cli, clap::Error> {
        Cli::try_parse_from(line.split(' '))
    }

    #[test]
    fn the_command_line_is_consistent() {
        Cli::command().debug_assert();
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
            "ltcforge export table --container compact --precision half -o out",
            "ltcforge export table --for three --container compact -o out",
            "ltcforge export table --for three --precision half -o out",
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
