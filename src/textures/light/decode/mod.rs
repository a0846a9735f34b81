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

/// Most pixels of a picture, and most along a side.
pub const MOST_PIXELS: u64 = 1 << 24;
const MOST_ALONG: u64 = 1 << 14;

/// The beginning of a file of each format.
const PNG_MAGIC: &[u8] = b"\x89PNG";
const EXR_MAGIC: &[u8] = b"\x76\x2f\x31\x01";
const JPEG_MAGIC: &[u8] = b"\xff\xd8";
const RADIANCE_MAGICS: [&[u8]; 2] = [b"#?RADIANCE", b"#?RGBE"];

named_list! {
    /// A format of image files.
    pub enum PictureFormat {
        /// PNG of 1 to 16 bits a channel.
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
    /// How its numbers were read.
    pub curve: Curve,
    /// The picture.
    pub image: LightImage,
}

/// Why a file is no picture of a light.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum LightFileError {
    /// The file begins as none of the formats.
    #[error("this file is not an image that can be read; allowed: {}", PictureFormat::names())]
    Format,
    /// Sides that are too long, or zero.
    #[error("the image has {width} x {height} pixels; 1 to {MOST_ALONG} along a side are allowed, and {most} in all")]
    Size {
        /// Its width.
        width: u64,
        /// Its height.
        height: u64,
        /// How many are allowed.
        most: u64,
    },
    /// The decoder refuses the file.
    #[error("no {} that can be read: {reason}", .format.name())]
    Broken {
        /// The format, by its beginning.
        format: PictureFormat,
        /// The decoder's reason.
        reason: String,
    },
    /// A curve that is not read.
    #[error(
        "the file's cICP chunk names transfer function {0}; read are 4 and 5, powers, 8, linear, and 13, sRGB: choose one"
    )]
    Transfer(u8),
    /// Texels that are no light.
    #[error(transparent)]
    Texels(#[from] ImageError),
}

impl LightFileError {
    fn broken(format: PictureFormat, reason: impl fmt::Display) -> Self {
        Self::Broken { format, reason: reason.to_string() }
    }
}

/// What a decoder finds: the size, the curve and linear texels.
struct Decoded {
    size: [usize; 2],
    curve: Curve,
    texels: Vec<[f32; 3]>,
}

impl LightPicture {
    /// Reads a picture. Its first bytes tell the format. Without `transfer` numbers are linear in `OpenEXR` and Radiance
    /// HDR, sRGB in JPEG, and in PNG what the file says, sRGB where it says nothing.
    ///
    /// # Errors
    /// When the bytes are no image, too large, broken, or have a texel that is negative or not finite.
    pub fn decode(bytes: &[u8], transfer: Option<TransferFunction>) -> Result<Self, LightFileError> {
        Self::decode_within(bytes, transfer, MOST_PIXELS)
    }

    /// The same for pictures of up to `most` pixels, [`MOST_PIXELS`] in any case.
    ///
    /// # Errors
    /// As [`Self::decode`].
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

/// What a caller wants of a picture.
#[derive(Debug, Clone, Copy)]
struct Wanted {
    /// How numbers are read; `None` for what the file says.
    curve: Option<Curve>,
    /// Most pixels.
    most: u64,
}

impl Wanted {
    /// Refuses sizes that a few bytes would make large.
    fn bounded(self, width: u64, height: u64) -> Result<[usize; 2], LightFileError> {
        let is_allowed = |side: u64| (1..=MOST_ALONG).contains(&side);
        if !is_allowed(width) || !is_allowed(height) || width * height > self.most {
            return Err(LightFileError::Size { width, height, most: self.most });
        }
        Ok([width as usize, height as usize])
    }
}

/// Texels of numbers of a byte each, three by three.
fn from_bytes(pixels: &[u8], curve: Curve) -> Vec<[f32; 3]> {
    let linear = curve.table(255);
    pixels.as_chunks::<3>().0.iter().map(|pixel| pixel.map(|x| linear[usize::from(x)])).collect()
}

/// Texels of numbers that a curve may still bend.
fn from_floats(texels: &mut [[f32; 3]], curve: Curve) {
    if curve != Curve::Linear {
        for number in texels.as_flattened_mut() {
            *number = curve.linear(f64::from(*number)) as f32;
        }
    }
}
