//! Linearly Transformed Cosines: the distribution, its integral over polygons, and caps for any light.

mod align;
mod cone;
mod distribution;
mod model;
mod polygon;
mod shapes;
mod sphere;

pub(crate) use align::align_to;
pub use align::{align, turned};
pub use cone::Cone;
pub use distribution::Ltc;
pub(super) use model::Rules;
#[cfg(any(test, feature = "testing"))]
pub use polygon::quadrature;
pub use polygon::{Clip, MAX_VERTICES, Sides};
pub use shapes::CosineSpace;
pub use sphere::{cheap_form_factor, clipped_form_factor};
