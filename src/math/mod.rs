//! Portable functions, low-discrepancy sequences and frames.
//!
//! Invariant: equal input bits give equal output bits on every machine. Only `+ - * / sqrt` of the hardware are
//! used, which IEEE 754 defines exactly; everything else comes from `libm` in portable code.

mod frame;
mod portable;
mod sequence;
mod single;

pub use frame::{from_row_major, rotation_from_z, row_major, symmetric_sqrt, turned_about_z};
pub use portable::{cos, ln, sin, sin_cos};
pub use sequence::{cosine_hemisphere, fibonacci_hemisphere, lattice2};
pub use single::{atan2_upper, sin_cos_turns};
