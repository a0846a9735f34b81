//! Portable functions, low-discrepancy sequences and frames.
//!
//! Invariant: equal input bits give equal output bits on every machine. The hardware computes only `+ - * / sqrt`,
//! which IEEE 754 defines exactly. Everything else comes from `libm`, which is portable code.

mod frame;
mod half;
mod portable;
mod scalar;
mod sequence;
mod single;
mod triple;

pub use frame::{direction, from_row_major, rotation_from_z, row_major, symmetric_sqrt, turned_about_z};
pub use half::{from_half_bits, half_bits, half_bits_f64};
pub use portable::{atan2, cbrt, cos, erfc, exp, ln, pow, sin, sin_cos};
pub use scalar::Scalar;
pub use sequence::{Lattice, SquarePoint, concentric_cosine, cosine_hemisphere, fibonacci_hemisphere, recurrence4};
pub use single::{atan2_upper, quadrant, sin_cos_turns};
pub use triple::{Triple, cross, dot, minus, plus, scaled, unit};
