//! The channels that a material needs of an image. Colour profiles are ignored, as glTF 2.0 requires.

use std::error::Error;

use super::error::SceneError;
use ltcforge_textures::StoredImage;

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

/// The `wanted` channels of an image (0 red to 3 alpha); `None` for an unsupported format. `count` gets the number of
/// pixels before they are decoded, and may refuse them. An image of 16 bits counts twice.
pub(super) fn decode(
    pointer: &str,
    bytes: &[u8],
    wanted: &[usize],
    count: impl FnOnce(u64) -> Result<(), SceneError>,
) -> Result<Option<Pixels>, SceneError> {
    let invalid = |error: &dyn Error| SceneError::fault(pointer, format!("the image is invalid: {error}"));
    let Some(image) = StoredImage::new(bytes).map_err(|error| invalid(&*error))? else { return Ok(None) };
    let (size, depth) = (image.size, image.depth);
    let [width, height] = size.map(|length| length as u64);
    if width == 0 || height == 0 {
        return Err(SceneError::fault(pointer, format!("an image of {width} x {height} pixels")));
    }
    count(width.saturating_mul(height).saturating_mul(depth as u64))?;
    let (channels, pixels) = image.pixels().map_err(|error| invalid(&*error))?;
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
    Ok(Some(Pixels { size, channels: wanted.len(), depth, bytes: kept.copied().collect() }))
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
        let refused = |bytes: &[u8]| {
            let mut counted = None;
            let count = |pixels: u64| {
                counted = Some(pixels);
                Err(SceneError::Stopped)
            };
            let error = decode("/images/0", bytes, &[0], count).expect_err("hostile").to_string();
            (error, counted)
        };
        let (error, counted) = refused(&webp(&[canvas.clone(), chunk(b"VP8 ", &frame(16383))].concat()));
        assert!(error.contains("its frame and its canvas have different sizes") && counted.is_none(), "{error}");
        let equal = webp(&[canvas, chunk(b"VP8 ", &frame(1))].concat());
        assert_eq!(refused(&equal).1, Some(1));
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
        let read = |bytes: &[u8]| decode("/images/0", bytes, &[0], |_| Ok(()));
        assert_eq!(read(&whole).expect("an image").expect("a JPEG").size, [64, 64]);
        let at = whole.windows(2).position(|pair| pair == [0xff, 0xc0]).expect("a header");
        let mut larger = whole.clone();
        larger[at + 5..at + 9].copy_from_slice(&[8, 0, 8, 0]);
        for damaged in [larger, whole[..whole.len() - 9].to_vec(), jpeg(true)] {
            let error = read(&damaged).expect_err("damaged").to_string();
            assert!(error.contains("/images/0") && error.contains("the image is invalid"), "{error}");
        }
    }
}
