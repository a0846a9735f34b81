//! The light that a surface reflects or transmits. The models are a table of LTCs, an LTC
//! by a formula, the closed form in the space of normals, and one Gaussian. Quadratures compute the reference.
//!
//! Invariant: `light` fits nothing and reads no file.

pub mod albedo;
pub mod gaussians;
pub mod ltc;
pub mod normals;
pub mod transmission;

#[cfg(any(test, feature = "testing"))]
pub mod cases;
pub mod engines;
mod error;
pub mod layers;
mod lit;
pub mod materials;
mod measure;
mod model;
mod placed;
mod polygon;
mod refracted;
mod rules;
pub mod sample;
pub mod shadow;
mod shaped;
mod shapes;
#[cfg(test)]
mod tests;
pub mod textured;
mod truth;

pub use error::LightError;
pub use gaussians::{Gaussian, by_gaussian};
pub use lit::{LitSurface, LitSurfaces};
pub use ltc::{AboveSurface, CosineSpace, TableUse, by_blend, by_table, by_table_as, edge_by_table};
pub use materials::{AnisotropicRoughness, MaterialFaults, MaterialModel};
pub use measure::{EVERYWHERE, RandomLights, light_error, light_error_by, material_error, material_error_by};
pub use model::{ClosedForm, LightModel, Lighting};
pub use normals::{NormalsRule, by_normals};
pub use placed::PlacedLight;
pub use polygon::PolygonLight;
pub use refracted::by_refraction;
pub use rules::{LitPoint, ReflectedLight};
pub use shaped::{AnyLight, AreaLight, LightShape, ShapeParameter, ShapedLight};
pub use shapes::{ELLIPSE_VERTICES, TubeEnds, disk, ellipse, line, rectangle, tube};
pub use truth::{TRUTH_TOLERANCE, edge_truth_of, truth, truth_of, truth_within};
