//! Shaders and pictures: what a table does, its numbers and errors, and the trade-off of speed and accuracy.

pub mod shaders;

#[cfg(all(feature = "render", feature = "textures"))]
pub mod figures;
#[cfg(feature = "render")]
pub mod parameters;
#[cfg(feature = "render")]
pub mod picture;
#[cfg(feature = "render")]
pub mod plots;
#[cfg(feature = "render")]
pub mod preview;
#[cfg(feature = "render")]
pub mod tradeoff;

#[cfg(all(test, feature = "render", feature = "textures"))]
mod tests;
