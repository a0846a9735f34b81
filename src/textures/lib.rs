//! Exports textures as files that engines load, include or compile.
//!
//! A [`Texture`] has numbers, sizes and names. A container writes textures in one format. The bundle of an engine has
//! the files of this engine, with the names that the engine expects.
//!
//! Invariant: equal arguments give equal bytes. Code in this crate uses no clock and no environment, and does not
//! access files.

mod about;
mod bundle;
mod compact;
mod containers;
mod digits;
mod engines;
mod export;
mod file;
mod halves;
mod layouts;
mod light;
mod lut;
mod recipe;
mod rounding;
mod stored_image;
mod texture;

pub use about::About;
pub use bundle::{Bundle, MANIFEST};
pub use compact::{CompactContainer, CompactFileError};
pub use containers::TextureContainer;
pub use engines::Engine;
pub use export::{Export, ExportError, UnknownExport};
pub use file::{TextureFile, TextureFileError};
pub use halves::{Displacement, Halves};
pub use layouts::{
    NoTextures, TextureAxis, TextureLayout, TextureSampling, TexturesOf, layout_names, sampling_of, textures_of,
};
pub use light::{
    Curve, LightFileError, LightPicture, LightSize, LightTexels, LightTexture, LightTextureError, LightTextureFile,
    LightTextureFiles, LightTextureOptions, MOST_PIXELS, PROFILE_FORMAT, PictureFormat, Primaries, Profile,
    ProfileError, TransferFunction, is_light_texture, light_texture, light_texture_files,
};
pub use lut::{LutEngine, LutExport, LutExportError, PNG};
pub use rounding::{Rounded, RoundingError, round};
pub use stored_image::{ImageResult, StoredImage};
pub use texture::{Texture, TextureError};
