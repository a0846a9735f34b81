//! `preview`, `plot` and `shader`: what a table does on a screen, and the table itself.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::{
    super::preview_names::{AdapterName, LanguageName, LayoutName, LightName, ModeName, SceneName, TexelFormatName},
    TableChoice, Threads,
};
use crate::view::{
    plots::{Azimuth, Ratio},
    preview::{numbers, pixels, samples},
};

/// `preview`. What is not given is the named scene's.
#[derive(Debug, Args)]
pub struct PreviewArgs {
    /// The table
    #[command(flatten)]
    pub table: TableChoice,
    /// The picture
    #[arg(short, long, value_name = "FILE.png")]
    pub out: PathBuf,
    /// Named set-up
    #[arg(long, value_enum, default_value = "sphere")]
    pub scene: SceneName,
    /// What to show of it
    #[arg(long, value_enum, default_value = "ltc")]
    pub mode: ModeName,
    /// Pixels a side of each panel, 64 to 2048 [default: 512]
    #[arg(long, value_name = "N", value_parser = pixels, allow_negative_numbers = true)]
    pub size: Option<u32>,
    /// Samples a pixel of the reference, 1 to 4096 [default: 64]
    #[arg(long, value_name = "N", value_parser = samples, allow_negative_numbers = true)]
    pub spp: Option<u32>,
    /// GGX roughness along the tangent, 0 to 1; one material takes the place of the scene's [default of scene sphere: 0.5]
    #[arg(long, value_name = "X", allow_negative_numbers = true)]
    pub alpha_x: Option<f64>,
    /// GGX roughness across it, 0 to 1; likewise [sphere: 0.1]
    #[arg(long, value_name = "X", allow_negative_numbers = true)]
    pub alpha_y: Option<f64>,
    /// Angle by which tangents are turned, -2 pi to 2 pi [sphere: 0]
    #[arg(long, value_name = "ANGLE", allow_negative_numbers = true)]
    pub rotation: Option<f64>,
    /// Reflectance at normal incidence, linear sRGB, each 0 to 1 [sphere: 0.91,0.92,0.92]
    #[arg(long, value_name = "R,G,B", value_parser = numbers::<3>, allow_hyphen_values = true)]
    pub f0: Option<[f64; 3]>,
    /// Outline of the light [sphere: rectangle]
    #[arg(long, value_enum)]
    pub light: Option<LightName>,
    /// Middle of the light, in radii of the sphere, y upwards, each -100 to 100 [sphere: -1.6,1.8,2.2]
    #[arg(long, value_name = "X,Y,Z", value_parser = numbers::<3>, allow_hyphen_values = true)]
    pub light_centre: Option<[f64; 3]>,
    /// Half its width and height, each 0.001 to 100 [sphere: 1,0.6]
    #[arg(long, value_name = "X,Y", value_parser = numbers::<2>, allow_hyphen_values = true)]
    pub light_half_size: Option<[f64; 2]>,
    /// Yaw, pitch and roll from facing the sphere, each -2 pi to 2 pi [sphere: 0,0,0]
    #[arg(long, value_name = "YAW,PITCH,ROLL", value_parser = numbers::<3>, allow_hyphen_values = true)]
    pub light_rotation: Option<[f64; 3]>,
    /// Its radiance, 0 to 10000 [sphere: 3]
    #[arg(long, value_name = "X", allow_negative_numbers = true)]
    pub light_intensity: Option<f64>,
    /// Whether its back emits too [sphere: false]
    #[arg(long, value_name = "BOOL")]
    pub light_two_sided: Option<bool>,
    /// Distance of the camera from what it looks at, 1.5 to 100 [sphere: 4.5]
    #[arg(long, value_name = "X", allow_negative_numbers = true)]
    pub camera_distance: Option<f64>,
    /// Its angle about the vertical, -2 pi to 2 pi [sphere: 0]
    #[arg(long, value_name = "ANGLE", allow_negative_numbers = true)]
    pub camera_azimuth: Option<f64>,
    /// Its angle above the horizontal, -pi/2 to pi/2; a floor is seen from above alone [sphere: 0.2]
    #[arg(long, value_name = "ANGLE", allow_negative_numbers = true)]
    pub camera_elevation: Option<f64>,
    /// What it looks at, at most 0.45 from the origin [sphere: 0,0,0]
    #[arg(long, value_name = "X,Y,Z", value_parser = numbers::<3>, allow_hyphen_values = true)]
    pub camera_target: Option<[f64; 3]>,
    /// Its whole angle of view, 0.01 to 2.5 [sphere: 0.5]
    #[arg(long, value_name = "ANGLE", allow_negative_numbers = true)]
    pub field_of_view: Option<f64>,
    /// Polar angle of the view of mode `lobe`, 0 to pi/2 [default: 1]
    #[arg(long, value_name = "ANGLE", allow_negative_numbers = true)]
    pub theta: Option<f64>,
    /// Its azimuth, -2 pi to 2 pi [default: 0.6]
    #[arg(long, value_name = "ANGLE", allow_negative_numbers = true)]
    pub phi: Option<f64>,
    /// Factor on radiance before it is displayed, 0.0001 to 10000 [default: 1]
    #[arg(long, value_name = "X", allow_negative_numbers = true)]
    pub exposure: Option<f64>,
    /// Difference in radiance at the end of the colour bar, 0.000001 to 10000 [sphere: 0.2]
    #[arg(long, value_name = "X", allow_negative_numbers = true)]
    pub difference_scale: Option<f64>,
    /// Bits of the table's numbers
    #[arg(long, value_enum, default_value = "f32")]
    pub precision: TexelFormatName,
    /// Take amplitude and Fresnel term of GGX itself at the table's nodes, in place of the table's if it has any; one
    /// without them reflects all light
    #[arg(long)]
    pub ggx_terms: bool,
    /// What renders
    #[arg(long, value_enum, default_value = "any", env = "LTCFORGE_ADAPTER")]
    pub adapter: AdapterName,
}

/// `plot`.
#[derive(Debug, Args)]
pub struct PlotArgs {
    /// Which table
    #[command(flatten)]
    pub table: TableChoice,
    /// What to draw
    #[arg(value_enum)]
    pub name: PlotName,
    /// The picture
    #[arg(short, long, value_name = "FILE.png")]
    pub out: PathBuf,
    /// Smaller over larger roughness of the errors, moved into the table's range [default: 0.25]
    #[arg(long, value_name = "X")]
    pub ratio: Option<Ratio>,
    /// Azimuth of their view direction, radians, likewise [default: 0.7]
    #[arg(long, value_name = "ANGLE", allow_negative_numbers = true)]
    pub phi: Option<Azimuth>,
    /// How many threads measure
    #[command(flatten)]
    pub threads: Threads,
}

/// The pictures of a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum PlotName {
    /// Errors over theta and alpha at one ratio and phi
    Error,
    /// Every number of every entry
    Matrix,
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
