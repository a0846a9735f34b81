//! Plots of a table's errors and numbers. A bad entry is visible at a glance.
//!
//! Invariant: equal tables and choices give equal bytes, on every machine.

mod chart;
mod error;
mod lut;
mod matrix;
mod parameters;
mod plot;
mod scale;
mod slice;
#[cfg(test)]
mod tests;

pub use error::error_numbers_while;
pub use lut::draw_lut;
pub use parameters::{Azimuth, Ratio};
pub use plot::Plot;
pub use scale::Scale;
pub use slice::ErrorSlice;
