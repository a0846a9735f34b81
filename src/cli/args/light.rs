//! `light`: what surfaces reflect of polygon lights.

use std::path::PathBuf;

use clap::Args;

use super::{
    models::{models, weights},
    tables::TableFolder,
};
use crate::light::{LightModel, WeightRule};

/// `light`.
#[derive(Debug, Args)]
pub struct LightArgs {
    /// CSV with `alpha_x,alpha_y,theta,phi,sides,x0,y0,z0,x1,...` on each line: a surface, a view direction, 1 or 2 lit sides,
    /// and three to eight vertices in the tangent frame around the shaded point, clockwise as seen from the lit side; `-`
    /// for stdin
    #[arg(value_name = "CSV")]
    pub cases: PathBuf,
    /// How the light is found
    #[arg(long, default_value = LightModel::ALL[0].name(), value_parser = models())]
    pub model: LightModel,
    /// The table of model `ltc`, or of `sg` and `asg` in place of the closed form: a file, or a digest of a table in the folder of `--tables`
    #[arg(long)]
    pub table: Option<PathBuf>,
    /// Where digests are looked for
    #[command(flatten)]
    pub folder: TableFolder,
    /// How model `normals` averages shadowing over a light [default: fan]
    #[arg(long, value_parser = weights())]
    pub weight: Option<WeightRule>,
    /// Print the truth beside it, by adaptive quadrature: milliseconds a line
    #[arg(long)]
    pub truth: bool,
}
