//! Linearly Transformed Cosines: the distribution, its integral over polygons, and the form factor of spherical caps.

mod align;
mod distribution;
mod model;
mod polygon;
mod sphere;

pub(crate) use align::align_to;
pub use align::{align, turned};
pub use distribution::Ltc;
pub(super) use model::LtcLobeModel;
#[cfg(any(test, feature = "testing"))]
pub use polygon::cases;
pub use polygon::{Clip, MAX_VERTICES, Sides};
pub use sphere::{cheap_form_factor, clipped_form_factor};
