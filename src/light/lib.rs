//! What a surface reflects or transmits of an area light, by each model: a table of LTCs, the closed form in the space of
//! normals, or one Gaussian; and the truth, by quadrature.
//!
//! Invariant: `light` fits nothing and reads no file.

pub mod gaussians;
pub mod normals;
pub mod transmission;

#[cfg(any(test, feature = "testing"))]
pub mod cases;
mod error;
mod measure;
mod model;
mod polygon;
mod refracted;
mod shaped;
mod shapes;
mod table;
#[cfg(test)]
mod tests;
mod truth;

pub use error::LightError;
pub use gaussians::Gaussian;
pub use measure::{EVERYWHERE, LightMap, Lighting, RandomLights, light_error, light_map};
pub use model::{LightModel, Reflected, by_gaussian, by_normals};
pub use normals::WeightRule;
pub use polygon::PolygonLight;
pub use refracted::by_refraction;
pub use shaped::{AreaLight, LightShape, ShapedLight};
pub use shapes::{ELLIPSE_VERTICES, TubeEnds, disk, ellipse, line, rectangle, tube};
pub use table::by_table;
pub use truth::{TRUTH_TOLERANCE, truth, truth_of, truth_within};
