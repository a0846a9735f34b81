//! PNG. Colours are multiplied by alpha, because transparent pixels emit less light.

use std::io::Cursor;

use ::png::{BitDepth, Decoder, DecodingError, Info, Limits, Transformations};

use super::{Curve, Decoded, LightFileError, PictureFormat, Wanted};

/// Bytes that the decoder may allocate in addition to the picture.
const MOST_BYTES: usize = 1 << 26;

/// The tolerance for a file gamma near 1 / 2.2, which means sRGB, or near 1, which means linear [PNG, section 11.3.2].
const SAME_GAMMA: f64 = 1e-3;

pub(super) fn decode(bytes: &[u8], wanted: Wanted) -> Result<Decoded, LightFileError> {
    let wrong = |error: DecodingError| LightFileError::broken(PictureFormat::Png, error);
    let mut decoder = Decoder::new_with_limits(Cursor::new(bytes), Limits { bytes: MOST_BYTES });
    // Text and ICC chunks are not needed and would take memory.
    decoder.set_ignore_text_chunk(true);
    decoder.set_ignore_iccp_chunk(true);
    decoder.set_transformations(Transformations::EXPAND);
    let header = decoder.read_header_info().map_err(wrong)?;
    let size = wanted.bounded(header.width.into(), header.height.into())?;
    let mut reader = decoder.read_info().map_err(wrong)?;
    let curve = wanted.curve.map_or_else(|| stated_curve(reader.info()), Ok)?;
    let too_long = || LightFileError::broken(PictureFormat::Png, "its size overflows");
    let mut pixels = vec![0; reader.output_buffer_size().ok_or_else(too_long)?];
    let frame = reader.next_frame(&mut pixels).map_err(wrong)?;
    let pixels = &pixels[..frame.buffer_size()];
    let channels = frame.color_type.samples();
    let texels = match frame.bit_depth {
        BitDepth::Sixteen => {
            let linear = curve.table(u16::MAX);
            let numbers: Vec<u16> = pixels.as_chunks::<2>().0.iter().map(|x| u16::from_be_bytes(*x)).collect();
            texels(&numbers, channels, &linear)
        }
        _ => texels(pixels, channels, &curve.table(255)),
    };
    Ok(Decoded { size, curve, texels })
}

/// Texels from one to four channels: grey or colour, with or without alpha.
fn texels<T: Copy + Into<usize>>(numbers: &[T], channels: usize, linear: &[f32]) -> Vec<[f32; 3]> {
    let largest = (linear.len() - 1) as f32;
    let texel = |pixel: &[T]| {
        let light = |i: usize| linear[pixel[i].into()];
        let colour = if channels < 3 { [light(0); 3] } else { [light(0), light(1), light(2)] };
        match channels {
            2 | 4 => colour.map(|x| x * (pixel[channels - 1].into() as f32 / largest)),
            _ => colour,
        }
    };
    numbers.chunks_exact(channels).map(texel).collect()
}

/// The curve that the file states, by the first of these chunks: cICP, sRGB, gAMA [PNG, third edition, section 12.1].
fn stated_curve(info: &Info<'_>) -> Result<Curve, LightFileError> {
    if let Some(points) = &info.coding_independent_code_points {
        return match points.transfer_function {
            4 => Ok(Curve::Power(2.2)),
            5 => Ok(Curve::Power(2.8)),
            8 => Ok(Curve::Linear),
            13 => Ok(Curve::Srgb),
            other => Err(LightFileError::Transfer(other)),
        };
    }
    let gamma = info.gamma().filter(|_| info.srgb.is_none()).map(|gamma| f64::from(gamma.into_value()));
    Ok(match gamma {
        Some(gamma) if (gamma - 1.0).abs() < SAME_GAMMA => Curve::Linear,
        Some(gamma) if gamma > 0.0 && (gamma - 1.0 / 2.2).abs() >= SAME_GAMMA => Curve::Power(1.0 / gamma),
        _ => Curve::Srgb,
    })
}
