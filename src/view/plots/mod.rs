//! Pictures of a table as such: how wrong it is, and its numbers, so that a bad entry is seen at once; and of materials
//! by a table, a closed form and in truth.
//!
//! Invariant: equal tables and choices give equal bytes, on every machine.

mod chart;
mod error;
mod materials;
mod matrix;
mod parameters;
mod plot;
mod scale;
mod slice;
#[cfg(test)]
mod tests;

pub use error::error_numbers_while;
pub use materials::{MaterialChoices, MaterialError, MaterialSpheres, NamedTable, material_spheres};
pub use parameters::{Azimuth, Ratio};
pub use plot::Plot;
pub use scale::Scale;
pub use slice::ErrorSlice;
