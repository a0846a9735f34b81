//! Pictures as such: bytes, PNG, labels, false colours, panels. Neither a light nor a table is known here.
//!
//! Invariant: equal calls give equal bytes on every machine.

mod colours;
mod marks;
mod panels;
mod raster;
mod srgb;
mod text;

pub use colours::{colour, signed_colour};
pub use marks::{cross, ring};
pub use panels::{Panel, bar, caption, grid, headed, number};
pub use raster::{Picture, PngError};
pub use srgb::srgb;
pub use text::{Anchor, GROUND, LINE, fitting, tag, write};
