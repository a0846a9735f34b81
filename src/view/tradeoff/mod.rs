//! The trade between speed, size and accuracy: which recipes show it, which of them are worth their price, and how
//! that is written and drawn.
//!
//! Invariant: no clock and no file here; what was measured is handed in.

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
