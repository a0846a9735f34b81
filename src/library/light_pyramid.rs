//! Prefiltered pictures on lights.

use super::Error;
use ltcforge_light::textured::LightPyramid;
use ltcforge_textures::LightPicture;

/// The prefiltered pyramid of a picture (PNG, `OpenEXR`, Radiance HDR or JPEG) on a rectangular light of this width and
/// height, in any unit. [`light_texture_files`](ltcforge_textures::light_texture_files) makes its files.
///
/// ```
/// # fn main() -> Result<(), ltcforge::Error> {
/// // Two pixels of Radiance HDR.
/// let picture = b"#?RADIANCE\n\n-Y 1 +X 2\n\x80\x80\x80\x81\x00\x00\x00\x00";
/// let pyramid = ltcforge::light_pyramid(picture, [2.0, 1.0])?;
/// // A wide kernel sees the mean.
/// assert_eq!(pyramid.fetch([0.1, 0.5], 5.0), [0.5; 3]);
/// # Ok(())
/// # }
/// ```
///
/// # Errors
/// [`Error::Picture`] for bytes that are not a picture, a picture that is too large, and a pixel that is negative or
/// not finite. Domain: lengths above zero.
pub fn light_pyramid(picture: &[u8], light: [f64; 2]) -> Result<LightPyramid, Error> {
    let image = LightPicture::decode(picture, None)?.image;
    Ok(LightPyramid::new(&image.resampled(image.square_size(light))))
}
