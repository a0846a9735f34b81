//! The arguments of `light`.

use std::path::PathBuf;

use clap::Args;

use super::{TableFolder, named};
use ltcforge_light::{AnisotropicRoughness, LightModel, LightShape, NormalsRule, textured::Readings};

/// `light`.
#[derive(Debug, Args)]
#[expect(clippy::struct_excessive_bools, reason = "a flag each")]
pub struct LightArgs {
    /// CSV with `alpha_x,alpha_y,theta,phi` and a light on each line, `-` for stdin: a surface, a view direction, and
    /// the light in the tangent frame around the shaded point.
    ///
    /// A polygon is `sides,x0,y0,z0,x1,...`: 1 or 2 lit sides, and three to eight vertices, clockwise as seen from the
    /// lit side. A disk or an ellipse is `sides,cx,cy,cz,ux,uy,uz,vx,vy,vz`: its centre and two half axes u and v; its
    /// lit side is that of u x v. A sphere is `x,y,z,radius`, a tube with round ends `ax,ay,az,bx,by,bz,radius`, a line
    /// `ax,ay,az,bx,by,bz,width`
    #[arg(value_name = "CSV")]
    pub cases: PathBuf,
    /// One material in place of the columns `alpha_x,alpha_y`, by the parameters of `gltf`, `openpbr`, `materialx`,
    /// `disney` or `hdrp`, such as `openpbr:specular_roughness=0.3,specular_roughness_anisotropy=0.5`; views and lights are
    /// then around the surface's own tangent
    #[arg(long, value_name = "MODEL:NAME=X,...", value_parser = AnisotropicRoughness::parse)]
    pub material: Option<AnisotropicRoughness>,
    /// The shape of the lights
    #[arg(long, default_value = LightShape::ALL[0].name(), value_parser = named(LightShape::ALL, LightShape::name))]
    pub light: LightShape,
    /// The model of light
    #[arg(long, default_value = LightModel::ALL[0].name(), value_parser = named(LightModel::ALL, LightModel::name))]
    pub model: LightModel,
    /// The table of model `ltc`, or of `sg` and `asg` in place of the closed form: a file, or a digest of a table in
    /// the folder of `--tables`
    #[arg(long)]
    pub table: Option<PathBuf>,
    /// The folder of tables
    #[command(flatten)]
    pub folder: TableFolder,
    /// Let light and lobe of model `ltc` end at the surface: nothing shines through from below
    #[arg(long)]
    pub cut: bool,
    /// The rule of model `normals` [default: balanced]
    #[arg(long, value_parser = named(NormalsRule::ALL, NormalsRule::name))]
    pub rule: Option<NormalsRule>,
    /// Print the truth as well, for the table's scattering model or GGX, by adaptive quadrature: milliseconds a line
    #[arg(long)]
    pub truth: bool,
    /// A picture on the lights, rectangles: PNG, `OpenEXR`, Radiance HDR or JPEG. Prints what is reflected of each channel, for a
    /// Fresnel factor of one or, with `--f0`, by Schlick's, by model normals or a table of LTCs. The picture's upper left is at the first vertex, and its rows
    /// run to the second
    #[arg(long, value_name = "IMAGE")]
    pub texture: Option<PathBuf>,
    /// How often the picture of `--texture` is read for a light [default: 4]
    #[arg(long, value_name = "N", value_parser = named(Readings::ALL, Readings::name), requires = "texture")]
    pub readings: Option<Readings>,
    /// Print what a material of this reflectance, seen from above, reflects as well, by Schlick's Fresnel factor: 0 to 1
    #[arg(long, allow_negative_numbers = true)]
    pub f0: Option<f64>,
    /// The part of Schlick's reflectance that a metal has at 82 degrees, with `--f0`: what it reflects by F82, the Fresnel
    /// factor of OpenPBR's metals: 0 to 1. A table needs terms "f82" of its recipe
    #[arg(long, value_name = "TINT", allow_negative_numbers = true, requires = "f0")]
    pub f82: Option<f64>,
    /// The reflectance at grazing incidence, with `--f0`: 0 to 1
    #[arg(long, default_value_t = 1.0, allow_negative_numbers = true, requires = "f0")]
    pub f90: f64,
    /// Find what the material of `--f0` reflects by one integral, of the blend of the two lobes that a table has whose recipe has
    /// `fresnel` `blended_lobes`, for which it is fitted, or `two_lobes`, in place of one integral a lobe
    #[arg(long, requires = "f0", requires = "table")]
    pub blend: bool,
    /// Give back what facets lose that shadow each other, with `--f0`: times `1 + f0 (1 / albedo - 1)`, for metals
    #[arg(long, requires = "f0")]
    pub compensate: bool,
}
