//! Pictures of tables: surfaces lit by them, their numbers and errors, and the trade-off of speed and accuracy.

pub mod picture;
pub mod plots;
pub mod preview;
pub mod shaders;
pub mod tradeoff;
