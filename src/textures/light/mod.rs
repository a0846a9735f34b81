//! Pictures on lights: image files and profiles, and the files of a prefiltered picture.

mod colour;
mod decode;
mod files;
mod profile;
mod shared_exponent;
mod size;
#[cfg(test)]
mod tests;
mod texture;

pub use colour::{Curve, Primaries, TransferFunction};
pub use decode::{LightFileError, LightPicture, MOST_PIXELS, PictureFormat};
pub use files::{LightTexels, LightTextureFile, LightTextureFiles, is_light_texture, light_texture_files};
pub use profile::{PROFILE_FORMAT, Profile, ProfileError};
pub use size::LightSize;
pub use texture::{LightTexture, LightTextureError, LightTextureOptions, light_texture};
