//! Linearly Transformed Cosines: the distribution, and its integral over polygons.

mod align;
mod distribution;
mod model;
mod polygon;

pub(crate) use align::{align, align_to};
pub use distribution::Ltc;
pub(super) use model::Rules;
#[cfg(test)]
pub(crate) use polygon::quadrature;
pub use polygon::{Clip, MAX_VERTICES, Sides};
