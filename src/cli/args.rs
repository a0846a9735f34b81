//! What the command line can say. A flag goes before its environment variable, that before the configuration file,
//! that before the default.

use std::{
    net::SocketAddr,
    num::{NonZeroU64, NonZeroUsize},
    path::PathBuf,
};

use clap::{Args, Parser, Subcommand};
use clap_complete::Shell;

use super::preview_names::{AdapterName, LanguageName, LayoutName, LightName, ModeName, PrecisionName, SceneName};
use crate::{
    digest::Digest,
    preview::numbers,
    queue::{JobId, StateName},
};

/// Fits, stores and serves Linearly Transformed Cosine tables for area lights on GGX materials.
#[derive(Debug, Parser)]
#[command(version, propagate_version = true, after_help = EXIT_CODES)]
pub struct Cli {
    /// Configuration file; `ltcforge.toml` in the working folder if there is one
    #[arg(long, global = true, env = "LTCFORGE_CONFIG", value_name = "FILE")]
    pub config: Option<PathBuf>,
    /// Server of the commands `jobs` and `pull` [default: <http://127.0.0.1:8317>]
    #[arg(long, global = true, env = "LTCFORGE_SERVER", value_name = "URL")]
    pub server: Option<String>,
    /// Print JSON, one document a line
    #[arg(long, global = true)]
    pub json: bool,
    /// What to do
    #[command(subcommand)]
    pub command: Command,
}

const EXIT_CODES: &str = "Exit codes: 0 ok, 1 failed, 2 usage, 3 verification mismatch, 4 server unavailable, \
                          5 job failed, 130 interrupted.";

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Run the HTTP service
    Serve(ServeArgs),
    /// Fit a table without a server; the last line of stdout is its digest
    Fit(FitArgs),
    /// Print the matrices that a shader would fetch from a table, as CSV
    Lookup(LookupArgs),
    /// Measure how good a table is
    Report(ReportArgs),
    /// Render what a table does: metal under an area light, beside the truth, as PNG
    Preview(Box<PreviewArgs>),
    /// Fit a family of recipes and show what speed and size cost in accuracy
    Tradeoff(TradeoffArgs),
    /// Write the lookup and the area light as a shader, with how to bind it and values to check it against
    Shader(ShaderArgs),
    /// Work with the jobs of a server
    Jobs(JobsArgs),
    /// Download the tables pinned in ltcforge.lock, and leave right ones alone
    Pull(PullArgs),
    /// Check that files are tables and hash to their names
    Verify(VerifyArgs),
    /// Print a completion script
    Completions {
        /// For this shell
        shell: Shell,
    },
}

/// What an interrupt does to a command.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OnInterrupt {
    /// The process ends at once.
    Ends,
    /// The command is told, and has a moment to put things away.
    Told,
    /// The command is told and takes as long as it needs.
    Finishes,
}

impl Command {
    /// What an interrupt does to this command.
    #[must_use]
    pub fn on_interrupt(&self) -> OnInterrupt {
        match self {
            Self::Serve(_) => OnInterrupt::Finishes,
            Self::Fit(_) | Self::Tradeoff(_) | Self::Pull(_) => OnInterrupt::Told,
            Self::Lookup(_)
            | Self::Report(_)
            | Self::Preview(_)
            | Self::Shader(_)
            | Self::Jobs(_)
            | Self::Verify(_)
            | Self::Completions { .. } => OnInterrupt::Ends,
        }
    }
}

/// `serve`.
#[derive(Debug, Args)]
pub struct ServeArgs {
    /// Address to listen on; port 0 takes a free one [default: 127.0.0.1:8317]
    #[arg(long, env = "LTCFORGE_LISTEN", value_name = "ADDRESS")]
    pub listen: Option<SocketAddr>,
    /// Folder of jobs and tables, made when missing [default: ltcforge-data]
    #[arg(long, env = "LTCFORGE_DATA", value_name = "DIR")]
    pub data: Option<PathBuf>,
    /// Shards fitted at the same time [default: one for each core]
    #[arg(long, env = "LTCFORGE_WORKERS", value_name = "N")]
    pub workers: Option<NonZeroUsize>,
    /// Jobs that may wait or run at the same time [default: 64]
    #[arg(long, env = "LTCFORGE_QUEUE_LIMIT", value_name = "N")]
    pub queue_limit: Option<NonZeroUsize>,
    /// Entries a table may have [default: 2000000]
    #[arg(long, env = "LTCFORGE_ENTRY_LIMIT", value_name = "N")]
    pub entry_limit: Option<NonZeroU64>,
    /// What renders previews
    #[arg(long, value_enum, default_value = "any", env = "LTCFORGE_ADAPTER")]
    pub adapter: AdapterName,
}

/// `fit`.
#[derive(Debug, Args)]
pub struct FitArgs {
    /// A recipe's file, `-` for stdin, or the name of a preset
    pub recipe: String,
    /// Folder that the table and its manifest go to
    #[arg(short, long, value_name = "DIR", default_value = ".")]
    pub out: PathBuf,
    /// Threads that fit [default: one for each core]
    #[arg(long, env = "LTCFORGE_THREADS", value_name = "N")]
    pub threads: Option<NonZeroUsize>,
    /// Entries the table may have [default: 2000000]
    #[arg(long, env = "LTCFORGE_ENTRY_LIMIT", value_name = "N")]
    pub entry_limit: Option<NonZeroU64>,
}

/// `lookup`.
#[derive(Debug, Args)]
pub struct LookupArgs {
    /// A table's file, or the digest (its beginning suffices) of one in the folder of `--tables`
    pub table: String,
    /// CSV with `alpha_x,alpha_y,theta,phi` on each line, angles in radians; `-` for stdin
    #[arg(long, value_name = "CSV")]
    pub points: String,
    /// Folder of `<digest>.safetensors` files
    #[arg(long, value_name = "DIR", default_value = ".")]
    pub tables: PathBuf,
}

/// `report`.
#[derive(Debug, Args)]
pub struct ReportArgs {
    /// A table's file, a `.npy` file of shape alpha x ratio x theta x phi x 3 x 3, or the digest (its beginning
    /// suffices) of a table in the folder of `--tables`
    pub table: String,
    /// Folder of `<digest>.safetensors` files
    #[arg(long, value_name = "DIR", default_value = ".")]
    pub tables: PathBuf,
    /// Look at the corners of the domain as well: mirrors, needles, the horizon, every fold
    #[arg(long)]
    pub extremes: bool,
    /// Threads that measure [default: one for each core]
    #[arg(long, env = "LTCFORGE_THREADS", value_name = "N")]
    pub threads: Option<NonZeroUsize>,
}

/// `preview`. What is not given is the named scene's.
#[derive(Debug, Args)]
pub struct PreviewArgs {
    /// A table's file, or the digest (its beginning suffices) of one in the folder of `--tables`
    pub table: String,
    /// The picture
    #[arg(short, long, value_name = "FILE.png")]
    pub out: PathBuf,
    /// Folder of `<digest>.safetensors` files
    #[arg(long, value_name = "DIR", default_value = ".")]
    pub tables: PathBuf,
    /// Named set-up
    #[arg(long, value_enum, default_value = "sphere")]
    pub scene: SceneName,
    /// What to show of it
    #[arg(long, value_enum, default_value = "ltc")]
    pub mode: ModeName,
    /// Pixels a side of each panel, 64 to 2048 [default: 512]
    #[arg(long, value_name = "N")]
    pub size: Option<u32>,
    /// Samples a pixel of the reference, 1 to 4096 [default: 64]
    #[arg(long, value_name = "N")]
    pub spp: Option<u32>,
    /// GGX roughness along the tangent, 0 to 1; one material takes the place of the scene's
    #[arg(long, value_name = "X")]
    pub alpha_x: Option<f64>,
    /// GGX roughness across it, 0 to 1; likewise
    #[arg(long, value_name = "X")]
    pub alpha_y: Option<f64>,
    /// Angle by which tangents are turned, radians
    #[arg(long, value_name = "ANGLE", allow_negative_numbers = true)]
    pub rotation: Option<f64>,
    /// Reflectance at normal incidence, linear sRGB
    #[arg(long, value_name = "R,G,B", value_parser = numbers::<3>)]
    pub f0: Option<[f64; 3]>,
    /// Outline of the light
    #[arg(long, value_enum)]
    pub light: Option<LightName>,
    /// Middle of the light, in radii of the sphere, y upwards
    #[arg(long, value_name = "X,Y,Z", value_parser = numbers::<3>, allow_hyphen_values = true)]
    pub light_centre: Option<[f64; 3]>,
    /// Half its width and height
    #[arg(long, value_name = "X,Y", value_parser = numbers::<2>)]
    pub light_half_size: Option<[f64; 2]>,
    /// Yaw, pitch and roll from facing the sphere, radians
    #[arg(long, value_name = "YAW,PITCH,ROLL", value_parser = numbers::<3>, allow_hyphen_values = true)]
    pub light_rotation: Option<[f64; 3]>,
    /// Its radiance
    #[arg(long, value_name = "X")]
    pub light_intensity: Option<f64>,
    /// Whether its back emits too
    #[arg(long, value_name = "BOOL")]
    pub light_two_sided: Option<bool>,
    /// Distance of the camera
    #[arg(long, value_name = "X")]
    pub camera_distance: Option<f64>,
    /// Its angle about the vertical, radians
    #[arg(long, value_name = "ANGLE", allow_negative_numbers = true)]
    pub camera_azimuth: Option<f64>,
    /// Its angle above the horizontal, radians
    #[arg(long, value_name = "ANGLE", allow_negative_numbers = true)]
    pub camera_elevation: Option<f64>,
    /// Its angle of view, radians
    #[arg(long, value_name = "ANGLE")]
    pub field_of_view: Option<f64>,
    /// Polar angle of the view of mode `lobe`, radians
    #[arg(long, value_name = "ANGLE")]
    pub theta: Option<f64>,
    /// Its azimuth
    #[arg(long, value_name = "ANGLE", allow_negative_numbers = true)]
    pub phi: Option<f64>,
    /// Factor on radiance before it is displayed
    #[arg(long, value_name = "X")]
    pub exposure: Option<f64>,
    /// Difference in radiance at the end of the colour bar
    #[arg(long, value_name = "X")]
    pub difference_scale: Option<f64>,
    /// Bits of the table's numbers
    #[arg(long, value_enum, default_value = "f32")]
    pub precision: PrecisionName,
    /// What renders
    #[arg(long, value_enum, default_value = "any", env = "LTCFORGE_ADAPTER")]
    pub adapter: AdapterName,
}

/// `tradeoff`.
#[derive(Debug, Args)]
pub struct TradeoffArgs {
    /// A recipe's file, `-` for stdin, or the name of a preset: the family keeps its ranges, terms, seed and solver,
    /// and is laid around its layout, resolution and precision [default: paper]
    #[arg(long, value_name = "RECIPE")]
    pub recipe: Option<String>,
    /// A small family: the presets and a few recipes around them
    #[arg(long)]
    pub quick: bool,
    /// Folder that `tradeoff.csv`, `tradeoff.json` and `tradeoff.svg` go to
    #[arg(short, long, value_name = "DIR", default_value = ".")]
    pub out: PathBuf,
    /// Threads that fit [default: one for each core]
    #[arg(long, env = "LTCFORGE_THREADS", value_name = "N")]
    pub threads: Option<NonZeroUsize>,
}

/// `shader`.
#[derive(Debug, Args)]
pub struct ShaderArgs {
    /// Language to write
    #[arg(long, value_enum)]
    pub language: LanguageName,
    /// Layout of the tables that it is to read; a table's recipe names it
    #[arg(long, value_enum)]
    pub layout: LayoutName,
    /// The file [default: standard output]
    #[arg(short, long, value_name = "FILE")]
    pub out: Option<PathBuf>,
}

/// `jobs`.
#[derive(Debug, Args)]
pub struct JobsArgs {
    /// What to do with them
    #[command(subcommand)]
    pub action: JobsAction,
}

/// The commands on jobs.
#[derive(Debug, Subcommand)]
pub enum JobsAction {
    /// Submit a recipe
    Submit {
        /// A recipe's file, `-` for stdin, or the name of a preset
        recipe: String,
        /// Follow the job to its end; the last line of stdout is the table's digest
        #[arg(long)]
        watch: bool,
    },
    /// List jobs, newest first
    List {
        /// Only jobs in this state
        #[arg(long, value_parser = parse_state, value_name = "STATE")]
        state: Option<StateName>,
        /// Most jobs to list
        #[arg(long, default_value_t = 50, value_name = "N")]
        limit: usize,
    },
    /// Show a job
    Show {
        /// The job
        id: JobId,
    },
    /// Follow a job to its end; the last line of stdout is the table's digest
    Watch {
        /// The job
        id: JobId,
    },
    /// Cancel a job
    Cancel {
        /// The job
        id: JobId,
    },
}

/// `pull`.
#[derive(Debug, Args)]
pub struct PullArgs {
    /// The lock file; its folder is what paths are relative to
    #[arg(long, value_name = "FILE", default_value = "ltcforge.lock")]
    pub lock: PathBuf,
    /// Download nothing; fail with exit code 3 when a file is missing or has other bytes
    #[arg(long, conflicts_with = "add")]
    pub locked: bool,
    /// Pin a table under a name first; a pin of that name is replaced
    #[arg(long, num_args = 2, value_names = ["NAME", "DIGEST"])]
    pub add: Vec<String>,
    /// Where the added table goes [default: NAME.safetensors]
    #[arg(long, requires = "add", value_name = "PATH")]
    pub to: Option<PathBuf>,
}

/// `verify`.
#[derive(Debug, Args)]
pub struct VerifyArgs {
    /// Tables; a file named after a digest must hash to it
    #[arg(required = true)]
    pub files: Vec<PathBuf>,
    /// The digest that the file must hash to, whatever its name
    #[arg(long)]
    pub digest: Option<Digest>,
}

fn parse_state(text: &str) -> Result<StateName, String> {
    serde_json::from_value(text.into())
        .map_err(|_| "a state is one of queued, running, done, failed, cancelled".to_owned())
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory as _;

    use super::*;

    fn parse(line: &str) -> Result<Cli, clap::Error> {
        Cli::try_parse_from(line.split(' '))
    }

    #[test]
    fn the_command_line_is_consistent() {
        Cli::command().debug_assert();
    }

    #[test]
    fn a_pin_is_added_with_two_values() {
        let line = format!("ltcforge pull --add metal {} --to a/b", Digest::of(b""));
        let Command::Pull(args) = parse(&line).expect("a good line").command else { panic!("not pull: {line}") };
        assert_eq!(args.add, ["metal".to_owned(), Digest::of(b"").to_string()]);
        assert_eq!(args.to, Some("a/b".into()));
    }

    #[test]
    fn wrong_lines_are_usage_errors() {
        let lines = [
            "ltcforge",
            "ltcforge fit",
            "ltcforge pull --locked --add a b",
            "ltcforge pull --add a",
            "ltcforge pull --to a",
            "ltcforge jobs show xyz",
            "ltcforge jobs list --state finished",
            "ltcforge serve --workers 0",
            "ltcforge verify",
            "ltcforge tradeoff paper",
            "ltcforge tradeoff --threads 0",
            "ltcforge verify --digest 12 file",
        ];
        for line in lines {
            assert_eq!(parse(line).expect_err(line).exit_code(), 2, "{line}");
        }
    }
}
