//! `plan`.

use std::path::PathBuf;

use clap::{ArgGroup, Args};

use super::{TableFolder, Threads, named};
use ltcforge_textures::Engine;

/// `plan`.
#[derive(Debug, Args)]
#[command(group(ArgGroup::new("budget").args(["error", "bytes", "seconds"])))]
#[expect(clippy::struct_excessive_bools, reason = "a flag each")]
pub struct PlanArgs {
    /// A scene, `.glb` or `.gltf` with its files beside it, or a list of materials, `.json`
    pub scene: PathBuf,
    /// With `--check`, the table: its file, or its digest or the beginning of that
    #[arg(requires = "check")]
    pub table: Option<PathBuf>,
    /// Find the smallest table whose mean error on the scene is at most this, as a part of the lobe's width
    #[arg(long, value_name = "E", value_parser = positive)]
    pub error: Option<f64>,
    /// Find the best table of at most as many bytes, of matrices and terms
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    pub bytes: Option<u64>,
    /// Find the best table that one core fits in this time
    #[arg(long, value_name = "S", value_parser = positive)]
    pub seconds: Option<f64>,
    /// Plan tables of this engine's layout, and with `--fit` write its files
    #[arg(long = "for", value_name = "ENGINE", value_parser = named(Engine::ALL, Engine::name))]
    pub engine: Option<Engine>,
    /// Let nodes stand on the scene's own roughnesses or be placed by its weights: a shader for them is `shader --nodes TABLE`
    #[arg(long, conflicts_with = "engine")]
    pub any_nodes: bool,
    /// Plan tables without terms, for a renderer that knows from elsewhere how much light a lobe holds
    #[arg(long, conflicts_with = "engine")]
    pub no_terms: bool,
    /// Ship the table in its compact form: `--bytes` are those of that, without its decoder, and with `--fit` it is written
    #[arg(long, conflicts_with_all = ["engine", "any_nodes"])]
    pub ship: bool,
    /// Take only tables whose shader has at most as many vector registers, and name the rule of model `normals` that does
    #[arg(long, value_name = "R", value_parser = clap::value_parser!(u32).range(1..))]
    pub registers: Option<u32>,
    /// The same for instructions
    #[arg(long, value_name = "I", value_parser = clap::value_parser!(u32).range(1..))]
    pub instructions: Option<u32>,
    /// Folder that the recipe, `plan.json` and `plan.svg` go to
    #[arg(short, long, value_name = "DIR", default_value = ".")]
    pub out: PathBuf,
    /// Fit the table, measure it on the scene, and correct the plan once if the prediction was off by more than a fifth
    #[arg(long)]
    pub fit: bool,
    /// Write nothing; exit with 3 and name the materials if some lie outside of the table
    #[arg(long, requires = "table", conflicts_with_all = ["budget", "engine", "fit", "ship"])]
    pub check: bool,
    /// The folder that is searched for a digest
    #[command(flatten)]
    pub folder: TableFolder,
    /// Number of threads
    #[command(flatten)]
    pub threads: Threads,
}

/// A number above zero.
fn positive(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|number: &f64| number.is_finite() && *number > 0.0);
    number.ok_or_else(|| "it is a number above 0".to_owned())
}
