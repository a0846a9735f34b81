//! Decodes the channels that a material needs from PNG, JPEG and WebP images. Colour profiles are ignored, as
//! glTF 2.0 requires.

use std::{error::Error, io::Cursor};

use zune_core::{bytestream::ZCursor, colorspace::ColorSpace, options::DecoderOptions};
use zune_jpeg::JpegDecoder;

use super::error::SceneError;
use ltcforge_files::bounded::complete_jpeg;

/// Maximum number of pixels of one image.
pub(super) const MOST_PIXELS: u64 = 1 << 26;

/// One to three channels of an image, 8 or 16 bits each.
#[derive(Debug, Clone)]
pub(super) struct Pixels {
    pub(super) size: [usize; 2],
    channels: usize,
    /// Bytes of a channel, the highest first.
    depth: usize,
    bytes: Vec<u8>,
}

impl Pixels {
    /// The channels of a texel, in [0, 1].
    pub(super) fn at(&self, [x, y]: [usize; 2]) -> [f64; 3] {
        let size = self.channels * self.depth;
        let first = (y * self.size[0] + x) * size;
        let mut out = [1.0; 3];
        for (value, level) in out.iter_mut().zip(self.bytes[first..first + size].chunks_exact(self.depth)) {
            *value = match *level {
                [high, low] => f64::from(u16::from_be_bytes([high, low])) / 65_535.0,
                _ => f64::from(level[0]) / 255.0,
            };
        }
        out
    }
}

/// A decoder's result with its own type of error.
type Decoded<T> = Result<T, Box<dyn Error>>;

/// An image whose header was read.
enum Decoder<'a> {
    Png(Box<png::Decoder<Cursor<&'a [u8]>>>),
    Jpeg(Box<JpegDecoder<ZCursor<Vec<u8>>>>),
    Webp(image_webp::WebPDecoder<Cursor<&'a [u8]>>),
}

impl<'a> Decoder<'a> {
    /// The decoder of an image, the image's width and height, and the bytes of a channel; `None` for an unsupported
    /// format.
    fn new(bytes: &'a [u8]) -> Decoded<Option<(Self, [usize; 2], usize)>> {
        let mut depth = 1;
        let (decoder, size) = match bytes {
            [0x89, b'P', b'N', b'G', ..] => {
                let mut decoder = png::Decoder::new(Cursor::new(bytes));
                decoder.set_ignore_text_chunk(true);
                decoder.set_ignore_iccp_chunk(true);
                decoder.set_transformations(png::Transformations::EXPAND);
                let info = decoder.read_header_info()?;
                let size = [info.width as usize, info.height as usize];
                depth = if info.bit_depth == png::BitDepth::Sixteen { 2 } else { 1 };
                (Self::Png(Box::new(decoder)), size)
            }
            [0xff, 0xd8, ..] => {
                let bytes = complete_jpeg(bytes)?;
                let options = DecoderOptions::default().jpeg_set_out_colorspace(ColorSpace::RGB).set_strict_mode(true);
                let mut decoder = JpegDecoder::new_with_options(ZCursor::new(bytes), options);
                decoder.decode_headers()?;
                let (width, height) = decoder.dimensions().ok_or("it has no size")?;
                (Self::Jpeg(Box::new(decoder)), [width, height])
            }
            [b'R', b'I', b'F', b'F', _, _, _, _, b'W', b'E', b'B', b'P', ..] => {
                let decoder = image_webp::WebPDecoder::new(Cursor::new(bytes))?;
                let (width, height) = decoder.dimensions();
                check_webp(bytes, [width, height])?;
                (Self::Webp(decoder), [width as usize, height as usize])
            }
            _ => return Ok(None),
        };
        Ok(Some((decoder, size, depth)))
    }

    /// The channels of the image and its pixels.
    fn pixels(self, [width, height]: [usize; 2]) -> Decoded<(usize, Vec<u8>)> {
        match self {
            Self::Png(decoder) => {
                let mut reader = decoder.read_info()?;
                let mut pixels = vec![0; reader.output_buffer_size().ok_or("its size overflows")?];
                let frame = reader.next_frame(&mut pixels)?;
                pixels.truncate(frame.buffer_size());
                Ok((frame.color_type.samples(), pixels))
            }
            Self::Jpeg(mut decoder) => {
                let pixels = decoder.decode()?;
                if pixels.len() == 3 * width * height { Ok((3, pixels)) } else { Err("its pixels are not RGB".into()) }
            }
            Self::Webp(mut decoder) => {
                let channels = if decoder.has_alpha() { 4 } else { 3 };
                let mut pixels = vec![0; channels * width * height];
                decoder.read_image(&mut pixels)?;
                Ok((channels, pixels))
            }
        }
    }
}

/// Checks that each lossy frame has the size of the canvas. The decoder compares the sizes only after it has decoded a
/// frame.
fn check_webp(bytes: &[u8], canvas: [u32; 2]) -> Result<(), &'static str> {
    let mut rest = &bytes[12..];
    while let Some(([b0, b1, b2, b3, length @ ..], data)) = rest.split_first_chunk::<8>() {
        match [b0, b1, b2, b3] {
            [b'A', b'N', b'M', b'F'] => return Err("it is animated"),
            [b'V', b'P', b'8', b' '] => {
                let side =
                    |at: usize| data.get(at..at + 2).map(|side| u32::from(side[0]) | u32::from(side[1] & 63) << 8);
                if [side(6), side(8)] != canvas.map(Some) {
                    return Err("its frame and its canvas have different sizes");
                }
            }
            _ => {}
        }
        let length = u32::from_le_bytes(*length) as usize;
        rest = data.get(length + length % 2..).unwrap_or_default();
    }
    Ok(())
}

fn invalid(pointer: &str, error: &dyn Error) -> SceneError {
    SceneError::fault(pointer, format!("the image is invalid: {error}"))
}

/// The decoder and the size of an image of at most [`MOST_PIXELS`]; `None` for an unsupported format.
fn open<'a>(pointer: &str, bytes: &'a [u8]) -> Result<Option<(Decoder<'a>, [usize; 2], usize)>, SceneError> {
    let Some((decoder, size, depth)) = Decoder::new(bytes).map_err(|error| invalid(pointer, &*error))? else {
        return Ok(None);
    };
    let [width, height] = size.map(|length| length as u64);
    if width == 0 || height == 0 {
        return Err(SceneError::fault(pointer, format!("an image of {width} x {height} pixels")));
    }
    SceneError::above(format!("{pointer}: pixels of the image"), width.saturating_mul(height), MOST_PIXELS)?;
    Ok(Some((decoder, size, depth)))
}

/// The number of pixels that an image's header states, twice that of an image of 16 bits; `None` for an unsupported
/// format.
pub(super) fn pixels_of(pointer: &str, bytes: &[u8]) -> Result<Option<u64>, SceneError> {
    Ok(open(pointer, bytes)?.map(|(_, [width, height], depth)| (width * height * depth) as u64))
}

/// The `wanted` channels of an image (0 red to 3 alpha). Domain: a format that [`pixels_of`] reads.
pub(super) fn decode(pointer: &str, bytes: &[u8], wanted: &[usize]) -> Result<Pixels, SceneError> {
    let (decoder, size, depth) =
        open(pointer, bytes)?.ok_or_else(|| SceneError::fault(pointer, "not PNG, JPEG or WebP"))?;
    let (channels, pixels) = decoder.pixels(size).map_err(|error| invalid(pointer, &*error))?;
    let from = |wanted: usize| match channels {
        1 => (wanted < 3).then_some(0),
        2 => Some(usize::from(wanted == 3)),
        n => (wanted < n).then_some(wanted),
    };
    let from: Vec<Option<usize>> = wanted.iter().map(|channel| from(*channel)).collect();
    let kept = pixels.chunks_exact(channels * depth).flat_map(|pixel| {
        let level = move |from: &Option<usize>| from.map_or(&[255; 2][..depth], |i| &pixel[i * depth..][..depth]);
        from.iter().flat_map(level)
    });
    Ok(Pixels { size, channels: wanted.len(), depth, bytes: kept.copied().collect() })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A canvas of one pixel and a frame of 402 MB.
    #[test]
    fn a_webp_frame_larger_than_its_canvas_is_refused_before_it_is_decoded() {
        let chunk = |name: &[u8], data: &[u8]| [name, &(data.len() as u32).to_le_bytes(), data].concat();
        let canvas = chunk(b"VP8X", &[0; 10]);
        let frame =
            |side: u16| [&b"\x10\0\0\x9d\x01\x2a"[..], &side.to_le_bytes(), &side.to_le_bytes(), &[0; 64]].concat();
        let webp = |chunks: &[u8]| chunk(b"RIFF", &[b"WEBP", chunks].concat());
        let refused = |bytes: &[u8]| pixels_of("/images/0", bytes).expect_err("hostile").to_string();
        let large = webp(&[canvas.clone(), chunk(b"VP8 ", &frame(16383))].concat());
        assert!(refused(&large).contains("its frame and its canvas have different sizes"), "{}", refused(&large));
        let equal = webp(&[canvas, chunk(b"VP8 ", &frame(1))].concat());
        assert_eq!(pixels_of("/images/0", &equal).expect("a header"), Some(1));
    }

    /// The same file with fewer pixels than its header states, cut off, and with colours in separate scans.
    #[test]
    fn a_jpeg_without_all_of_its_pixels_is_refused() {
        let jpeg = |is_optimized: bool| {
            let mut bytes = Vec::new();
            let mut encoder = jpeg_encoder::Encoder::new(&mut bytes, 90);
            encoder.set_optimized_huffman_tables(is_optimized);
            encoder.encode(&[7; 3 * 64 * 64], 64, 64, jpeg_encoder::ColorType::Rgb).expect("a JPEG");
            bytes
        };
        let whole = jpeg(false);
        assert_eq!(decode("/images/0", &whole, &[0]).expect("an image").size, [64, 64]);
        let at = whole.windows(2).position(|pair| pair == [0xff, 0xc0]).expect("a header");
        let mut larger = whole.clone();
        larger[at + 5..at + 9].copy_from_slice(&[8, 0, 8, 0]);
        for damaged in [larger, whole[..whole.len() - 9].to_vec(), jpeg(true)] {
            let error = decode("/images/0", &damaged, &[0]).expect_err("damaged").to_string();
            assert!(error.contains("/images/0") && error.contains("the image is invalid"), "{error}");
        }
    }
}
