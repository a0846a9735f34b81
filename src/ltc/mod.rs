//! Linearly Transformed Cosines: the distribution, and tables of them.

mod axes;
mod layout;
mod table;

pub use axes::PerAxis;
pub use layout::Layout;
pub use table::{Table, Terms};
