//! Tables as textures: arrays of texels, as renderers read them.

mod layouts;
mod texture;

pub use layouts::{
    NoTextures, TextureAxis, TextureLayout, TextureSampling, TexturesOf, layout_names, sampling_of, textures_of,
};
pub use texture::{Texture, TextureError};
