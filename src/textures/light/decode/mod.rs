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

use super::colour::{Chromaticities, Curve, Primaries, TransferFunction, profile};

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
    /// The primaries of its numbers. The picture is converted to those of BT.709.
    pub primaries: Primaries,
    /// The picture, turned as the file states.
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
    /// The colours are not supported.
    #[error("the image's colours cannot be converted to BT.709: {0}")]
    Colours(String),
    /// Texels are not valid radiance.
    #[error(transparent)]
    Texels(#[from] ImageError),
}

impl LightFileError {
    fn broken(format: PictureFormat, reason: impl fmt::Display) -> Self {
        Self::Broken { format, reason: reason.to_string() }
    }
}

/// The result of a decoder.
struct Decoded {
    size: [usize; 2],
    curve: Curve,
    primaries: Primaries,
    /// Linear numbers.
    texels: Vec<[f32; 3]>,
    /// The orientation [Exif 3.0, tag 274], from 1 to 8.
    orientation: u16,
}

impl LightPicture {
    /// Decodes a picture. The first bytes select the format. Without `transfer`, numbers are linear in `OpenEXR` and
    /// Radiance HDR, and sRGB in JPEG and PNG, unless the file states a curve. Primaries and the orientation are as the
    /// file states. Negative parts of a colour outside of BT.709 become zero.
    ///
    /// # Errors
    /// The bytes are not an image, are damaged or too large, its colours are not supported, or a texel is negative or
    /// not finite.
    pub fn decode(bytes: &[u8], transfer: Option<TransferFunction>) -> Result<Self, LightFileError> {
        Self::decode_within(bytes, transfer, MOST_PIXELS)
    }

    /// Decodes a picture of up to `most` pixels, and never more than [`MOST_PIXELS`].
    ///
    /// # Errors
    /// Like [`Self::decode`].
    pub fn decode_within(bytes: &[u8], transfer: Option<TransferFunction>, most: u64) -> Result<Self, LightFileError> {
        let wanted = Wanted { transfer, most: most.min(MOST_PIXELS) };
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
        let Decoded { size, curve, primaries, mut texels, orientation } = decode(bytes, wanted)?;
        primaries.convert(&mut texels);
        let ([width, height], texels) = turned(size, texels, orientation);
        Ok(Self { format, curve, primaries, image: LightImage::new(width, height, texels)? })
    }
}

/// The caller's options.
#[derive(Debug, Clone, Copy)]
struct Wanted {
    /// The curve of the numbers. `None` to follow the file.
    transfer: Option<TransferFunction>,
    /// The largest allowed number of pixels.
    most: u64,
}

impl Wanted {
    /// The wanted curve, or else the file's.
    fn curve(self, of_file: Curve) -> Curve {
        self.transfer.map_or(of_file, Curve::from)
    }

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
fn from_bytes(pixels: &[u8], curve: &Curve) -> Vec<[f32; 3]> {
    let linear = curve.tables(255);
    let texel = |pixel: &[u8; 3]| [0, 1, 2].map(|channel| linear[channel][usize::from(pixel[channel])]);
    pixels.as_chunks::<3>().0.iter().map(texel).collect()
}

/// Applies a curve to float texels, in place.
fn from_floats(texels: &mut [[f32; 3]], curve: &Curve) {
    if *curve != Curve::Linear {
        for (i, number) in texels.as_flattened_mut().iter_mut().enumerate() {
            *number = curve.linear(i % 3, f64::from(*number)) as f32;
        }
    }
}

/// The primaries with these chromaticities. BT.709 if the file states none.
fn primaries(stated: Option<Chromaticities>) -> Result<Primaries, LightFileError> {
    stated.map_or_else(|| Ok(Primaries::bt709()), Primaries::new).map_err(LightFileError::Colours)
}

/// The orientation that Exif metadata states. 1 if they are missing or damaged.
pub(super) fn orientation(exif: Option<&[u8]>) -> u16 {
    let stated = || {
        let exif = exif?;
        let is_little = exif.starts_with(b"II");
        let number = |at: usize, length: usize| {
            let digits = exif.get(at..at.checked_add(length)?)?.iter();
            let joined = |number, digit: &u8| number << 8 | usize::from(*digit);
            Some(if is_little { digits.rev().fold(0, joined) } else { digits.fold(0, joined) })
        };
        let directory = number(4, 4)?;
        let entries = (0..number(directory, 2)?).map(|i| directory + 2 + 12 * i);
        let found = entries.take_while(|at| *at < exif.len()).find(|at| number(*at, 2) == Some(0x112))?;
        u16::try_from(number(found + 8, 2)?).ok().filter(|orientation| (1..=8).contains(orientation))
    };
    stated().unwrap_or(1)
}

/// An image as its orientation shows it. From 5 on, rows and columns are exchanged.
fn turned([width, height]: [usize; 2], texels: Vec<[f32; 3]>, orientation: u16) -> ([usize; 2], Vec<[f32; 3]>) {
    if orientation == 1 {
        return ([width, height], texels);
    }
    let is_exchanged = orientation >= 5;
    let size = if is_exchanged { [height, width] } else { [width, height] };
    let texel = |i: usize| {
        let at = [i % size[0], i / size[0]];
        let [x, y] = if is_exchanged { [at[1], at[0]] } else { at };
        let x = if matches!(orientation, 2 | 3 | 7 | 8) { width - 1 - x } else { x };
        let y = if matches!(orientation, 3 | 4 | 6 | 7) { height - 1 - y } else { y };
        texels[y * width + x]
    };
    (size, (0..texels.len()).map(texel).collect())
}
