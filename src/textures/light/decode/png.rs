//! PNG. Colours are multiplied by alpha, because transparent pixels emit less light.

use std::io::Cursor;

use ::png::{BitDepth, Decoder, DecodingError, Info, Limits, ScaledFloat, Transformations};

use super::{Curve, Decoded, LightFileError, PictureFormat, Primaries, Wanted, orientation, primaries, profile};

/// Bytes that the decoder may allocate in addition to the picture.
const MOST_BYTES: usize = 1 << 26;

/// The tolerance for a file gamma near 1 / 2.2, which means sRGB, or near 1, which means linear [PNG, section 11.3.2].
const SAME_GAMMA: f64 = 1e-3;

pub(super) fn decode(bytes: &[u8], wanted: Wanted) -> Result<Decoded, LightFileError> {
    let wrong = |error: DecodingError| LightFileError::broken(PictureFormat::Png, error);
    let mut decoder = Decoder::new_with_limits(Cursor::new(bytes), Limits { bytes: MOST_BYTES });
    // Text is not needed and would take memory.
    decoder.set_ignore_text_chunk(true);
    decoder.set_transformations(Transformations::EXPAND);
    let header = decoder.read_header_info().map_err(wrong)?;
    let size = wanted.bounded(header.width.into(), header.height.into())?;
    let mut reader = decoder.read_info().map_err(wrong)?;
    let (curve, primaries) = stated(reader.info(), wanted)?;
    let too_long = || LightFileError::broken(PictureFormat::Png, "its size overflows");
    let mut pixels = vec![0; reader.output_buffer_size().ok_or_else(too_long)?];
    let frame = reader.next_frame(&mut pixels).map_err(wrong)?;
    // The chunk eXIf may follow the pixels.
    reader.finish().map_err(wrong)?;
    let orientation = orientation(reader.info().exif_metadata.as_deref());
    let pixels = &pixels[..frame.buffer_size()];
    let channels = frame.color_type.samples();
    let texels = match frame.bit_depth {
        BitDepth::Sixteen => {
            let linear = curve.tables(u16::MAX);
            let numbers: Vec<u16> = pixels.as_chunks::<2>().0.iter().map(|x| u16::from_be_bytes(*x)).collect();
            texels(&numbers, channels, &linear)
        }
        _ => texels(pixels, channels, &curve.tables(255)),
    };
    Ok(Decoded { size, curve, primaries, texels, orientation })
}

/// Texels from one to four channels: grey or colour, with or without alpha.
fn texels<T: Copy + Into<usize>>(numbers: &[T], channels: usize, linear: &[Vec<f32>; 3]) -> Vec<[f32; 3]> {
    let largest = (linear[0].len() - 1) as f32;
    let texel = |pixel: &[T]| {
        let colour = [0, 1, 2].map(|c| linear[c][pixel[if channels < 3 { 0 } else { c }].into()]);
        match channels {
            2 | 4 => colour.map(|x| x * (pixel[channels - 1].into() as f32 / largest)),
            _ => colour,
        }
    };
    numbers.chunks_exact(channels).map(texel).collect()
}

/// The wanted curve or the file's, and the primaries. The first of these chunks states them: cICP, iCCP, sRGB, and gAMA
/// with cHRM [PNG, third edition, section 4.3].
fn stated(info: &Info<'_>, wanted: Wanted) -> Result<(Curve, Primaries), LightFileError> {
    if let Some(points) = &info.coding_independent_code_points {
        if !points.is_video_full_range_image {
            return Err(LightFileError::Colours(
                "its cICP chunk states narrow range; only full range is read".to_owned(),
            ));
        }
        let curve = match (wanted.transfer, points.transfer_function) {
            (Some(transfer), _) => transfer.into(),
            (None, 4) => Curve::Power(2.2),
            (None, 5) => Curve::Power(2.8),
            (None, 8) => Curve::Linear,
            (None, 13) => Curve::Srgb,
            (None, other) => return Err(LightFileError::Transfer(other)),
        };
        let primaries = Primaries::of_code(points.color_primaries).map_err(LightFileError::Colours)?;
        return Ok((curve, primaries));
    }
    if let Some(icc) = &info.icc_profile {
        let (curve, primaries) = profile(icc).map_err(LightFileError::Colours)?;
        return Ok((wanted.curve(curve), primaries));
    }
    let curve = match info.gamma().filter(|_| info.srgb.is_none()).map(|gamma| f64::from(gamma.into_value())) {
        Some(gamma) if (gamma - 1.0).abs() < SAME_GAMMA => Curve::Linear,
        Some(gamma) if gamma > 0.0 && (gamma - 1.0 / 2.2).abs() >= SAME_GAMMA => Curve::Power(1.0 / gamma),
        _ => Curve::Srgb,
    };
    let stated = info.chrm_chunk.filter(|_| info.srgb.is_none());
    let pair = |(x, y): (ScaledFloat, ScaledFloat)| [x, y].map(|number| f64::from(number.into_value()));
    let primaries = primaries(stated.map(|c| [c.red, c.green, c.blue, c.white].map(pair)))?;
    Ok((wanted.curve(curve), primaries))
}
