//! Creates the files of a pyramid from a picture file.

use ltcforge_files::digest::Digest;
use ltcforge_light::textured::{LightPyramid, PROFILE_TANGENT};
use serde::Serialize;

use super::{
    LightFileError, LightPicture, LightSize, LightTexels, LightTextureFile, LightTextureFiles, PROFILE_FORMAT,
    PictureFormat, Primaries, Profile, ProfileError, TransferFunction, light_texture_files, profile::is_profile,
};
use crate::{About, TextureContainer, TextureFileError};

/// Options for creating the files of a picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LightTextureOptions {
    /// The size of the light on which texels should be square. `None` if they are already square.
    pub light: Option<LightSize>,
    /// The transfer function of the picture. `None` to follow the file.
    pub transfer: Option<TransferFunction>,
    /// The format of the files.
    pub container: TextureContainer,
    /// The format of texels.
    pub texels: LightTexels,
    /// The largest number of pixels in the picture, and of texels in the finest level.
    pub most_pixels: u64,
}

/// A prefiltered picture.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LightTexture {
    /// The format of the source: a [`PictureFormat`], or «IES LM-63».
    pub format: &'static str,
    /// The curve that decoded its numbers.
    pub transfer: String,
    /// The primaries of its numbers. Texels have those of BT.709.
    pub primaries: String,
    /// The width and height in pixels. For a profile, the number of angles around the axis and from it.
    pub picture: [usize; 2],
    /// The size of the finest level in texels.
    pub size: [usize; 2],
    /// The number of levels.
    pub levels: usize,
    /// The format of texels.
    pub texels: LightTexels,
    /// The largest change of a channel by rounding, as in [`LightTextureFiles`].
    pub error: f64,
    /// The number of values above the largest value of the texel format.
    pub clamped: u64,
    /// The files.
    #[serde(skip)]
    pub files: Vec<LightTextureFile>,
}

/// The picture cannot be prefiltered.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum LightTextureError {
    /// The file starts neither like a picture nor like a profile.
    #[error(
        "this file is neither a readable image nor a readable profile; allowed: {}, {PROFILE_FORMAT}",
        PictureFormat::names()
    )]
    Format,
    /// The picture is invalid.
    #[error(transparent)]
    Picture(LightFileError),
    /// The profile is invalid.
    #[error(transparent)]
    Profile(#[from] ProfileError),
    /// These options do not apply to a profile, which is always linear and has directions instead of positions.
    #[error("an IES profile is always linear and has no light size: leave out {}", .0.join(" and "))]
    OfProfile(Vec<&'static str>),
    /// Square texels on this light would exceed the limit.
    #[error("square texels on this light need {} x {} texels; at most {most} are allowed", .size[0], .size[1])]
    Size {
        /// The number of texels along each side.
        size: [usize; 2],
        /// The allowed number of texels.
        most: u64,
    },
    /// The format cannot store the texels.
    #[error(transparent)]
    Files(#[from] TextureFileError),
}

impl From<LightFileError> for LightTextureError {
    /// Replaces the error for an unknown picture format by an error that mentions profiles.
    fn from(error: LightFileError) -> Self {
        if error == LightFileError::Format { Self::Format } else { Self::Picture(error) }
    }
}

/// Prefilters a picture file, or the radiance of an IES profile over the tangents of angles. Domain: `name` as in
/// [`light_texture_files`]. Runs on the current rayon pool. The result does not depend on the size of the pool.
///
/// # Errors
/// The bytes are not a picture of a light, there are too many pixels or texels, or the container cannot store the
/// texels.
pub fn light_texture(
    bytes: &[u8],
    name: &str,
    options: &LightTextureOptions,
) -> Result<LightTexture, LightTextureError> {
    let LightTextureOptions { light, transfer, container, texels, most_pixels } = *options;
    let (format, transfer, primaries, picture, pyramid, of) = if is_profile(bytes) {
        let options = [(light.is_some(), "light"), (transfer.is_some(), "transfer")];
        let given: Vec<_> = options.into_iter().filter(|(is_given, _)| *is_given).map(|(_, name)| name).collect();
        if !given.is_empty() {
            return Err(LightTextureError::OfProfile(given));
        }
        let profile = Profile::parse(bytes)?;
        let of = [
            format!("IES profile {}", Digest::of(bytes)),
            format!(
                "candelas over the cosine by tangents of the angle to the axis, from -{PROFILE_TANGENT} to {PROFILE_TANGENT}"
            ),
        ];
        let primaries = Primaries::bt709().to_string();
        (PROFILE_FORMAT, "linear".to_owned(), primaries, profile.angles(), LightPyramid::new(&profile.image()), of)
    } else {
        let LightPicture { format, curve, primaries, image } =
            LightPicture::decode_within(bytes, transfer, most_pixels)?;
        let picture = [image.width(), image.height()];
        let size = light.map_or(picture, |light| image.square_size(light.sides()));
        if size[0] as u64 * size[1] as u64 > most_pixels {
            return Err(LightTextureError::Size { size, most: most_pixels });
        }
        let [width, height] = light.map_or(size.map(|side| side as f64), LightSize::sides);
        let of =
            [format!("picture {}", Digest::of(bytes)), format!("texels are square on a light of {width} x {height}")];
        let pyramid = LightPyramid::new(&image.resampled(size));
        (format.name(), curve.to_string(), primaries.to_string(), picture, pyramid, of)
    };
    let size = [pyramid.levels()[0].width(), pyramid.levels()[0].height()];
    let levels = pyramid.levels().len();
    let about = about(of);
    let LightTextureFiles { files, error, clamped } = light_texture_files(name, &pyramid, container, texels, &about)?;
    Ok(LightTexture { format, transfer, primaries, picture, size, levels, texels, error, clamped, files })
}

/// The comment in the files: the source, the meaning of the texels, and the blur.
fn about([of, texels]: [String; 2]) -> About {
    About::new([
        concat!("ltcforge ", env!("CARGO_PKG_VERSION")).to_owned(),
        of,
        texels,
        "level l is blurred by (1 + r^2 / sigma^2)^-2.5 over the picture, sigma = 2^(l + 1) texels of level 0"
            .to_owned(),
    ])
}
