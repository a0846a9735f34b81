//! Radiance HDR: three bytes of colour and one of an exponent. EXPOSURE and COLORCORR are not applied.

use std::io::Cursor;

use image::{ImageDecoder as _, ImageError, codecs::hdr::HdrDecoder};

use super::{Curve, Decoded, LightFileError, PictureFormat, Wanted, from_floats};

pub(super) fn decode(bytes: &[u8], wanted: Wanted) -> Result<Decoded, LightFileError> {
    let wrong = |error: ImageError| LightFileError::broken(PictureFormat::Radiance, error);
    // The strict one refuses files that begin with #?RGBE.
    let decoder = HdrDecoder::new_nonstrict(Cursor::new(bytes)).map_err(wrong)?;
    let (width, height) = decoder.dimensions();
    let size = wanted.bounded(width.into(), height.into())?;
    let mut numbers = vec![0; size[0] * size[1] * size_of::<[f32; 3]>()];
    decoder.read_image(&mut numbers).map_err(wrong)?;
    let numbers: Vec<f32> = numbers.as_chunks::<4>().0.iter().map(|x| f32::from_ne_bytes(*x)).collect();
    let mut texels = numbers.as_chunks::<3>().0.to_vec();
    let curve = wanted.curve.unwrap_or(Curve::Linear);
    from_floats(&mut texels, curve);
    Ok(Decoded { size, curve, texels })
}
