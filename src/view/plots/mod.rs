//! Pictures of a table as such: how wrong it is, and its numbers, so that a bad entry is seen at once.
//!
//! Invariant: equal tables and choices give equal bytes, on every machine.

mod error;
mod matrix;
mod parameters;
#[cfg(test)]
mod tests;

use serde::Serialize;

use crate::{fit::Table, view::picture::Picture};
pub use parameters::{Azimuth, Ratio};

/// A picture of a table.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Plot {
    /// Errors over theta and alpha at one ratio and phi, between nodes and at them.
    Error(Slice),
    /// Every number of every entry.
    Matrix,
}

/// Where the domain is cut.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Slice {
    /// Smaller over larger roughness.
    pub ratio: f64,
    /// Azimuth of the view direction, radians.
    pub phi: f64,
}

/// A direction in which surfaces differ most from isotropic ones: between their axes.
impl Default for Slice {
    fn default() -> Self {
        Self { ratio: 0.25, phi: 0.7 }
    }
}

impl Plot {
    /// Draws it. Measures on the current rayon pool.
    #[must_use]
    pub fn draw(&self, table: &Table) -> Picture {
        match self {
            Self::Error(slice) => error::draw(table, *slice),
            Self::Matrix => matrix::draw(table),
        }
    }
}
