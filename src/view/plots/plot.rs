//! The kinds of plots.

use serde::Serialize;

use super::{ErrorSlice, error, matrix};
use crate::picture::{Picture, short_digest};
use ltcforge_fit::{GoOn, Table};

/// A picture of a table.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Plot {
    /// Errors over theta and alpha at one ratio and phi, between nodes and at them.
    Error(ErrorSlice),
    /// Every number of every entry.
    Matrix,
}

impl Plot {
    /// The number of configurations that the plot measures. It is the same for every table.
    #[must_use]
    pub fn configurations(&self) -> u32 {
        match self {
            Self::Error(_) => (error::CELLS * error::CELLS) as u32,
            Self::Matrix => 0,
        }
    }

    /// Draws the plot of a table. `digest` is the digest of its file, in hexadecimal. It measures on the current rayon
    /// pool.
    #[must_use]
    pub fn draw(&self, table: &Table, digest: &str) -> Picture {
        self.draw_while(&|| true, table, digest).unwrap_or_else(|| unreachable!("nothing stops it"))
    }

    /// [`Self::draw`], but it can be stopped. `go_on` is called before each configuration. Returns `None` as soon as it
    /// returns false.
    #[must_use]
    pub fn draw_while(&self, go_on: &GoOn, table: &Table, digest: &str) -> Option<Picture> {
        let name = format!("table {}", short_digest(digest));
        match self {
            Self::Error(slice) => error::draw_while(go_on, table, &name, *slice),
            Self::Matrix => Some(matrix::draw(table, &name)),
        }
    }
}
