//! JPEG.

use zune_core::{bytestream::ZCursor, colorspace::ColorSpace, options::DecoderOptions};
use zune_jpeg::JpegDecoder;

use ltcforge_files::bounded::complete_jpeg;

use super::{Curve, Decoded, LightFileError, PictureFormat, Primaries, Wanted, from_bytes, orientation, profile};

pub(super) fn decode(bytes: &[u8], wanted: Wanted) -> Result<Decoded, LightFileError> {
    let wrong = |reason: &dyn std::fmt::Display| LightFileError::broken(PictureFormat::Jpeg, reason);
    let bytes = complete_jpeg(bytes).map_err(|error| wrong(&error))?;
    let options = DecoderOptions::default().jpeg_set_out_colorspace(ColorSpace::RGB).set_strict_mode(true);
    let mut decoder = JpegDecoder::new_with_options(ZCursor::new(bytes), options);
    decoder.decode_headers().map_err(|error| wrong(&error))?;
    let (width, height) = decoder.dimensions().ok_or_else(|| wrong(&"it has no size"))?;
    let size = wanted.bounded(width as u64, height as u64)?;
    let stated = decoder.icc_profile().map_or_else(|| Ok((Curve::Srgb, Primaries::bt709())), |icc| profile(&icc));
    let (curve, primaries) = stated.map_err(LightFileError::Colours)?;
    let curve = wanted.curve(curve);
    let pixels = decoder.decode().map_err(|error| wrong(&error))?;
    if pixels.len() != 3 * width * height {
        return Err(wrong(&"its pixels are not RGB"));
    }
    let texels = from_bytes(&pixels, &curve);
    Ok(Decoded { size, curve, primaries, texels, orientation: orientation(decoder.exif().map(Vec::as_slice)) })
}
