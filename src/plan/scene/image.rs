//! Images: PNG, JPEG and WebP, to the channels that a material needs.

use std::io::Cursor;

use zune_core::{bytestream::ZCursor, colorspace::ColorSpace, options::DecoderOptions};
use zune_jpeg::JpegDecoder;

use super::error::SceneError;
use ltcforge_files::bounded::check_jpeg;

/// Pixels of one image, and of all that are kept.
pub(super) const MOST_PIXELS: u64 = 1 << 26;
pub(super) const MOST_PIXELS_OF_ALL: u64 = 1 << 28;

/// One to three channels of an image, 8 bits each.
#[derive(Debug, Clone)]
pub(super) struct Pixels {
    pub(super) size: [usize; 2],
    channels: usize,
    bytes: Vec<u8>,
}

impl Pixels {
    /// The channels of a texel, in [0, 1].
    pub(super) fn at(&self, [x, y]: [usize; 2]) -> [f64; 3] {
        let first = (y * self.size[0] + x) * self.channels;
        let mut out = [1.0; 3];
        for (value, byte) in out.iter_mut().zip(&self.bytes[first..first + self.channels]) {
            *value = f64::from(*byte) / 255.0;
        }
        out
    }
}

/// The formats that are read.
#[derive(Debug, Clone, Copy)]
enum Format {
    Png,
    Jpeg,
    Webp,
}

impl Format {
    fn of(bytes: &[u8]) -> Option<Self> {
        match bytes {
            [0x89, b'P', b'N', b'G', ..] => Some(Self::Png),
            [0xff, 0xd8, ..] => Some(Self::Jpeg),
            [b'R', b'I', b'F', b'F', _, _, _, _, b'W', b'E', b'B', b'P', ..] => Some(Self::Webp),
            _ => None,
        }
    }
}

/// How many pixels an image says that it has; `None` for a format that is not read.
pub(super) fn pixels_of(pointer: &str, bytes: &[u8]) -> Result<Option<u64>, SceneError> {
    let Some(format) = Format::of(bytes) else { return Ok(None) };
    let size = match format {
        Format::Png => png_header(pointer, bytes)?.1,
        Format::Jpeg => jpeg_header(pointer, bytes)?.1,
        Format::Webp => webp_header(pointer, bytes)?.1,
    };
    Ok(Some(size[0] as u64 * size[1] as u64))
}

/// The `wanted` channels of an image (0 red to 3 alpha). Domain: a format that [`pixels_of`] knows.
pub(super) fn decode(pointer: &str, bytes: &[u8], wanted: &[usize]) -> Result<Pixels, SceneError> {
    let (size, channels, pixels) = match Format::of(bytes) {
        Some(Format::Png) => png(pointer, bytes)?,
        Some(Format::Jpeg) => jpeg(pointer, bytes)?,
        Some(Format::Webp) => webp(pointer, bytes)?,
        None => return Err(SceneError::fault(pointer, "neither PNG nor JPEG nor WebP")),
    };
    let from = |wanted: usize| match channels {
        1 => (wanted < 3).then_some(0),
        2 => Some(usize::from(wanted == 3)),
        n => (wanted < n).then_some(wanted),
    };
    let from: Vec<Option<usize>> = wanted.iter().map(|channel| from(*channel)).collect();
    let kept = pixels.chunks_exact(channels).flat_map(|pixel| from.iter().map(|from| from.map_or(255, |i| pixel[i])));
    Ok(Pixels { size, channels: wanted.len(), bytes: kept.collect() })
}

type Decoded = ([usize; 2], usize, Vec<u8>);

/// Refuses what a few bytes would make large.
fn bounded(pointer: &str, width: u64, height: u64) -> Result<[usize; 2], SceneError> {
    let pixels = width.saturating_mul(height);
    if pixels == 0 {
        return Err(SceneError::fault(pointer, format!("an image of {width} x {height} pixels")));
    }
    SceneError::above(format!("{pointer}: pixels of the image"), pixels, MOST_PIXELS)?;
    Ok([width as usize, height as usize])
}

fn broken(pointer: &str, kind: &str, error: &dyn std::fmt::Display) -> SceneError {
    SceneError::fault(pointer, format!("no {kind} that can be read: {error}"))
}

type PngDecoder<'a> = png::Decoder<Cursor<&'a [u8]>>;

fn png_header<'a>(pointer: &str, bytes: &'a [u8]) -> Result<(PngDecoder<'a>, [usize; 2]), SceneError> {
    let mut decoder = png::Decoder::new(Cursor::new(bytes));
    decoder.set_ignore_text_chunk(true);
    decoder.set_ignore_iccp_chunk(true);
    decoder.set_transformations(png::Transformations::normalize_to_color8());
    let info = decoder.read_header_info().map_err(|error| broken(pointer, "PNG", &error))?;
    let size = bounded(pointer, info.width.into(), info.height.into())?;
    Ok((decoder, size))
}

fn png(pointer: &str, bytes: &[u8]) -> Result<Decoded, SceneError> {
    let wrong = |error: png::DecodingError| broken(pointer, "PNG", &error);
    let (decoder, size) = png_header(pointer, bytes)?;
    let mut reader = decoder.read_info().map_err(wrong)?;
    let length = reader.output_buffer_size().ok_or_else(|| broken(pointer, "PNG", &"its size overflows"))?;
    let mut pixels = vec![0; length];
    let frame = reader.next_frame(&mut pixels).map_err(wrong)?;
    pixels.truncate(frame.buffer_size());
    Ok((size, frame.color_type.samples(), pixels))
}

type JpegBytes<'a> = JpegDecoder<ZCursor<&'a [u8]>>;

fn jpeg_header<'a>(pointer: &str, bytes: &'a [u8]) -> Result<(JpegBytes<'a>, [usize; 2]), SceneError> {
    check_jpeg(bytes).map_err(|error| broken(pointer, "JPEG", &error))?;
    let options = DecoderOptions::default().jpeg_set_out_colorspace(ColorSpace::RGB);
    let mut decoder = JpegDecoder::new_with_options(ZCursor::new(bytes), options);
    decoder.decode_headers().map_err(|error| broken(pointer, "JPEG", &error))?;
    let (width, height) = decoder.dimensions().ok_or_else(|| broken(pointer, "JPEG", &"it has no size"))?;
    let size = bounded(pointer, width as u64, height as u64)?;
    Ok((decoder, size))
}

fn jpeg(pointer: &str, bytes: &[u8]) -> Result<Decoded, SceneError> {
    let (mut decoder, size) = jpeg_header(pointer, bytes)?;
    let pixels = decoder.decode().map_err(|error| broken(pointer, "JPEG", &error))?;
    if pixels.len() != 3 * size[0] * size[1] {
        return Err(broken(pointer, "JPEG", &"its pixels are no RGB"));
    }
    Ok((size, 3, pixels))
}

type WebpDecoder<'a> = image_webp::WebPDecoder<Cursor<&'a [u8]>>;

fn webp_header<'a>(pointer: &str, bytes: &'a [u8]) -> Result<(WebpDecoder<'a>, [usize; 2]), SceneError> {
    let decoder = image_webp::WebPDecoder::new(Cursor::new(bytes)).map_err(|error| broken(pointer, "WebP", &error))?;
    let (width, height) = decoder.dimensions();
    let size = bounded(pointer, width.into(), height.into())?;
    Ok((decoder, size))
}

fn webp(pointer: &str, bytes: &[u8]) -> Result<Decoded, SceneError> {
    let (mut decoder, size) = webp_header(pointer, bytes)?;
    let channels = if decoder.has_alpha() { 4 } else { 3 };
    let mut pixels = vec![0; channels * size[0] * size[1]];
    decoder.read_image(&mut pixels).map_err(|error| broken(pointer, "WebP", &error))?;
    Ok((size, channels, pixels))
}
