//! From the file of a picture to the files of its pyramid.

use ltcforge_files::digest::Digest;
use ltcforge_light::textured::LightPyramid;
use serde::Serialize;

use super::{
    LightFileError, LightPicture, LightSize, LightTexels, LightTextureFile, LightTextureFiles, PictureFormat,
    TransferFunction, light_texture_files,
};
use crate::{About, TextureContainer, TextureFileError};

/// What to make of a picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LightTextureOptions {
    /// The light on which texels are square; `None` where they are already.
    pub light: Option<LightSize>,
    /// What the picture's numbers stand for; `None` for what its file says.
    pub transfer: Option<TransferFunction>,
    /// The format of the files.
    pub container: TextureContainer,
    /// How texels are stored.
    pub texels: LightTexels,
    /// Most pixels of the picture, and most texels of the finest level.
    pub most_pixels: u64,
}

/// A prefiltered picture.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LightTexture {
    /// The format of the picture.
    pub format: PictureFormat,
    /// How its numbers were read.
    pub transfer: String,
    /// Its width and height in pixels.
    pub picture: [usize; 2],
    /// Texels of the finest level.
    pub size: [usize; 2],
    /// How many levels there are.
    pub levels: usize,
    /// How texels are stored.
    pub texels: LightTexels,
    /// The largest change of a channel by rounding, as in [`LightTextureFiles`].
    pub error: f64,
    /// How many numbers were above the largest that texels hold.
    pub clamped: u64,
    /// The files.
    #[serde(skip)]
    pub files: Vec<LightTextureFile>,
}

/// Why there is no prefiltered picture.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum LightTextureError {
    /// The picture.
    #[error(transparent)]
    Picture(#[from] LightFileError),
    /// The light is so large or so long that the texels would be too many.
    #[error("{} x {} texels are square on the light; {most} are allowed in all", .size[0], .size[1])]
    Size {
        /// The texels along both sides.
        size: [usize; 2],
        /// How many are allowed.
        most: u64,
    },
    /// The format.
    #[error(transparent)]
    Files(#[from] TextureFileError),
}

/// Prefilters the picture of a file. Domain: `name` as in [`light_texture_files`]. Runs on the current rayon pool; its size
/// changes nothing.
///
/// # Errors
/// When the bytes are no picture of a light, there are too many pixels or texels, or the format cannot hold them.
pub fn light_texture(
    bytes: &[u8],
    name: &str,
    options: &LightTextureOptions,
) -> Result<LightTexture, LightTextureError> {
    let LightTextureOptions { light, transfer, container, texels, most_pixels } = *options;
    let LightPicture { format, curve, image } = LightPicture::decode_within(bytes, transfer, most_pixels)?;
    let picture = [image.width(), image.height()];
    let size = light.map_or(picture, |light| image.square_size(light.sides()));
    if size[0] as u64 * size[1] as u64 > most_pixels {
        return Err(LightTextureError::Size { size, most: most_pixels });
    }
    let pyramid = LightPyramid::new(&image.resampled(size));
    let about = about(Digest::of(bytes), light.map_or(size.map(|side| side as f64), LightSize::sides));
    let LightTextureFiles { files, error, clamped } = light_texture_files(name, &pyramid, container, texels, &about)?;
    let levels = pyramid.levels().len();
    Ok(LightTexture { format, transfer: curve.to_string(), picture, size, levels, texels, error, clamped, files })
}

/// What the files say of themselves: the picture, and the light on which texels are square.
fn about(picture: Digest, [width, height]: [f64; 2]) -> About {
    About::new([
        concat!("ltcforge ", env!("CARGO_PKG_VERSION")).to_owned(),
        format!("picture {picture}"),
        format!("texels are square on a light of {width} x {height}"),
        "level l is blurred by (1 + r^2 / sigma^2)^-2.5 over the picture, sigma = 2^(l + 1) texels of level 0"
            .to_owned(),
    ])
}
