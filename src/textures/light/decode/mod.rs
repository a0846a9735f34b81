//! Image files: PNG, `OpenEXR`, Radiance HDR and JPEG.
//!
//! Invariant: hostile bytes give an error within bounded time and memory, never a panic.

mod exr;
mod jpeg;
mod png;
mod radiance;

use std::fmt;

use ltcforge_fit::named_list;
use ltcforge_light::textured::{ImageError, LightImage};

use super::curve::{Curve, TransferFunction};

/// The largest number of pixels of a picture, and the largest number along a side.
pub const MOST_PIXELS: u64 = 1 << 24;
const MOST_ALONG: u64 = 1 << 14;

/// The first bytes of a file in each format.
const PNG_MAGIC: &[u8] = b"\x89PNG";
const EXR_MAGIC: &[u8] = b"\x76\x2f\x31\x01";
const JPEG_MAGIC: &[u8] = b"\xff\xd8";
const RADIANCE_MAGICS: [&[u8]; 2] = [b"#?RADIANCE", b"#?RGBE"];

named_list! {
    /// A format of image files.
    pub enum PictureFormat {
        /// PNG with 1 to 16 bits per channel.
        Png = "PNG",
        /// `OpenEXR` with channels R, G and B, or Y.
        Exr = "OpenEXR",
        /// Radiance HDR, `.hdr`.
        Radiance = "Radiance HDR",
        /// JPEG.
        Jpeg = "JPEG",
    }
}

impl PictureFormat {
    /// The names of all formats.
    pub(super) fn names() -> String {
        Self::ALL.iter().map(|format| format.name()).collect::<Vec<_>>().join(", ")
    }
}

/// A picture from a file.
#[derive(Debug, Clone, PartialEq)]
pub struct LightPicture {
    /// The format of the file.
    pub format: PictureFormat,
    /// The curve that decoded its numbers.
    pub curve: Curve,
    /// The picture.
    pub image: LightImage,
}

/// The file is not a picture of a light.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum LightFileError {
    /// The file does not start like any of the formats.
    #[error("this file is not a readable image; allowed: {}", PictureFormat::names())]
    Format,
    /// A side is zero, or there are too many pixels.
    #[error("the image has {width} x {height} pixels; 1 to {MOST_ALONG} on each side are allowed, and {most} in total")]
    Size {
        /// The width in pixels.
        width: u64,
        /// The height in pixels.
        height: u64,
        /// The allowed number of pixels.
        most: u64,
    },
    /// The decoder returned an error.
    #[error("not a readable {} file: {reason}", .format.name())]
    Broken {
        /// The format that the first bytes indicate.
        format: PictureFormat,
        /// The message of the decoder.
        reason: String,
    },
    /// The curve is not supported.
    #[error(
        "the file's cICP chunk names transfer function {0}; 4 and 5 (powers), 8 (linear) and 13 (sRGB) are supported"
    )]
    Transfer(u8),
    /// Texels are not valid radiance.
    #[error(transparent)]
    Texels(#[from] ImageError),
}

impl LightFileError {
    fn broken(format: PictureFormat, reason: impl fmt::Display) -> Self {
        Self::Broken { format, reason: reason.to_string() }
    }
}

/// The result of a decoder: the size, the curve and linear texels.
struct Decoded {
    size: [usize; 2],
    curve: Curve,
    texels: Vec<[f32; 3]>,
}

impl LightPicture {
    /// Decodes a picture. The first bytes select the format. Without `transfer`, numbers are linear in `OpenEXR` and
    /// Radiance HDR, and sRGB in JPEG. In PNG the file states the curve, with sRGB as the default.
    ///
    /// # Errors
    /// The bytes are not an image, are damaged or too large, or a texel is negative or not finite.
    pub fn decode(bytes: &[u8], transfer: Option<TransferFunction>) -> Result<Self, LightFileError> {
        Self::decode_within(bytes, transfer, MOST_PIXELS)
    }

    /// Decodes a picture of up to `most` pixels, and never more than [`MOST_PIXELS`].
    ///
    /// # Errors
    /// Like [`Self::decode`].
    pub fn decode_within(bytes: &[u8], transfer: Option<TransferFunction>, most: u64) -> Result<Self, LightFileError> {
        let wanted = Wanted { curve: transfer.map(Curve::from), most: most.min(MOST_PIXELS) };
        let (format, decode) = if bytes.starts_with(PNG_MAGIC) {
            (PictureFormat::Png, png::decode as fn(&[u8], Wanted) -> Result<Decoded, LightFileError>)
        } else if bytes.starts_with(EXR_MAGIC) {
            (PictureFormat::Exr, exr::decode as _)
        } else if bytes.starts_with(JPEG_MAGIC) {
            (PictureFormat::Jpeg, jpeg::decode as _)
        } else if RADIANCE_MAGICS.iter().any(|magic| bytes.starts_with(magic)) {
            (PictureFormat::Radiance, radiance::decode as _)
        } else {
            return Err(LightFileError::Format);
        };
        let Decoded { size: [width, height], curve, texels } = decode(bytes, wanted)?;
        Ok(Self { format, curve, image: LightImage::new(width, height, texels)? })
    }
}

/// The caller's options.
#[derive(Debug, Clone, Copy)]
struct Wanted {
    /// The curve of the numbers. `None` to follow the file.
    curve: Option<Curve>,
    /// The largest allowed number of pixels.
    most: u64,
}

impl Wanted {
    /// Rejects large sizes before it allocates memory.
    fn bounded(self, width: u64, height: u64) -> Result<[usize; 2], LightFileError> {
        let is_allowed = |side: u64| (1..=MOST_ALONG).contains(&side);
        if !is_allowed(width) || !is_allowed(height) || width * height > self.most {
            return Err(LightFileError::Size { width, height, most: self.most });
        }
        Ok([width as usize, height as usize])
    }
}

/// Texels from bytes, three bytes per texel.
fn from_bytes(pixels: &[u8], curve: Curve) -> Vec<[f32; 3]> {
    let linear = curve.table(255);
    pixels.as_chunks::<3>().0.iter().map(|pixel| pixel.map(|x| linear[usize::from(x)])).collect()
}

/// Applies a curve to float texels, in place.
fn from_floats(texels: &mut [[f32; 3]], curve: Curve) {
    if curve != Curve::Linear {
        for number in texels.as_flattened_mut() {
            *number = curve.linear(f64::from(*number)) as f32;
        }
    }
}
