//! Pictures in general: bytes, PNG, labels, marks, false colours, panels. This layer knows neither lights nor tables.
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
pub use panels::{Panel, bar, beside, caption, grid, headed, number};
pub use raster::{Picture, PngError};
pub use srgb::srgb;
pub use text::{Anchor, GROUND, LINE, fitting, short_digest, tag, tag_fits, text_width, write};
