//! Pictures of a table as such: how wrong it is, and its numbers, so that a bad entry is seen at once; and of models of
//! light beside each other or the truth.
//!
//! Invariant: equal tables and choices give equal bytes, on every machine.

mod chart;
mod curves;
mod error;
mod gaussians;
mod glass;
mod isotropic;
mod light;
mod materials;
mod matrix;
mod parameters;
mod plot;
mod slice;
#[cfg(test)]
mod tests;

pub use error::error_numbers_while;
pub use gaussians::gaussian_plots;
pub use glass::{FrostedGlass, GlassError, frosted_glass};
pub use isotropic::IsotropicFigure;
pub use light::{NamedTable, light_errors};
pub use materials::{MaterialChoices, MaterialError, MaterialSpheres, material_spheres};
pub use parameters::{Azimuth, Ratio};
pub use plot::Plot;
pub use slice::ErrorSlice;
