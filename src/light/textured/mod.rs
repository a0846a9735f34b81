//! Rectangle lights with a picture: the image, and what a prefilter makes of it.

mod filters;
mod image;
mod pyramid;
mod rows;
mod square;
#[cfg(test)]
mod tests;

pub use image::{ImageError, LightImage};
pub use pyramid::{LightPyramid, OWN_PARTS};
