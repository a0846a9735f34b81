//! Linearly Transformed Cosines: the distribution, and tables of them.

mod axes;
mod layout;
mod lookup;
mod table;

pub use axes::PerAxis;
pub use layout::Layout;
pub use lookup::{Configuration, LookedUp};
pub use table::{Table, Terms};
