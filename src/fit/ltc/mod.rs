//! Linearly Transformed Cosines: the distribution, and tables of them.
//!
//! Invariant: `ltc` knows how a table is read, not how it came to be.

mod axes;
mod distribution;
mod fold;
mod layout;
mod lookup;
mod polygon;
mod reflection;
mod table;

pub use axes::{ALPHA_Y_FLOOR, PerAxis};
pub use distribution::Ltc;
pub use fold::Configuration;
pub use layout::Layout;
pub use lookup::LookedUp;
#[cfg(test)]
pub(crate) use polygon::quadrature;
pub use polygon::{Clip, MAX_VERTICES, Scalar, Sides};
pub use reflection::Reflection;
pub use table::{Table, Terms};
