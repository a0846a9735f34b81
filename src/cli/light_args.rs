//! The arguments of `light`.

use std::path::PathBuf;

use clap::Args;

use super::{TableFolder, named};
use ltcforge_light::{AnisotropicRoughness, LightModel, LightShape, NormalsRule, textured::Readings};

/// `light`.
#[derive(Debug, Args)]
#[expect(clippy::struct_excessive_bools, reason = "a flag each")]
pub struct LightArgs {
    /// CSV of `alpha_x,alpha_y,theta,phi` and a light; `-` for stdin
    ///
    /// Lights are in the tangent frame around the shaded point.
    /// polygon: sides,x0,y0,z0,x1,... with 1 or 2 lit sides and 3 to 8 vertices, clockwise seen from the lit side.
    /// disk or ellipse: sides,cx,cy,cz,ux,uy,uz,vx,vy,vz with half axes u and v; u x v points to the lit side.
    /// sphere: x,y,z,radius. tube: ax,ay,az,bx,by,bz,radius. line: ax,ay,az,bx,by,bz,width
    #[arg(value_name = "CSV")]
    pub cases: PathBuf,
    /// One material for all lines, e.g. `openpbr:specular_roughness=0.3`
    #[arg(long, value_name = "MODEL:NAME=X,...", value_parser = AnisotropicRoughness::parse)]
    pub material: Option<AnisotropicRoughness>,
    /// Shape of the lights
    #[arg(long, default_value = LightShape::ALL[0].name(), value_parser = named(LightShape::ALL, LightShape::name))]
    pub light: LightShape,
    /// Model of light
    #[arg(long, default_value = LightModel::ALL[0].name(), value_parser = named(LightModel::ALL, LightModel::name))]
    pub model: LightModel,
    /// Table of the model: a file, or the first digits of a digest
    #[arg(long)]
    pub table: Option<PathBuf>,
    /// The folder of tables
    #[command(flatten)]
    pub folder: TableFolder,
    /// Cut the light and the lobe at the surface (ltc, ltc-formula)
    ///
    /// Without it, an LTC reflects some light from below the surface, like the default shader
    #[arg(long)]
    pub cut: bool,
    /// Rule of model normals [default: balanced]
    #[arg(long, value_parser = named(NormalsRule::ALL, NormalsRule::name))]
    pub rule: Option<NormalsRule>,
    /// Also print true values by quadrature (milliseconds per line)
    #[arg(long)]
    pub truth: bool,
    /// CSV of occluders; also print the true shadowed light
    ///
    /// Lines: sphere,x,y,z,radius or box,x0,y0,z0,x1,y1,z1 or triangle,x0,y0,z0,x1,y1,z1,x2,y2,z2, in the frame of the
    /// lights. Boxes are axis-aligned. Only for polygons, and not with --material, --texture, --f82 or --compensate
    #[arg(long, value_name = "FILE", conflicts_with_all = ["material", "texture", "f82", "compensate"])]
    pub occluders: Option<PathBuf>,
    /// Picture on rectangular lights; prints the reflected channels
    ///
    /// PNG, `OpenEXR`, Radiance HDR or JPEG. The picture's upper left corner is at the first vertex; its rows run toward
    /// the second vertex. The Fresnel factor is 1, or Schlick's with --f0. Models: normals, ltc-formula, or ltc with a table
    #[arg(long, value_name = "IMAGE")]
    pub texture: Option<PathBuf>,
    /// Texture reads per light, with --texture [default: 4]
    #[arg(long, value_name = "N", value_parser = named(Readings::ALL, Readings::name), requires = "texture")]
    pub readings: Option<Readings>,
    /// Also print the light of a material with this F0 (Schlick), 0 to 1
    #[arg(long, allow_negative_numbers = true)]
    pub f0: Option<f64>,
    /// F82 tint of a metal, 0 to 1, with --f0; a table needs terms `f82`
    #[arg(long, value_name = "TINT", allow_negative_numbers = true, requires = "f0")]
    pub f82: Option<f64>,
    /// Reflectance at grazing incidence, with --f0, 0 to 1
    #[arg(long, default_value_t = 1.0, allow_negative_numbers = true, requires = "f0")]
    pub f90: f64,
    /// Blend the two lobes of a table into one before integrating
    #[arg(long, requires = "f0", requires = "table")]
    pub blend: bool,
    /// Compensate energy lost to multiple scattering, with --f0 (metals)
    #[arg(long, requires = "f0")]
    pub compensate: bool,
}
