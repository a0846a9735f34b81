//! JPEG.

use zune_core::{bytestream::ZCursor, colorspace::ColorSpace, options::DecoderOptions};
use zune_jpeg::JpegDecoder;

use ltcforge_files::bounded::check_jpeg;

use super::{Curve, Decoded, LightFileError, PictureFormat, Wanted, from_bytes};

pub(super) fn decode(bytes: &[u8], wanted: Wanted) -> Result<Decoded, LightFileError> {
    let wrong = |reason: &dyn std::fmt::Display| LightFileError::broken(PictureFormat::Jpeg, reason);
    check_jpeg(bytes).map_err(|error| wrong(&error))?;
    // A truncated picture must be an error, not a picture with a grey half.
    let options = DecoderOptions::default().jpeg_set_out_colorspace(ColorSpace::RGB).set_strict_mode(true);
    let mut decoder = JpegDecoder::new_with_options(ZCursor::new(bytes), options);
    decoder.decode_headers().map_err(|error| wrong(&error))?;
    let (width, height) = decoder.dimensions().ok_or_else(|| wrong(&"it has no size"))?;
    let size = wanted.bounded(width as u64, height as u64)?;
    let pixels = decoder.decode().map_err(|error| wrong(&error))?;
    if pixels.len() != 3 * width * height {
        return Err(wrong(&"its pixels are not RGB"));
    }
    let curve = wanted.curve.unwrap_or(Curve::Srgb);
    Ok(Decoded { size, curve, texels: from_bytes(&pixels, curve) })
}
