//! Rectangular lights with a picture: the image, its prefilter, and the readings for a lobe.
//!
//! On the plane of a light a lobe is close to a bump `(1 + Q)^-2` with Q quadratic (`bump.rs`). The bump has the centre
//! and axes of the lobe's inverse square root, exactly for an LTC (`cosine.rs`), and from an expansion for GGX
//! (`ggx.rs`). A few readings of the prefiltered picture along the longer axis replace the integral (`readings.rs`).
//! `docs/textured.md` has the derivation.

mod bump;
mod cosine;
mod engines;
mod filters;
mod ggx;
mod image;
#[cfg(any(test, feature = "testing"))]
mod kernel_sum;
#[cfg(test)]
mod kernel_tests;
mod light;
mod profile;
mod pyramid;
mod readings;
mod rectangle;
mod rows;
mod square;
#[cfg(test)]
mod tests;

pub use engines::engines_reading;
pub use image::{ImageError, LightImage};
#[cfg(any(test, feature = "testing"))]
pub use kernel_sum::kernel_sum;
pub use light::{TexturedLight, TexturedReflection, ltc_readings, normals_readings};
pub use profile::{PROFILE_TANGENT, ProfileWindow};
pub use pyramid::{LightPyramid, OWN_PARTS};
pub use readings::{Reading, Readings, colour};
pub use square::MOST_SQUARE_TEXELS;
