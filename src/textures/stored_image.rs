//! The numbers of PNG, JPEG and WebP images as their files store them. Colour profiles are ignored.
//!
//! Invariant: hostile bytes give an error, never a panic. The caller bounds the size before pixels are decoded.

use std::{error::Error, io::Cursor};

use zune_core::{bytestream::ZCursor, colorspace::ColorSpace, options::DecoderOptions};
use zune_jpeg::JpegDecoder;

use ltcforge_files::bounded::complete_jpeg;

/// A result with the error of a format's decoder.
pub type ImageResult<T> = Result<T, Box<dyn Error + Send + Sync>>;

/// The decoder of a format.
enum Kind<'a> {
    Png(Box<png::Decoder<Cursor<&'a [u8]>>>),
    Jpeg(Box<JpegDecoder<ZCursor<Vec<u8>>>>),
    Webp(image_webp::WebPDecoder<Cursor<&'a [u8]>>),
}

/// An image whose header was read.
pub struct StoredImage<'a> {
    kind: Kind<'a>,
    /// Width and height in pixels.
    pub size: [usize; 2],
    /// Bytes of a channel, the highest first.
    pub depth: usize,
}

impl<'a> StoredImage<'a> {
    /// Reads the header of an image; `None` for an unsupported format.
    ///
    /// # Errors
    /// The header is invalid.
    pub fn new(bytes: &'a [u8]) -> ImageResult<Option<Self>> {
        let mut depth = 1;
        let (kind, size) = match bytes {
            [0x89, b'P', b'N', b'G', ..] => {
                let mut decoder = png::Decoder::new(Cursor::new(bytes));
                decoder.set_ignore_text_chunk(true);
                decoder.set_ignore_iccp_chunk(true);
                decoder.set_transformations(png::Transformations::EXPAND);
                let info = decoder.read_header_info()?;
                let size = [info.width as usize, info.height as usize];
                depth = if info.bit_depth == png::BitDepth::Sixteen { 2 } else { 1 };
                (Kind::Png(Box::new(decoder)), size)
            }
            [0xff, 0xd8, ..] => {
                let bytes = complete_jpeg(bytes)?;
                let options = DecoderOptions::default().jpeg_set_out_colorspace(ColorSpace::RGB).set_strict_mode(true);
                let mut decoder = JpegDecoder::new_with_options(ZCursor::new(bytes), options);
                decoder.decode_headers()?;
                let (width, height) = decoder.dimensions().ok_or("it has no size")?;
                (Kind::Jpeg(Box::new(decoder)), [width, height])
            }
            [b'R', b'I', b'F', b'F', _, _, _, _, b'W', b'E', b'B', b'P', ..] => {
                let decoder = image_webp::WebPDecoder::new(Cursor::new(bytes))?;
                let (width, height) = decoder.dimensions();
                check_webp(bytes, [width, height])?;
                (Kind::Webp(decoder), [width as usize, height as usize])
            }
            _ => return Ok(None),
        };
        Ok(Some(Self { kind, size, depth }))
    }

    /// The number of channels and the bytes of all pixels.
    ///
    /// # Errors
    /// The image is damaged.
    pub fn pixels(self) -> ImageResult<(usize, Vec<u8>)> {
        let [width, height] = self.size;
        match self.kind {
            Kind::Png(decoder) => {
                let mut reader = decoder.read_info()?;
                let mut pixels = vec![0; reader.output_buffer_size().ok_or("its size overflows")?];
                let frame = reader.next_frame(&mut pixels)?;
                pixels.truncate(frame.buffer_size());
                Ok((frame.color_type.samples(), pixels))
            }
            Kind::Jpeg(mut decoder) => {
                let pixels = decoder.decode()?;
                if pixels.len() == 3 * width * height { Ok((3, pixels)) } else { Err("its pixels are not RGB".into()) }
            }
            Kind::Webp(mut decoder) => {
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
