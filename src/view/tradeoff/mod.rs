//! The trade-off between speed, size and accuracy: the recipes that show it, the Pareto fronts, and how both are written
//! and drawn.
//!
//! Invariant: no clock and no file here. Callers measure and hand the results in.

mod axis;
mod family;
mod front;
mod label;
mod picture;
mod prediction;
mod row;
mod table;

pub use family::{Size, family};
pub use front::{Fronts, front};
pub use picture::picture;
pub use prediction::{OffBy, off_by};
pub use row::{Measurement, POINTS, Row, rows};
pub use table::{csv, json};
