//! Pictures of a table as such: how wrong it is, and its numbers, so that a bad entry is seen at once.
//!
//! Invariant: equal tables and choices give equal bytes, on every machine.

mod error;
mod matrix;
mod parameters;
mod plot;
mod slice;
#[cfg(test)]
mod tests;

pub use parameters::{Azimuth, Ratio};
pub use plot::Plot;
pub use slice::ErrorSlice;
