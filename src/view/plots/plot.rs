//! The pictures that there are.

use serde::Serialize;

use super::{Slice, error, matrix};
use crate::{fit::Table, view::picture::Picture};

/// A picture of a table.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Plot {
    /// Errors over theta and alpha at one ratio and phi, between nodes and at them.
    Error(Slice),
    /// Every number of every entry.
    Matrix,
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
